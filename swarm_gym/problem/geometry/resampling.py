"""Paths that are to begin elsewhere, as offsets of waypoints beside another start-target line."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem.analytic.table import spacing_of
from swarm_gym.problem.geometry.rotation import Frame
from swarm_gym.scenarios import MapScenario

Floats = NDArray[np.float64]


def resampled(paths: Floats, scenario: MapScenario, num_waypoints: int) -> Floats:
    """Offsets, (m, num_waypoints), at which paths pass the waypoints beside the line of a scenario.

    The paths, (m, k, 2) in map coordinates, lead to its target, but not all through its start, nor forward
    along the line: from the start each goes straight to its first point, and where it passes the place of a
    waypoint several times, the last one counts.
    """
    frame = Frame.of(scenario)
    x = spacing_of(scenario, num_waypoints) * np.arange(1, num_waypoints + 1)
    ways = paths - np.array(frame.origin)
    # The start itself, the origin of the frame, is the first point.
    along = np.insert(ways[..., 0] * frame.cosine + ways[..., 1] * frame.sine, 0, 0.0, axis=1)
    beside = np.insert(ways[..., 1] * frame.cosine - ways[..., 0] * frame.sine, 0, 0.0, axis=1)
    is_before = along[:, :, None] <= x
    passes = is_before[:, :-1] != is_before[:, 1:]
    last = passes.shape[1] - 1 - np.argmax(passes[:, ::-1], axis=1)  # segments, (m, n)
    rows = np.arange(len(paths))[:, None]
    x0, x1, y0, y1 = along[rows, last], along[rows, last + 1], beside[rows, last], beside[rows, last + 1]
    return y0 + (y1 - y0) * ((x - x0) / (x1 - x0))
