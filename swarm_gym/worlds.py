"""The problems that the settings describe, and those of a simulation, stacked in arrays for the kernels."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import as_numpy
from swarm_gym.errors import SettingError
from swarm_gym.kinds import kind_of, names_of_kinds, problem_of
from swarm_gym.problem import GridProblem, MapProblem, OneMaxProblem, Problem, TerrainProblem
from swarm_gym.problem.grid.problem import warn_of_winding
from swarm_gym.problem.tables import put, stack
from swarm_gym.reference import known_optimum, quick_optima
from swarm_gym.reference.onemax.optima import COUNTINGS, least_evaluations
from swarm_gym.scenarios import (
    AnyScenario,
    GridScenario,
    Scenario,
    StaticScenario,
    World,
    drive_of,
    grown,
    worlds_of,
)
from swarm_gym.settings import Settings
from swarm_gym.sources import GUIDED
from swarm_gym.ways import with_ways

Floats = NDArray[np.float64]

# Attributes of `Worlds` that the arithmetic of many swarms reads, in the arrays of the simulation.
CONSTANTS = ("next_event", "begins", "first_event", "lower_bounds", "gap_units", "optima", "targets")


def worlds_for(settings: Settings) -> tuple[World, ...]:
    """Return the worlds of all scenarios, one scenario after the other; episodes begin with iteration 0.

    Raises:
        SettingError: if an event follows the last iteration of an episode, or comes after it.
        ScenarioError: if obstacles that have grown by the clearance leave no path.
    """
    worlds = tuple(world for scenario in settings.scenarios for world in worlds_of(scenario))
    for world in worlds:
        if world.iteration >= settings.iterations:
            raise SettingError(
                f"scenario {world.scenario.name!r} has an event after iteration {world.iteration}, "
                f"expected one after iteration 1 to {settings.iterations - 1}, since episodes have "
                f"{settings.iterations}"
            )
    if settings.clearance == 0.0:
        return worlds
    return tuple(
        world._replace(scenario=grown(world.scenario, settings.clearance))
        if isinstance(world.scenario, Scenario | GridScenario)
        else world
        for world in worlds
    )


def problems_for(settings: Settings, worlds: Sequence[World] | None = None) -> list[Problem]:
    """Return the problems of all worlds, which are of one kind and dimension.

    Args:
        settings: options of the environment.
        worlds: worlds of these settings; None makes them by `worlds_for`.

    Raises:
        SettingError: if there is no scenario, if problems differ in kind or dimension, or if the encoding
            needs another kind of map.
        ScenarioError: if a map cannot be converted to cells of this size.
    """
    scenarios = [world.scenario for world in (worlds_for(settings) if worlds is None else worlds)]
    first, kind = scenarios[0], settings.kind
    for scenario in scenarios:
        if (other := kind_of(scenario)) is not kind:
            raise SettingError(_clash(first, scenario, "kinds", kind.name, other.name))
    if settings.encoding not in kind.options:
        raise SettingError(
            f"encoding {settings.encoding!r} needs {names_of_kinds(settings.encoding)}, but scenario "
            f"{first.name!r} is one of the {kind.name}; choose another encoding or scenario"
        )
    problems = [problem_of(scenario, settings) for scenario in scenarios]
    dimension = problems[0].dimension
    for problem in problems:
        if problem.dimension != dimension:
            raise SettingError(_clash(first, problem.scenario, "dimensions", dimension, problem.dimension))
    if settings.encoding == "waypoints":
        warn_of_winding([scenario for scenario in scenarios if isinstance(scenario, GridScenario)])
    return problems


def _clash(first: StaticScenario, second: StaticScenario, what: str, one: object, other: object) -> str:
    return (
        f"scenario: {first.name!r} and {second.name!r} cannot be in one environment, since they are of "
        f"different {what}, {one} and {other}; make an environment for each"
    )


def make_problem(scenario: str | AnyScenario, **options: object) -> Problem:
    """Return the problem of an environment of that scenario and these options of `Settings`.

    If the map changes, this is the problem at the end of an episode, which results refer to. The default of
    the encoding is "waypoints", or the first one of a kind of scenario that has no waypoints. Episodes are as
    long as the changes need, unless `iterations` is given.

    Raises:
        SettingError: for a value that an option cannot have, or an option that would change nothing.
    """
    chosen: dict[str, Any] = options
    settings = Settings(scenario=scenario, **chosen)
    if "encoding" not in options and settings.encoding not in settings.kind.options:
        settings = replace(settings, encoding=next(iter(settings.kind.options)))
    defaults: dict[str, Any] = {name: value for name, value in settings.kind.defaults if name not in options}
    settings = replace(settings, **defaults) if defaults else settings
    settings.refuse_unused(options)
    worlds = worlds_of(settings.scenarios[0])
    if "iterations" not in options:
        settings = replace(settings, iterations=max(settings.iterations, worlds[-1].iteration + 1))
    return problems_for(settings)[len(worlds) - 1]


class Worlds:
    """The problems of all worlds of the scenarios, one scenario after the other.

    A world is a fixed map, and the iteration after which it is in force, see `swarm_gym.scenarios.World`. If
    robots drive, one more problem follows for each swarm. It is replaced by the problem from the robot's
    present position.

    Attributes:
        problems: list of problems; `Swarms.problem` has their indices.
        num_worlds: number of problems that are worlds; they are the first ones.
        first: (scenarios,) index of the first world of each scenario.
        next_event: (problems,) iteration after which the next world is in force; 0 if there is none.
        begins: (problems,) iteration after which the world came into force; 0 for the first.
        first_event: (problems,) iteration of the first event of the scenario; 0 if there is none.
        lower_bounds: (problems,) `Problem.lower_bound`.
        gap_units: (problems,) `Problem.gap_unit`.
        optima: (problems,) known optima, else NaN; `compute_optima` may fill these.
        targets: (problems,) `Problem.target`.
        counts_evaluations: whether the measure of a run is its evaluations, see `Problem.counts_evaluations`.
        tables: problem tables of all problems, stacked.
    """

    def __init__(self, settings: Settings, num_swarms: int):
        worlds = worlds_for(settings)
        problems = problems_for(settings, worlds)
        num_spare = num_swarms if any(map(drive_of, settings.scenarios)) else 0
        if num_spare > 0:
            _refuse_for_robots(settings)
        if settings.source == GUIDED:
            problems = [with_ways(problem) for problem in problems]
        begins = np.array([world.iteration for world in worlds])
        self.begins = np.append(begins, np.zeros(num_spare, dtype=np.int64))
        self.num_worlds = len(problems)
        self.first = np.flatnonzero(begins == 0)
        self.problems: list[Problem] = problems + [problems[0]] * num_spare
        self.next_event = np.append(np.roll(begins, -1), np.zeros(num_spare, dtype=np.int64))
        self.first_event = self._first_events(begins, num_spare)
        self.lower_bounds = np.array([problem.lower_bound for problem in self.problems])
        self.gap_units = np.array([problem.gap_unit for problem in self.problems])
        self.targets = np.array([problem.target for problem in self.problems])
        self.counts_evaluations = problems[0].counts_evaluations
        optima = _known_optima(problems, settings)
        self.optima = np.array(optima + [np.nan] * num_spare)
        self._asked = False
        self.tables = stack([problem.table for problem in self.problems])

    def _first_events(self, begins: NDArray[np.int64], num_spare: int) -> NDArray[np.int64]:
        scenario = np.cumsum(begins == 0) - 1
        return np.append(self.next_event[self.first][scenario], np.zeros(num_spare, dtype=np.int64))

    def place(self, place: Callable[[NDArray], NDArray]) -> None:
        """Replace the arrays named in `CONSTANTS` by what a function makes of them, such as tensors."""
        for name in CONSTANTS:
            setattr(self, name, place(getattr(self, name)))

    @property
    def ever_change(self) -> bool:
        """True if any of the scenarios changes during an episode."""
        return bool(self.next_event.any())

    @property
    def collision_bound(self) -> float:
        """Degree of collision that no path can exceed in any of the worlds, in map units."""
        bounds = [problem.collision_bound for problem in self.problems]
        if len(self.problems) > self.num_worlds:
            bounds += [p.collision_bound_anywhere for p in self.problems if isinstance(p, MapProblem)]
        return max(bounds)

    def common_bounds(self, scenario: int | None = None) -> tuple[Floats, Floats]:
        """Return bounds, (C,) each, of vectors inside the bounds of all worlds, or of those of a scenario."""
        begin, end = 0, self.num_worlds
        if scenario is not None:
            begin, end = np.append(self.first, end)[scenario : scenario + 2]
        lower, upper = self.tables.lower[begin:end], self.tables.upper[begin:end]
        return lower.max(axis=0), upper.min(axis=0)

    @property
    def scenario_names(self) -> list[str]:
        """Names of the scenarios that episodes draw from."""
        return [self.problems[number].scenario.name for number in self.first]

    def compute_optima(self) -> None:
        """Compute the optima that are not known if that is quick; do nothing when called again."""
        if not self._asked:
            self._asked = True
            unknown = np.flatnonzero(np.isnan(as_numpy(self.optima[: self.num_worlds]))).tolist()
            found = quick_optima([self.problems[number] for number in unknown]) if unknown else []
            for number, optimum in zip(unknown, found, strict=True):
                self.optima[number] = optimum

    def require_optima(self, purpose: str) -> None:
        """Raise an error if the optimum of a scenario is not known and computing it takes long.

        Raises:
            SettingError: naming the first of these scenarios.
        """
        if len(self.problems) > self.num_worlds:
            raise SettingError(
                f"{purpose} needs optima, which are unknown for robots that drive; "
                "choose a scenario without a drive"
            )
        self.compute_optima()
        for problem, optimum in zip(self.problems, as_numpy(self.optima), strict=True):
            if np.isnan(optimum):
                if isinstance(problem, TerrainProblem):
                    raise SettingError(
                        f"{purpose} needs optima, and that of terrain {problem.scenario.name!r} cannot be "
                        "computed; choose another one, such as reward 'final' or 'progress'"
                    )
                if isinstance(problem, GridProblem) and problem.wishes:
                    raise SettingError(
                        f"{purpose} needs optima, and none are known with {', '.join(problem.wishes)}; "
                        "choose another one, such as reward 'final' or 'progress'"
                    )
                raise SettingError(
                    f"{purpose} needs the optimum of scenario {problem.scenario.name!r}, which is not known; "
                    f"compute it with swarm_gym.reference.ensure_optima"
                )

    def points(self, vectors: Floats, numbers: NDArray[np.int64]) -> Floats:
        """Return decision vectors (B, dimension) of the problems of these numbers (B,) as paths (B, k, 2)."""
        if len(self.problems) == 1:
            return self.problems[0].points(vectors)
        # Convert the vectors of one problem after the other, then restore their order.
        found = [self.problems[number].points(vectors[numbers == number]) for number in np.unique(numbers)]
        return np.concatenate(found)[np.argsort(np.argsort(numbers, kind="stable"))]

    def replace(self, number: int, problem: Problem, world: int) -> None:
        """Replace a problem by another one of the same kind and dimension, in that world."""
        self.problems[number] = problem
        self.next_event[number] = self.next_event[world]
        self.first_event[number] = self.first_event[world]
        self.begins[number] = self.begins[world]
        self.lower_bounds[number] = problem.lower_bound
        self.gap_units[number] = problem.gap_unit
        self.targets[number] = problem.target
        self.tables = put(self.tables, number, problem.table)


def _known_optima(problems: Sequence[Problem], settings: Settings) -> list[float]:
    """Return the optima that are known, else NaN; of bit strings, the least expected evaluations."""
    counting = str(settings.knobs.get("counting", COUNTINGS[0]))
    return [
        least_evaluations(problem.scenario, counting)
        if isinstance(problem, OneMaxProblem)
        else known_optimum(problem)
        for problem in problems
    ]


def _refuse_for_robots(settings: Settings) -> None:
    """Raise an error if an option does not hold where robots drive.

    Raises:
        SettingError: naming the option.
    """
    reasons = {
        f"source {GUIDED!r}": settings.source == GUIDED and "ways are planned once",
        f"clearance {settings.clearance:g}": settings.clearance > 0.0 and "an obstacle may appear beside it",
    }
    for option, reason in reasons.items():
        if reason:
            raise SettingError(
                f"{option} cannot hold for a robot that drives, since {reason}; remove it, or choose a "
                "scenario without a drive"
            )
