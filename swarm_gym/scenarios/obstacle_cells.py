"""Which cells of a grid map an obstacle of map coordinates blocks."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.scenario import Circle, Obstacle, Polygon

# How deep, in cells, an obstacle may reach into a cell and still only touch it: well above rounding errors of
# map coordinates, so that a rectangle along the edges of cells blocks those inside alone.
TOLERANCE = 1e-9


def cells_of(obstacle: Obstacle, grid: GridMap) -> NDArray[np.bool_]:
    """The cells whose open squares the obstacle meets, bool of shape (height, width).

    What lies beside the map blocks nothing.
    """
    column, row = np.meshgrid(np.arange(grid.width), np.arange(grid.height))
    if isinstance(obstacle, Circle):
        x, y = grid.to_cells((obstacle.x, obstacle.y)).tolist()
        beside = np.maximum(np.abs(column - x) - 0.5, 0.0)
        above = np.maximum(np.abs(row - y) - 0.5, 0.0)
        return np.hypot(beside, above) < obstacle.radius / grid.resolution - TOLERANCE
    # The same polygon in cells; where y grows upwards, it is another way round there.
    polygon = Polygon(tuple(map(tuple, grid.to_cells(obstacle.vertices).tolist())))
    (left, top), (right, bottom) = np.min(polygon.vertices, axis=0), np.max(polygon.vertices, axis=0)
    # Two convex shapes are apart if and only if the line of a side of one of them parts them.
    meets = (column + 0.5 > left + TOLERANCE) & (column - 0.5 < right - TOLERANCE)
    meets &= (row + 0.5 > top + TOLERANCE) & (row - 0.5 < bottom - TOLERANCE)
    for (x0, y0), (x1, y1) in polygon.edges():
        dx, dy = x1 - x0, y1 - y0
        # How far inside the side's line the innermost corner of a cell lies, times the length of the side.
        inside = dx * (row - y0) - dy * (column - x0) + (abs(dx) + abs(dy)) / 2.0
        meets &= inside > TOLERANCE * math.hypot(dx, dy)
    return meets
