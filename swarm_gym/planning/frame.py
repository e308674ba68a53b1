"""Frames: the coordinates that the planner works in, whose origin and unit follow from the task.

On maps of circles and polygons the origin is the start. Start and goal are as far apart as in the SPSFA
paper's cases, for which optimizers are tuned. So neither the place of a map nor its unit changes what the
planner does, and roundings are relative to the size of the task.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.scenarios import Circle, Obstacle, Point, Polygon, Scenario

Floats = NDArray[np.float64]

DISTANCE = 960.0  # from start to target in the paper's cases, in map units
MOST_MOVES = 8  # of an end that lies in several outlines


@dataclass(frozen=True)
class Frame:
    """Coordinates with another origin and unit than the map has.

    Attributes:
        origin: point of the map that is the origin of the frame, in map units.
        factor: lengths in the frame over those in map units.
    """

    origin: Point = (0.0, 0.0)
    factor: float = 1.0

    @classmethod
    def of(cls, scenario: Scenario) -> "Frame":
        """Return the frame of a task on a map of circles and polygons."""
        return cls(scenario.start, DISTANCE / scenario.straight_line)

    def to_frame(self, points: ArrayLike) -> Floats:
        """Return points in the frame of points in map units, both of shape (..., 2)."""
        return self.factor * (np.asarray(points, dtype=np.float64) - self.origin)

    def to_map(self, points: ArrayLike) -> Floats:
        """Return points in map units of points in the frame, both of shape (..., 2)."""
        return np.asarray(points, dtype=np.float64) / self.factor + self.origin

    def moved(self, scenario: Scenario) -> Scenario:
        """Return a scenario in the frame.

        An end that is inside an obstacle by the tolerance of the scenario, at most, is moved to its outline.
        So what touches on a map that is far from its origin touches in the frame, too. For the same reason
        the seams between obstacles are made on the map, and are obstacles of the frame.
        """
        (x_min, y_min), (x_max, y_max) = self.to_frame(np.reshape(scenario.workspace, (2, 2))).tolist()
        low_high = scenario.initial_range
        obstacles = tuple(self._obstacle(obstacle) for obstacle in scenario.solids)
        deepest = 2.0 * self.factor * scenario.tolerance
        return Scenario(
            scenario.name,
            _outside(self._point(scenario.start), obstacles, deepest),
            _outside(self._point(scenario.target), obstacles, deepest),
            obstacles,
            (x_min, y_min, x_max, y_max),
            None if low_high is None else (self.factor * low_high[0], self.factor * low_high[1]),
        )

    def _point(self, point: Point) -> Point:
        x, y = self.to_frame(point).tolist()
        return x, y

    def _obstacle(self, obstacle: Obstacle) -> Obstacle:
        if isinstance(obstacle, Circle):
            return Circle(*self._point((obstacle.x, obstacle.y)), self.factor * obstacle.radius)
        return Polygon(tuple(map(self._point, obstacle.vertices)))


def _outside(point: Point, obstacles: tuple[Obstacle, ...], deepest: float) -> Point:
    """Return the point, or one on the outline of obstacles in which it lies no deeper than a limit."""
    for _ in range(MOST_MOVES):
        inside = [obstacle for obstacle in obstacles if 0.0 < obstacle.depth(point) <= deepest]
        if not inside:
            break
        point = _on_outline(point, inside[0])
    return point


def _on_outline(point: Point, obstacle: Obstacle) -> Point:
    """Return the point of the outline that is nearest to a point just inside of it."""
    x, y = point
    if isinstance(obstacle, Circle):
        longer = obstacle.radius / math.hypot(x - obstacle.x, y - obstacle.y)
        return obstacle.x + longer * (x - obstacle.x), obstacle.y + longer * (y - obstacle.y)
    nearest = min(
        (((x0 - x) * (y1 - y0) + (y0 - y) * (x0 - x1)) / math.dist((x0, y0), (x1, y1)), (x0, y0), (x1, y1))
        for (x0, y0), (x1, y1) in obstacle.edges()
    )
    depth, (x0, y0), (x1, y1) = nearest
    share = depth / math.dist((x0, y0), (x1, y1))
    return x + share * (y1 - y0), y + share * (x0 - x1)
