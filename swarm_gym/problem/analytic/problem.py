"""Problems on analytic maps: waypoints among circles and convex polygons."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import require_integer, require_number
from swarm_gym.problem.analytic.pairs import Pair, list_pairs, rotated_shapes
from swarm_gym.problem.analytic.table import WaypointTable, points_beside, tabulate
from swarm_gym.problem.geometry.polylines import is_clear
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes, resampled, spacing_of
from swarm_gym.problem.map_problem import MapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.scenarios import Circle, Obstacle, Point, Scenario, require_analytic

Floats = NDArray[np.float64]

MOST_WAYPOINTS = 10_000


@dataclass(frozen=True)
class AnalyticProblem(MapProblem):
    """Find the waypoint offsets, shape (num_waypoints,), of least fitness on a scenario.

    Attributes:
        scenario: the map and the task.
        num_waypoints: n, the dimension of a decision vector.
        length_weight: mu in (0, 1], the weight of the length in the fitness; the collision has weight 1 - mu.
        ways: (K, num_waypoints) the paths that smooth new members lie next to; None is the straight line.
    """

    scenario: Scenario
    num_waypoints: int = 31
    length_weight: float = 0.3
    ways: Floats | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        require_analytic(self.scenario)
        require_integer("num_waypoints", self.num_waypoints, 1, MOST_WAYPOINTS)
        require_number("length_weight", self.length_weight, math.nextafter(0.0, 1.0), 1.0)

    @property
    def dimension(self) -> int:
        """Length of a decision vector."""
        return self.num_waypoints

    @cached_property
    def table(self) -> WaypointTable:
        """The problem as the kernels read it."""
        return tabulate(self.scenario, self.pairs, self.num_waypoints, self.length_weight, self.ways)

    @cached_property
    def pairs(self) -> list[Pair]:
        """The pairs of a segment of a path and an obstacle over it."""
        spacing = spacing_of(self.scenario, self.num_waypoints)
        return list_pairs(rotated_shapes(self.scenario), self.num_waypoints + 1, spacing)

    @cached_property
    def axes(self) -> RotatedAxes:
        """The axes along and across the start-target line."""
        return RotatedAxes.of(self.scenario)

    @property
    def lower_bound(self) -> float:
        """A lower bound of the fitness: mu times the straight line."""
        return self.length_weight * self.scenario.straight_line

    @property
    def collision_bound(self) -> float:
        """An upper bound of the degree of collision of paths inside the workspace, in map units."""
        lower, upper = self.bounds
        # The smaller of two shifts is at most half their sum, which the heights bound.
        reach = float(upper.max() - lower.min())
        return math.fsum(reach + pair.top - pair.bottom for pair in self.pairs) / 2.0

    @property
    def collision_bound_anywhere(self) -> float:
        """An upper bound of the degree of collision for any start in the workspace, in map units."""
        x_min, y_min, x_max, y_max = self.scenario.workspace
        reach = 2.0 * math.hypot(x_max - x_min, y_max - y_min)
        shifts = [(reach + _extent(obstacle)) / 2.0 for obstacle in self.scenario.solids]
        return (self.num_waypoints + 1) * math.fsum(shifts)

    def begun_at(self, start: Point) -> "AnalyticProblem":
        """Return the same problem from another start."""
        return replace(self, scenario=replace(self.scenario, start=start, initial_range=None), ways=None)

    def carried_over(self, vectors: Floats, before: Problem) -> Floats:
        """Return the offsets of the same paths from the new line, inside the workspace."""
        return self.along(before.points(vectors))

    def along(self, paths: Floats) -> Floats:
        """Return decision vectors, (m, n), along polylines, (m, k, 2), inside the workspace."""
        return np.clip(resampled(paths, self.scenario, self.num_waypoints), *self.bounds)

    def is_clear(self, path: Floats) -> bool:
        """Return whether a polyline enters no obstacle."""
        return is_clear(path, self.scenario.solids, self.scenario.tolerance)

    @property
    def identity(self) -> tuple[object, ...]:
        """The numbers and obstacles that the fitness depends on."""
        scenario = self.scenario
        numbers = (
            *scenario.start,
            *scenario.target,
            *scenario.workspace,
            self.num_waypoints,
            self.length_weight,
        )
        # As floats, since 1, 1.0 and a NumPy number are one value but print differently.
        return [float(number) for number in numbers], [_plain(o) for o in scenario.solids]

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the paths, (..., n + 2, 2) in map coordinates, of decision vectors (..., n)."""
        return points_beside(self.line, self.axes.across, np.asarray(vectors, dtype=np.float64))

    @cached_property
    def line(self) -> Floats:
        """Map coordinates of start, waypoints of offset 0, and target, shape (num_waypoints + 2, 2)."""
        x = self.table.spacing * np.arange(self.num_waypoints + 2.0)
        return self.axes.to_map(x, np.zeros_like(x))


def _extent(obstacle: Obstacle) -> float:
    """Return an upper bound of the distance between two points of an obstacle."""
    if isinstance(obstacle, Circle):
        return 2.0 * obstacle.radius
    low, high = np.min(obstacle.vertices, axis=0), np.max(obstacle.vertices, axis=0)
    return math.hypot(*(high - low))


def _plain(obstacle: Obstacle) -> list:
    if isinstance(obstacle, Circle):
        return [float(obstacle.x), float(obstacle.y), float(obstacle.radius)]
    return [(float(x), float(y)) for x, y in obstacle.vertices]
