"""Scenarios on analytic maps: a workspace with obstacles, a start and a target.

Values are checked when an object is made.
"""

import math
from dataclasses import dataclass
from functools import cached_property

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.obstacles import (
    Circle,
    Obstacle,
    Point,
    Polygon,
    require_numbers,
    require_sequence,
)
from swarm_gym.scenarios.seams import seams_of

# Depth up to which a point counts as touching an obstacle, because numbers are rounded: a share of the
# workspace's longer side. It is larger than the depth up to which paths on the papers' maps are feasible.
TOUCHING = 1e-11
# The same in roundings of the largest coordinate, for maps that are far from the origin.
ROUNDINGS = 8.0


@dataclass(frozen=True)
class Scenario:
    """A path-planning task on a map of circles and polygons, in map units.

    Attributes:
        name: name under which results are filed.
        start: (x, y) where the robot is.
        target: (x, y) where it has to go.
        obstacles: circles and convex polygons; they may overlap and touch. A path stays out of the interior
            of their union, see `solids`.
        workspace: (x_min, y_min, x_max, y_max); start and target lie in it.
        initial_range: (low, high) of the first waypoints, as offsets to the left of the line from start to
            target; None takes the extent of the obstacles.

    Raises:
        ScenarioError: if the task is malformed; the message names the part and its value.
    """

    name: str
    start: Point
    target: Point
    obstacles: tuple[Obstacle, ...]
    workspace: tuple[float, float, float, float] = (0.0, 0.0, 1000.0, 600.0)
    initial_range: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        object.__setattr__(self, "obstacles", require_sequence(where, "obstacles", self.obstacles))
        for part, length in (("start", 2), ("target", 2), ("workspace", 4), ("initial_range", 2)):
            given = getattr(self, part)
            if part != "initial_range" or given is not None:
                object.__setattr__(self, part, require_numbers(where, part, given, length))
        x_min, y_min, x_max, y_max = self.workspace
        if not (x_min < x_max and y_min < y_max):
            raise ScenarioError(
                f"{where}: workspace needs x_min < x_max and y_min < y_max, got {self.workspace}"
            )
        if self.start == self.target:
            raise ScenarioError(f"{where}: start and target must be different points, both are {self.start}")
        for number, obstacle in enumerate(self.obstacles):
            if not isinstance(obstacle, Circle | Polygon):
                raise ScenarioError(
                    f"{where}: obstacle {number} is {shown(obstacle)}, expected a Circle or a Polygon"
                )
        for role, point in (("start", self.start), ("target", self.target)):
            if not (x_min <= point[0] <= x_max and y_min <= point[1] <= y_max):
                raise ScenarioError(f"{where}: {role} {point} lies outside the workspace {self.workspace}")
            self._require_free(role, point)
        if self.initial_range is not None and self.initial_range[0] >= self.initial_range[1]:
            raise ScenarioError(
                f"{where}: initial_range (low, high) needs low < high, got {self.initial_range}"
            )

    @cached_property
    def solids(self) -> tuple[Obstacle, ...]:
        """The obstacles, and thin ones over edges that two of them share, see `swarm_gym.scenarios.seams`.

        Each is an open set. A path that enters none of them stays out of the interior of the union.
        """
        return (*self.obstacles, *seams_of(self.obstacles, self.tolerance))

    @cached_property
    def tolerance(self) -> float:
        """Depth in map units up to which a point counts as touching an obstacle."""
        x_min, y_min, x_max, y_max = self.workspace
        rounding = math.ulp(max(map(abs, self.workspace)))
        return max(TOUCHING * max(x_max - x_min, y_max - y_min), ROUNDINGS * rounding)

    def _require_free(self, role: str, point: Point) -> None:
        """Raise a ScenarioError if an end lies inside an obstacle, or inside an edge that two share."""
        where, touched = f"scenario {shown(self.name)}: {role} {point}", 0
        for number, obstacle in enumerate(self.obstacles):
            depth = obstacle.depth(point)
            if depth > self.tolerance:
                raise ScenarioError(f"{where} lies inside obstacle {number}, {obstacle}")
            touched += depth >= -self.tolerance
        if touched > 1 and any(solid.depth(point) > self.tolerance for solid in self.solids):
            raise ScenarioError(f"{where} lies between obstacles, on an edge that they share")

    @property
    def y_up(self) -> bool:
        """True if y grows upwards in pictures."""
        return True

    @property
    def view(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the area that pictures show: the workspace."""
        return self.workspace

    @property
    def straight_line(self) -> float:
        """Distance from start to target in map units: no path is shorter."""
        return math.hypot(self.target[0] - self.start[0], self.target[1] - self.start[1])
