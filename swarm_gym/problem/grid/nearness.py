"""Cost of nearness to blocked cells, which the fitness on grid maps can count with a weight.

The cost of nearness e = exp(-(d - margin) / decay) decays with the distance d of a cell's middle from blocked
cells, as Nav2's inflation layer does. The decay is the margin, and `DECAY` cells at least. The cost of a path
is the integral of e along it, measured exactly. The integral along each row of cells up to each cell is
known. So a piece of any length is measured row by row, or column by column where it is steep.

Outside the map and in blocked cells e is 0; there the penalty counts. A piece that runs exactly along the
border of two cells counts in the one with the larger row or column.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.grid.table import GridTable
from swarm_gym.scenarios import GridMap

Floats = NDArray[np.float64]

DECAY = 3.0  # cells, at least, within which the cost of nearness falls to 1 / e


@lru_cache(maxsize=4)
def nearness(grid: GridMap, margin: float) -> Floats:
    """Return the cost of nearness of each cell, (height, width), for a margin in map units."""
    from scipy import ndimage

    near = np.zeros(grid.blocked.shape)
    if grid.blocked.any():
        # The distance of a cell's middle from the area of a blocked cell, on a grid of half cells.
        areas = np.zeros((2 * grid.height + 1, 2 * grid.width + 1), dtype=np.bool_)
        areas[1::2, 1::2] = grid.blocked
        areas = ndimage.binary_dilation(areas, np.ones((3, 3), dtype=np.bool_))
        apart = ndimage.distance_transform_edt(~areas)[1::2, 1::2] / 2.0
        cells = margin / grid.resolution
        near = np.exp(-np.maximum(apart - cells, 0.0) / max(cells, DECAY))
        near[grid.blocked] = 0.0
    near.setflags(write=False)
    return near


@kernel(borrows=True)
def integral(table: GridTable, points: Floats) -> float:
    """Return the integral of the weighted costs of cells along a polyline, (k, 2), both in cells."""
    found = 0.0
    for k in range(points.shape[0] - 1):
        x, y = points[k, 0], points[k, 1]
        found += _along(table, x, y, points[k + 1, 0] - x, points[k + 1, 1] - y)
    return found


@kernel(borrows=True)
def _along(table: GridTable, x: float, y: float, dx: float, dy: float) -> float:
    """Return the integral along one piece; what lies outside the map counts 0."""
    first, last = _inside(x, dx, table.num_columns - 2.5, 0.0, 1.0)
    first, last = _inside(y, dy, table.num_rows - 2.5, first, last)
    if not first < last:
        return 0.0
    x, y, dx, dy = x + first * dx, y + first * dy, (last - first) * dx, (last - first) * dy
    if abs(dx) >= abs(dy):
        return _in_bands(table.row_costs, int(table.num_columns) + 1, x, y, dx, dy)
    return _in_bands(table.column_costs, int(table.num_rows) + 1, y, x, dy, dx)


@kernel(inline="late")
def _inside(position: float, change: float, limit: float, first: float, last: float) -> tuple[float, float]:
    """Return the shares of a piece, within the given ones, between which a coordinate is in [-0.5, limit]."""
    if change == 0.0:
        return (first, last) if -0.5 <= position <= limit else (1.0, 0.0)
    low, high = (-0.5 - position) / change, (limit - position) / change
    return max(first, min(low, high)), min(last, max(low, high))


@kernel(borrows=True)
def _in_bands(costs: Floats, stride: int, along: float, across: float, change: float, rise: float) -> float:
    """Do what `_along` does, for bands along the direction of the larger change.

    Args:
        costs: cost before each cell of a band, band after band.
        stride: entries of `costs` for each band.
        along: coordinate of the beginning along bands.
        across: coordinate of the beginning across bands.
        change: change of `along` up to the end, not 0.
        rise: change of `across` up to the end, no larger in size.
    """
    if rise < 0.0:  # from the other end
        along, across, change, rise = along + change, across + rise, -change, -rise
    first_band, last_band = math.floor(across + 0.5), math.floor(across + rise + 0.5)
    slope = change / rise if last_band > first_band else 0.0
    enters, found = along, 0.0
    for band in range(first_band, last_band + 1):
        leaves = along + change
        if band < last_band:
            leaves = along + (band + 0.5 - across) * slope
        begin = (band + 1) * stride + 1  # one band and one cell are the border
        found += abs(_up_to(costs, begin, leaves) - _up_to(costs, begin, enters))
        enters = leaves
    return found * math.sqrt(change * change + rise * rise) / abs(change)


@kernel(inline="late", borrows=True)
def _up_to(costs: Floats, begin: int, position: float) -> float:
    """Return the cost of a band up to a position: of whole cells, and of a share of the one where it lies."""
    cell = math.floor(position + 0.5)
    before = costs[begin + cell]
    return before + (costs[begin + cell + 1] - before) * (position + 0.5 - cell)
