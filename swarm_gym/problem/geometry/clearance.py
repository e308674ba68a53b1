"""The exact distance of a path from the obstacles of any map, and from the blocked cells of a grid.

Points on grids are (column, row) in cells, as in `traversal`. Unlike there, the outside of the grid is no
obstacle.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
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


@entry
def clearance(blocked: NDArray[np.bool_], points: Floats) -> float:
    """Return the least distance of a polyline, (k, 2), from the areas of blocked cells, in cells.

    It is 0 for a path that enters one or touches it, and infinite where no cell is blocked.
    """
    return _least(blocked, points, math.inf)


@entry
def keeps_distance(blocked: NDArray[np.bool_], points: Floats, distance: float) -> bool:
    """Return whether no point of a polyline, (k, 2), is closer than a distance to a blocked cell, in cells.

    Only cells within that distance are looked at, so that it is quicker than `clearance`.
    """
    return _least(blocked, points, distance) >= distance


@kernel
def _least(blocked: NDArray[np.bool_], points: Floats, least: float) -> float:
    """Return the least distance of a polyline, (k, 2), from blocked cells, or `least` if that is less."""
    height, width = blocked.shape
    last = points.shape[0] - 1
    for k in range(max(last, 1)):
        x0, y0 = points[k]
        x1, y1 = points[min(k + 1, last)]
        # Only cells in this range may be closer than the closest so far.
        reach = least + 0.5
        left, right = _within(min(x0, x1) - reach, width), _within(max(x0, x1) + reach, width)
        top, bottom = _within(min(y0, y1) - reach, height), _within(max(y0, y1) + reach, height)
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                if blocked[row, column]:
                    least = min(least, _to_cell(x0 - column, y0 - row, x1 - column, y1 - row))
    return least


@kernel(inline="late")
def _within(position: float, number: int) -> int:
    """Return the nearest index from 0 to `number` - 1."""
    return int(min(max(np.floor(position + 0.5), 0.0), number - 1.0))


@kernel
def _to_cell(x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the distance of a segment from the unit square around the origin."""
    if _enters(x0, y0, x1, y1):
        return 0.0
    # Of two convex polygons that are apart, a vertex of one is among the closest points.
    least = min(_point_to_cell(x0, y0), _point_to_cell(x1, y1))
    for x, y in ((-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)):
        least = min(least, _point_to_segment(x, y, x0, y0, x1, y1))
    return least


@kernel(inline="late")
def _enters(x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether a segment meets the unit square around the origin.

    It does if the parts of it that lie in the square's column and in its row overlap.
    """
    begin, end = 0.0, 1.0
    for start, change in ((x0, x1 - x0), (y0, y1 - y0)):
        if change == 0.0:
            if abs(start) > 0.5:
                return False
            continue
        one, two = (-0.5 - start) / change, (0.5 - start) / change
        begin, end = max(begin, min(one, two)), min(end, max(one, two))
    return begin <= end


@kernel(inline="late")
def _point_to_cell(x: float, y: float) -> float:
    return math.hypot(max(abs(x) - 0.5, 0.0), max(abs(y) - 0.5, 0.0))


@kernel(inline="late")
def _point_to_segment(x: float, y: float, x0: float, y0: float, x1: float, y1: float) -> float:
    dx, dy = x1 - x0, y1 - y0
    squared = dx * dx + dy * dy
    share = 0.0
    if squared > 0.0:
        share = min(max(((x - x0) * dx + (y - y0) * dy) / squared, 0.0), 1.0)
    return math.hypot(x - x0 - share * dx, y - y0 - share * dy)
