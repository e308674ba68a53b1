"""The rotated map of the SPSFA paper's eq. 1: coordinates (x', y') along and across the start-target line."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import MapScenario, Point

Floats = NDArray[np.float64]


class Frame(NamedTuple):
    """The rotated map of eq. 1: its origin is the start, its x' axis points to the target."""

    origin: Point
    cosine: float
    sine: float

    @classmethod
    def of(cls, scenario: MapScenario) -> "Frame":
        """The frame in which the scenario's start-target line is the x' axis."""
        length = scenario.straight_line
        return cls(
            scenario.start,
            (scenario.target[0] - scenario.start[0]) / length,
            (scenario.target[1] - scenario.start[1]) / length,
        )

    @property
    def across(self) -> Floats:
        """By how much map coordinates change with y', (2,)."""
        return np.array([-self.sine, self.cosine])

    def from_map(self, point: Point) -> Point:
        """Map coordinates to (x', y')."""
        x, y = point[0] - self.origin[0], point[1] - self.origin[1]
        return x * self.cosine + y * self.sine, y * self.cosine - x * self.sine

    def to_map(self, x: Floats, y: Floats) -> Floats:
        """Coordinates (x', y'), arrays of one shape, to map coordinates, shape (..., 2)."""
        return np.stack(
            [
                self.origin[0] + x * self.cosine - y * self.sine,
                self.origin[1] + x * self.sine + y * self.cosine,
            ],
            axis=-1,
        )
