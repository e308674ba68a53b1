"""Coordinates (x', y') along and across the start-target line.

Source: SPSFA paper, eq. 1, the rotated map. Waypoints are evenly spaced on the x' axis, and their offsets are
measured along y'.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import MapScenario, Point

Floats = NDArray[np.float64]


class RotatedAxes(NamedTuple):
    """The axes of eq. 1: their origin is the start, and the x' axis points to the target."""

    origin: Point
    cosine: float
    sine: float

    @classmethod
    def of(cls, scenario: MapScenario) -> "RotatedAxes":
        """Return the axes whose x' axis is the start-target line of a scenario."""
        length = scenario.straight_line
        return cls(
            scenario.start,
            (scenario.target[0] - scenario.start[0]) / length,
            (scenario.target[1] - scenario.start[1]) / length,
        )

    @property
    def across(self) -> Floats:
        """Change of the map coordinates per unit of y', (2,)."""
        return np.array([-self.sine, self.cosine])

    def from_map(self, point: Point) -> Point:
        """Turn map coordinates into (x', y')."""
        x, y = point[0] - self.origin[0], point[1] - self.origin[1]
        return x * self.cosine + y * self.sine, y * self.cosine - x * self.sine

    def to_map(self, x: Floats, y: Floats) -> Floats:
        """Turn coordinates (x', y'), arrays of one shape, into map coordinates, shape (..., 2)."""
        return np.stack(
            [
                self.origin[0] + x * self.cosine - y * self.sine,
                self.origin[1] + x * self.sine + y * self.cosine,
            ],
            axis=-1,
        )


def spacing_of(scenario: MapScenario, num_waypoints: int) -> float:
    """Return the x' distance between waypoints."""
    return scenario.straight_line / (num_waypoints + 1)


def resampled(paths: Floats, scenario: MapScenario, num_waypoints: int) -> Floats:
    """Return the offsets, (m, num_waypoints), at which paths pass the waypoints of another start-target line.

    The paths need neither begin at the start of that line nor lead forward along it. From the start, each
    goes straight to its first point. Where a path passes the place of a waypoint several times, the last time
    counts.

    Args:
        paths: (m, k, 2) polylines in map coordinates that lead to the target.
        scenario: the scenario with the start-target line.
        num_waypoints: number of waypoints, evenly spaced on the line.
    """
    axes = RotatedAxes.of(scenario)
    x = spacing_of(scenario, num_waypoints) * np.arange(1, num_waypoints + 1)
    from_start = paths - np.array(axes.origin)
    # The start itself, the origin of the axes, is the first point.
    x_map, y_map = from_start[..., 0], from_start[..., 1]
    along = np.insert(x_map * axes.cosine + y_map * axes.sine, 0, 0.0, axis=1)
    beside = np.insert(y_map * axes.cosine - x_map * axes.sine, 0, 0.0, axis=1)
    is_before = along[:, :, None] <= x
    passes = is_before[:, :-1] != is_before[:, 1:]
    last = passes.shape[1] - 1 - np.argmax(passes[:, ::-1], axis=1)  # segments, (m, n)
    rows = np.arange(len(paths))[:, None]
    x0, x1, y0, y1 = along[rows, last], along[rows, last + 1], beside[rows, last], beside[rows, last + 1]
    return y0 + (y1 - y0) * ((x - x0) / (x1 - x0))


def offset_bounds(
    axes: RotatedAxes, x: Floats, workspace: tuple[float, float, float, float]
) -> tuple[Floats, Floats]:
    """Return the least and the largest offset, (n,) each, of waypoints at `x` that is inside the workspace.

    The workspace is (x_min, y_min, x_max, y_max). Offset 0 is always allowed.
    """
    x_min, y_min, x_max, y_max = workspace
    lower, upper = np.full(len(x), -np.inf), np.full(len(x), np.inf)
    foot = axes.to_map(x, np.zeros_like(x))
    # Across the start-target line, the map coordinates change with y' at these rates.
    for axis, rate, low, high in ((0, -axes.sine, x_min, x_max), (1, axes.cosine, y_min, y_max)):
        if rate != 0.0:
            ends = np.stack([(low - foot[:, axis]) / rate, (high - foot[:, axis]) / rate])
            lower = np.maximum(lower, ends.min(axis=0))
            upper = np.minimum(upper, ends.max(axis=0))
    return np.minimum(lower, 0.0), np.maximum(upper, 0.0)
