"""Frames: the coordinates that the planner works in, whose origin and unit follow from the task.

On maps of circles and polygons the origin is the start, and start and goal are as far apart as in the SPSFA
paper's cases, for which optimizers are tuned. So neither the place of a map nor its unit changes what the
planner does, and roundings are relative to the size of the task.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.scenarios import Circle, Obstacle, Point, Polygon, Scenario

Floats = NDArray[np.float64]

DISTANCE = 960.0  # from start to target in the paper's cases, in map units


@dataclass(frozen=True)
class Frame:
    """Coordinates with another origin and unit than those of the map.

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

        Raises:
            ScenarioError: if an end is inside an obstacle by less than the roundings of its coordinates.
        """
        (x_min, y_min), (x_max, y_max) = self.to_frame(np.reshape(scenario.workspace, (2, 2))).tolist()
        low_high = scenario.initial_range
        return Scenario(
            scenario.name,
            self._point(scenario.start),
            self._point(scenario.target),
            tuple(self._obstacle(obstacle) for obstacle in scenario.obstacles),
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
