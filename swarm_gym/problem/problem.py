"""A problem: a scenario, its encoding and its cost."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import require_integer, require_number
from swarm_gym.problem.cost import evaluate
from swarm_gym.problem.frame import Frame
from swarm_gym.problem.pairs import Pair, list_pairs, shapes_in_frame
from swarm_gym.problem.repair import repair
from swarm_gym.problem.waypoints import WaypointTable, spacing_of, tabulate
from swarm_gym.scenarios import Scenario

Floats = NDArray[np.float64]


def points_beside(line: Floats, across: Floats, offsets: Floats) -> Floats:
    """Paths (..., n + 2, 2) in map coordinates.

    Args:
        line: `Problem.line`, or an array of them with the leading axes of the offsets.
        across: `Problem.across`, likewise.
        offsets: decision vectors, shape (..., n).
    """
    y = np.zeros((*offsets.shape[:-1], line.shape[-2], 1))
    y[..., 1:-1, 0] = offsets
    return line + y * across


@dataclass(frozen=True)
class Problem:
    """Find the waypoint offsets, shape (num_waypoints,), of least fitness on a scenario.

    Attributes:
        scenario: the map and the task.
        num_waypoints: n, the dimension of a decision vector.
        length_weight: mu in (0, 1], the weight of the length in the fitness; 1 - mu is that of the collision.
    """

    scenario: Scenario
    num_waypoints: int = 31
    length_weight: float = 0.3

    def __post_init__(self) -> None:
        require_integer("num_waypoints", self.num_waypoints, 1)
        require_number("length_weight", self.length_weight, math.nextafter(0.0, 1.0), 1.0)

    @cached_property
    def table(self) -> WaypointTable:
        """The problem as the kernels read it."""
        return tabulate(self.scenario, self.pairs, self.num_waypoints, self.length_weight)

    @cached_property
    def pairs(self) -> list[Pair]:
        """Segments of a path and the obstacles over them."""
        spacing = spacing_of(self.scenario, self.num_waypoints)
        return list_pairs(shapes_in_frame(self.scenario), self.num_waypoints + 1, spacing)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper bounds of the offsets, (num_waypoints,) each: the workspace."""
        return self.table.lower[: self.num_waypoints], self.table.upper[: self.num_waypoints]

    @property
    def initial_bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the first population, (num_waypoints,) each."""
        n = self.num_waypoints
        return self.table.initial_lower[:n], self.table.initial_upper[:n]

    @cached_property
    def line(self) -> Floats:
        """Map coordinates of start, waypoints of offset 0, and target, shape (num_waypoints + 2, 2)."""
        x = self.table.spacing * np.arange(self.num_waypoints + 2)
        return Frame.of(self.scenario).to_map(x, np.zeros_like(x))

    @property
    def across(self) -> Floats:
        """By how much the map coordinates of a waypoint change with its offset, (1, 2)."""
        frame = Frame.of(self.scenario)
        return np.array([[-frame.sine, frame.cosine]])

    @property
    def lower_bound(self) -> float:
        """A fitness that no path can be below: mu times the straight line."""
        return self.length_weight * self.scenario.straight_line

    @property
    def collision_bound(self) -> float:
        """A degree of collision that no path inside the workspace can exceed."""
        lower, upper = self.bounds
        # The smaller of two shifts is at most half their sum, which the heights bound.
        reach = float(upper.max() - lower.min())
        return sum(reach + pair.top - pair.bottom for pair in self.pairs) / 2.0

    def evaluate(self, offsets: ArrayLike) -> tuple[float, float]:
        """Fitness and degree of collision of one decision vector."""
        path = self._path(offsets)
        return evaluate(self.table, path)

    def repaired(self, offsets: ArrayLike, repair_degree: float) -> Floats:
        """A decision vector after one repair pass of degree phi."""
        require_number("repair_degree", repair_degree, 0.0, 1.0)
        path = self._path(offsets)
        repair(self.table, path, repair_degree)
        return path[1 : self.num_waypoints + 1]

    def points(self, offsets: ArrayLike) -> Floats:
        """Decision vectors (..., n) as paths in map coordinates, shape (..., n + 2, 2)."""
        return points_beside(self.line, self.across, np.asarray(offsets, dtype=np.float64))

    def _path(self, offsets: ArrayLike) -> Floats:
        offsets = np.asarray(offsets, dtype=np.float64)
        if offsets.shape != (self.num_waypoints,):
            raise ValueError(f"expected {self.num_waypoints} offsets, got shape {offsets.shape}")
        if not np.isfinite(offsets).all():
            raise ValueError(f"offsets must be finite, got {offsets.tolist()}")
        path = np.zeros(len(self.table.lower) + 1)
        path[1 : self.num_waypoints + 1] = offsets
        return path
