"""The exact distance of a path from the obstacles of any map."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem.geometry.clearance import clearance
from swarm_gym.scenarios import Circle, GridScenario, MapScenario, Obstacle

Floats = NDArray[np.float64]


def clearance_of(scenario: MapScenario, path: Floats) -> float:
    """Return the least distance of a free path, (k, 2), from an obstacle, in map units; infinite without one.

    On grid maps an obstacle is the area of a blocked cell.
    """
    if isinstance(scenario, GridScenario):
        grid = scenario.map
        return clearance(grid.blocked, grid.to_cells(path)) * grid.resolution
    return min((_distance(path, obstacle) for obstacle in scenario.obstacles), default=math.inf)


def _distance(path: Floats, obstacle: Obstacle) -> float:
    if isinstance(obstacle, Circle):
        return max(_to_segments(np.array([(obstacle.x, obstacle.y)]), path) - obstacle.radius, 0.0)
    ring = np.array([*obstacle.vertices, obstacle.vertices[0]])
    # Of two polylines that do not cross, an end of a segment is among the closest points.
    return min(_to_segments(ring, path), _to_segments(path, ring))


def _to_segments(points: Floats, line: Floats) -> float:
    """Return the least distance of points, (m, 2), from the segments of a polyline, (k, 2)."""
    begins, changes = line[:-1], np.diff(line, axis=0)
    squares = (changes**2).sum(axis=1)
    offsets = points[:, None] - begins
    along = (offsets * changes).sum(axis=-1)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    return float(np.hypot(*np.moveaxis(offsets - share[..., None] * changes, -1, 0)).min())
