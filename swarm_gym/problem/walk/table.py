"""The problem table of walks on a grid map; see `tables`.

A member is a point that a walk from the start has come to; a straight line leads on to the target. The
fitness is the length of that line, and a penalty for the length of it that lies in blocked cells. That
blocked length, in map units, is the degree of collision.

Points are in map units, which kernels turn into cells, (column, row), cell centres at whole numbers.
"""

import math
from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.geometry.sight import sees, share_blocked, tabulate_rooms
from swarm_gym.problem.padding import Floats, Integers, Real, Whole, pad
from swarm_gym.scenarios import GridScenario


class WalkTable(NamedTuple, Generic[Whole, Real]):
    """The problem table of walks on a map of H x W cells, F of which are free.

    In a stacked table every field has a leading problem axis, and maps have the size of the largest one.
    """

    dimension: Whole  # length of decision vectors, 2
    resolution: Real  # map units per cell
    penalty: Real  # lambda, fitness per cell's length of blocked line
    num_columns: Whole  # W
    num_rows: Whole  # H
    num_free: Whole  # F
    lower: Floats  # (C,) bounds of points: the map
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population: the map
    initial_upper: Floats  # (C,)
    origin: Floats  # (2,) centre of cell (0, 0)
    scale: Floats  # (2,) columns per x, rows per y
    start: Floats  # (2,)
    target: Floats  # (2,)
    blocked: NDArray[np.bool_]  # (H, W)
    rooms: NDArray[np.int16]  # (H, W) see `sight.tabulate_rooms`
    nearest: NDArray[np.int16]  # (H, W, 2) column and row of the nearest free cell
    free: NDArray[np.int16]  # (F, 2) column and row of the free cells, row by row


WalkTables = WalkTable[Integers, Floats]  # of stacked problems


@kernel
def select(tables: WalkTables, index: int) -> WalkTable:
    """Return one problem table out of stacked ones, as views."""
    height, width = tables.num_rows[index], tables.num_columns[index]
    return WalkTable(
        tables.dimension[index],
        tables.resolution[index],
        tables.penalty[index],
        width,
        height,
        tables.num_free[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.origin[index],
        tables.scale[index],
        tables.start[index],
        tables.target[index],
        tables.blocked[index, :height, :width],
        tables.rooms[index, :height, :width],
        tables.nearest[index, :height, :width],
        tables.free[index],
    )


def tabulate(scenario: GridScenario, penalty: float) -> WalkTable:
    """Return the problem table of a map, with lambda fitness per cell's length of blocked line."""
    from scipy.ndimage import distance_transform_edt

    grid = scenario.map
    _, nearest = distance_transform_edt(grid.blocked, return_indices=True)
    row, column = np.nonzero(~grid.blocked)
    x_min, y_min, x_max, y_max = grid.extent
    lower, upper = pad(np.array([x_min, y_min])), pad(np.array([x_max, y_max]))
    return WalkTable(
        2,
        float(grid.resolution),
        float(penalty),
        grid.width,
        grid.height,
        len(row),
        lower,
        upper,
        lower,
        upper,
        grid.to_map((0.0, 0.0)),
        grid.to_cells(grid.to_map((0.0, 0.0)) + 1.0),
        np.array(scenario.start),
        np.array(scenario.target),
        grid.blocked,
        tabulate_rooms(grid.blocked),
        np.ascontiguousarray(nearest[::-1].transpose(1, 2, 0).astype(np.int16)),
        np.stack([column, row], axis=-1).astype(np.int16),
    )


@kernel(inline="late")
def to_cells(table: WalkTable, x: float, y: float) -> tuple[float, float]:
    """Return column and row, as real numbers, of a point in map units."""
    return (x - table.origin[0]) * table.scale[0], (y - table.origin[1]) * table.scale[1]


@kernel(inline="late")
def to_map(table: WalkTable, column: float, row: float) -> tuple[float, float]:
    """Return the point, in map units, of a column and a row."""
    return table.origin[0] + column / table.scale[0], table.origin[1] + row / table.scale[1]


@kernel(inline="late")
def cell_of(table: WalkTable, x: float, y: float) -> tuple[int, int]:
    """Return column and row of the cell in which a point of the map, in map units, lies."""
    column, row = to_cells(table, x, y)
    return (
        int(min(max(np.floor(column + 0.5), 0.0), table.num_columns - 1.0)),
        int(min(max(np.floor(row + 0.5), 0.0), table.num_rows - 1.0)),
    )


@kernel
def is_visible(table: WalkTable, x: float, y: float, to_x: float, to_y: float) -> bool:
    """Return whether two points, in map units, see each other; see `sight.sees`."""
    column, row = to_cells(table, x, y)
    to_column, to_row = to_cells(table, to_x, to_y)
    return sees(table.blocked, table.rooms, column, row, to_column, to_row)


@kernel
def share_blocked_between(table: WalkTable, x: float, y: float, to_x: float, to_y: float) -> float:
    """Return the blocked share of the straight line between two points, in map units; see `sight`."""
    column, row = to_cells(table, x, y)
    to_column, to_row = to_cells(table, to_x, to_y)
    return share_blocked(table.blocked, table.rooms, column, row, to_column, to_row)


@kernel
def evaluate(table: WalkTable, path: Floats) -> tuple[float, float]:
    """Return fitness and degree of collision of the point `path[1:3]`, both in map units; see `tables`."""
    x, y = path[1], path[2]
    length = math.hypot(table.target[0] - x, table.target[1] - y)
    collision = length * share_blocked_between(table, x, y, table.target[0], table.target[1])
    return length + table.penalty * collision / table.resolution, collision


@kernel(inline="late")
def repair(table: WalkTable, path: Floats, repair_degree: float) -> None:
    """Move the point `path[1:3]`, if its cell is blocked, by that share towards the nearest free cell."""
    column, row = cell_of(table, path[1], path[2])
    if table.blocked[row, column]:
        x, y = to_map(table, float(table.nearest[row, column, 0]), float(table.nearest[row, column, 1]))
        path[1] += repair_degree * (x - path[1])
        path[2] += repair_degree * (y - path[2])
