"""The problems that the swarms of a simulation work on, stacked as the kernels read them."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import SettingError
from swarm_gym.problem import MapProblem, Problem
from swarm_gym.problem.tables import put, stack
from swarm_gym.reference import known_optimum
from swarm_gym.scenarios import drive_of
from swarm_gym.settings import Settings

Floats = NDArray[np.float64]


class Worlds:
    """Problems of all worlds of the scenarios, one scenario after the other.

    Where robots drive, one for each swarm follows, which is replaced by that from where its robot is.

    Attributes:
        problems: what `Swarms.problem` counts.
        num_worlds: how many of these are worlds.
        first: (scenarios,) where those of the scenarios begin.
        next_event: (problems,) the iteration after which the next world comes into force; 0 if none does.
        lower_bounds: (problems,) see `Problem`.
        gap_units: (problems,) likewise.
        optima: (problems,) known optima, else NaN.
        tables: stacked.
    """

    def __init__(self, settings: Settings, num_swarms: int):
        problems = settings.problems()
        num_spare = num_swarms if any(map(drive_of, settings.scenarios)) else 0
        begins = np.array([world.iteration for world in settings.worlds])
        self.num_worlds = len(problems)
        self.first = np.flatnonzero(begins == 0)
        self.problems: list[Problem] = problems + [problems[0]] * num_spare
        self.next_event = np.append(np.roll(begins, -1), np.zeros(num_spare, dtype=np.int64))
        self.lower_bounds = np.array([problem.lower_bound for problem in self.problems])
        self.gap_units = np.array([problem.gap_unit for problem in self.problems])
        optima = [known_optimum(problem) for problem in problems]
        self.optima = np.array(optima + [np.nan] * num_spare)
        self.tables = stack([problem.table for problem in self.problems])

    @property
    def ever_change(self) -> bool:
        """Whether anything happens in any of them."""
        return bool(self.next_event.any())

    @property
    def collision_bound(self) -> float:
        """A degree of collision that no path can exceed in any of them, in map units."""
        bounds = [problem.collision_bound for problem in self.problems]
        if len(self.problems) > self.num_worlds:
            bounds += [p.collision_bound_anywhere for p in self.problems if isinstance(p, MapProblem)]
        return max(bounds)

    @property
    def common_bounds(self) -> tuple[Floats, Floats]:
        """Bounds, (C,) each, of the decision vectors that lie inside those of every world."""
        lower, upper = self.tables.lower[: self.num_worlds], self.tables.upper[: self.num_worlds]
        return lower.max(axis=0), upper.min(axis=0)

    @property
    def scenario_names(self) -> list[str]:
        """What episodes draw from."""
        return [self.problems[number].scenario.name for number in self.first]

    def require_optima(self, purpose: str) -> None:
        """Refuse scenarios whose optimum is not known.

        Raises:
            SettingError: naming the first of them.
        """
        if len(self.problems) > self.num_worlds:
            raise SettingError(f"{purpose} needs optima, which are not known for robots on their way")
        for problem, optimum in zip(self.problems, self.optima, strict=True):
            if np.isnan(optimum):
                raise SettingError(
                    f"{purpose} needs the optimum of scenario {problem.scenario.name!r}, which is not known; "
                    f"see swarm_gym.reference.ensure_optima"
                )

    def points(self, vectors: Floats, numbers: NDArray[np.int64]) -> Floats:
        """Decision vectors (B, dimension) of the problems of these numbers, (B,), as paths, (B, k, 2)."""
        if len(self.problems) == 1:
            return self.problems[0].points(vectors)
        # One problem after the other, then in the order of the vectors again.
        found = [self.problems[number].points(vectors[numbers == number]) for number in np.unique(numbers)]
        return np.concatenate(found)[np.argsort(np.argsort(numbers, kind="stable"))]

    def replace(self, number: int, problem: Problem, world: int) -> None:
        """Let a problem of the same kind and dimension, in that world, take the place of another one."""
        self.problems[number] = problem
        self.next_event[number] = self.next_event[world]
        self.lower_bounds[number] = problem.lower_bound
        self.gap_units[number] = problem.gap_unit
        self.tables = put(self.tables, number, problem.table)
