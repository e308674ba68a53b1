"""Problems of walking over a grid map, for optimizers whose members are points and not whole paths."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import require_number
from swarm_gym.problem.map_problem import GridMapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.walk.table import WalkTable, tabulate
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class WalkProblem(GridMapProblem):
    """Find the shortest walk from start to target over free cells.

    Attributes:
        scenario: the map and the task.
        penalty: lambda, the fitness of each cell's length of blocked line.
    """

    scenario: GridScenario
    penalty: float = 500.0

    def __post_init__(self) -> None:
        require_number("penalty", self.penalty, 0.0, 1e9)

    @property
    def dimension(self) -> int:
        """Length of a decision vector: a member is a point (x, y)."""
        return 2

    @cached_property
    def table(self) -> WalkTable:
        """The problem as the kernels read it."""
        return tabulate(self.scenario, self.penalty)

    @property
    def lower_bound(self) -> float:
        """A lower bound of the fitness: the straight line."""
        return self.scenario.straight_line

    @property
    def collision_bound(self) -> float:
        """An upper bound of the degree of collision, in map units: the diagonal of the map."""
        x_min, y_min, x_max, y_max = self.scenario.workspace
        return math.hypot(x_max - x_min, y_max - y_min)

    @property
    def collision_bound_anywhere(self) -> float:
        """An upper bound of the degree of collision for any start: again the diagonal of the map."""
        return self.collision_bound

    def carried_over(self, vectors: Floats, before: Problem) -> Floats:  # noqa: ARG002
        """Return the points as they are."""
        return vectors

    @property
    def identity(self) -> tuple[object, ...]:
        """The map, the ends and the penalty that the fitness depends on."""
        scenario = self.scenario
        ends = [float(number) for number in (*scenario.start, *scenario.target)]
        return scenario.map.digest, ends, "walk", float(self.penalty)

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the straight lines, (..., 2, 2), from points (..., 2) to the target."""
        here = np.asarray(vectors, dtype=np.float64)
        return np.stack([here, np.broadcast_to(self.scenario.target, here.shape)], axis=-2)
