"""Conversion of obstacles and analytic maps to cells."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.grid_map import MAX_SIDE, Cell, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Polygon
from swarm_gym.scenarios.scenario import Scenario

# Depth in cells up to which an obstacle only touches a cell. It is well above rounding errors of map
# coordinates, so that a rectangle along the edges of cells blocks only the cells inside.
TOLERANCE = 1e-9


def rasterised(scenario: Scenario, cell_size: float) -> GridScenario:
    """Return an analytic map as a grid map; a path through free cells enters no obstacle.

    The grid covers the workspace. It is a little larger at its right and upper end where the workspace is not
    a whole number of cells. A start or target on the right or lower edge itself has a cell beyond it.

    Args:
        scenario: scenario to convert; its name is kept.
        cell_size: side of a cell, in map units.

    Raises:
        ScenarioError: if there are too many cells, if start or target lies in a blocked cell, or if no path
            through free cells connects them.
    """
    x_min, y_min, x_max, y_max = scenario.workspace
    width, height = (max(math.ceil(length / cell_size), 1) for length in (x_max - x_min, y_max - y_min))
    if max(width, height) > MAX_SIDE:
        raise ScenarioError(
            f"scenario {shown(scenario.name)}: cells of {cell_size:g} make a map of {width} x {height}, "
            f"expected at most {MAX_SIDE} x {MAX_SIDE}; choose a larger cell_size"
        )
    origin = (x_min + cell_size / 2.0, y_min + (height - 0.5) * cell_size)
    empty = GridMap(scenario.name, np.zeros((height, width), np.bool_), cell_size, origin, y_up=True)
    blocked = _beyond(empty, [empty.cell_of(end) for end in (scenario.start, scenario.target)])
    wider = GridMap(scenario.name, np.zeros_like(blocked), cell_size, origin, y_up=True)
    for obstacle in scenario.obstacles:
        blocked |= cells_of(obstacle, wider)
    grid = GridMap(scenario.name, blocked, cell_size, origin, y_up=True)
    return GridScenario(scenario.name, grid, scenario.start, scenario.target)


def _beyond(empty: GridMap, ends: Sequence[Cell]) -> NDArray[np.bool_]:
    """Return the cells of a map, all free, and where an end lies on the right or lower edge more beyond it.

    Of the column or row beyond the edge only the cell of the end is free.
    """
    height, width = empty.height, empty.width
    columns, rows = (any(end[axis] == size for end in ends) for axis, size in ((0, width), (1, height)))
    blocked = np.pad(empty.blocked, ((0, int(rows)), (0, int(columns))), constant_values=True)
    for column, row in ends:
        if (column == width and 0 <= row <= height) or (row == height and 0 <= column <= width):
            blocked[row, column] = False
        if column == width and row == height:  # the way out of the corner
            blocked[row, column - 1] = False
    return blocked


def cells_of(obstacle: Obstacle, grid: GridMap) -> NDArray[np.bool_]:
    """Return the cells that an obstacle in map coordinates blocks, bool of shape (height, width).

    A cell is blocked if the obstacle meets its open square. Parts of the obstacle outside the map block
    nothing.
    """
    column, row = np.meshgrid(np.arange(grid.width), np.arange(grid.height))
    if isinstance(obstacle, Circle):
        x, y = grid.to_cells((obstacle.x, obstacle.y)).tolist()
        beside = np.maximum(np.abs(column - x) - 0.5, 0.0)
        above = np.maximum(np.abs(row - y) - 0.5, 0.0)
        return np.hypot(beside, above) < obstacle.radius / grid.resolution - TOLERANCE
    # In cells; where y grows upwards on the map, the order of the vertices is reversed there.
    polygon = Polygon(tuple(map(tuple, grid.to_cells(obstacle.vertices).tolist())))
    (left, top), (right, bottom) = np.min(polygon.vertices, axis=0), np.max(polygon.vertices, axis=0)
    # Two convex shapes are disjoint if and only if the line through a side of one of them separates them.
    meets = (column + 0.5 > left + TOLERANCE) & (column - 0.5 < right - TOLERANCE)
    meets &= (row + 0.5 > top + TOLERANCE) & (row - 0.5 < bottom - TOLERANCE)
    for (x0, y0), (x1, y1) in polygon.edges():
        dx, dy = x1 - x0, y1 - y0
        # Distance of the innermost corner of a cell from the line of the side, times the length of the side.
        inside = dx * (row - y0) - dy * (column - x0) + (abs(dx) + abs(dy)) / 2.0
        meets &= inside > TOLERANCE * math.hypot(dx, dy)
    return meets
