"""Fitness of a path on a grid map: its length, and a penalty for what of it lies in blocked cells.

Source: MOA paper, `f = L + lambda * N_im`, lambda = 500; there N_im counts the samples in blocked cells or
outside the map. Here it is the share of the length that lies there, measured exactly, times the number of
pieces between samples: the same number where samples are many and even, and 0 for free paths only. The
degree of collision is the blocked length itself, in map units, so that thresholds on E(P) keep a meaning.

Where distance from obstacles or costs of ground have weights, the integral of their sum along the path is
added, see `swarm_gym.problem.grid.nearness`.

Where curvature has a weight w, w times the integral of the squared curvature is added. For a polyline it is
the sum of |t - t'|^2 / l over its bends. There t and t' are the unit vectors of the pieces that meet, and l
is the mean of their lengths. On fine polylines of smooth curves that tends to the integral. A bend that turns
back entirely costs 4 w / l.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import (
    NUM_LANES,
    Lanes,
    broadcast,
    floor,
    load,
    maximum,
    minimum,
    square_root,
    store,
    total,
)
from swarm_gym.problem.grid.crossings import exact_length, pieces, place_of, segment
from swarm_gym.problem.grid.nearness import integral
from swarm_gym.problem.grid.table import GridTable

Floats = NDArray[np.float64]


@kernel(inline="late", borrows=True)
def evaluate(table: GridTable, path: Floats) -> tuple[float, float]:
    """Return fitness (minimised) and degree of collision of a path, both in map units; see `tables`."""
    if is_polyline(table):
        length, blocked, in_doubt = _measure_polyline(table, path)
    else:
        length, blocked, in_doubt = _measure_curve(table, path)
    if in_doubt:
        blocked = _exactly(table, path)
    share = min(blocked / length, 1.0)
    if table.row_costs.shape[0] > 0 or table.curvature_weight > 0.0:
        length += _wishes(table, path)
    return length * table.resolution + table.penalty * table.num_pieces * share, blocked * table.resolution


@kernel(inline="late")
def is_polyline(table: GridTable) -> bool:
    """Return whether paths are straight between control points; else they are curves."""
    return table.weights.shape[0] == 2 * table.first.shape[0]


@kernel(inline="late")
def control_point(table: GridTable, path: Floats, point: int) -> tuple[float, float]:
    """Return (column, row) of a control point of a path."""
    column = table.base[point, 0] + table.gain[point, 0] * path[table.source[point, 0]]
    row = table.base[point, 1] + table.gain[point, 1] * path[table.source[point, 1]]
    return column, row


@kernel(inline="late")
def samples_of(table: GridTable, path: Floats, block: int) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Return the columns and rows of eight samples, and their ways to the next ones."""
    width = table.weights.shape[0] // table.first.shape[0]
    x, y, dx, dy = broadcast(0.0), broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for k in range(width):
        column, row = control_point(table, path, table.first[block] + k)
        weight, step = load(table.weights, block * width + k), load(table.steps, block * width + k)
        x, y = x + weight * column, y + weight * row
        dx, dy = dx + step * column, dy + step * row
    return x, y, dx, dy


@kernel(inline="late")
def cells_of(table: GridTable, x: Lanes, y: Lanes) -> Lanes:
    """Return the places, in the arrays of the table, of the cells of points; far points lie in the border."""
    # Rounded as by `GridMap.cell_of`: 1.5 in one sum could lead to another cell.
    column = floor(minimum(maximum(x, -1.0), table.num_columns - 2.0) + 0.5)
    row = floor(minimum(maximum(y, -1.0), table.num_rows - 2.0) + 0.5)
    return place_of(table, column, row)


@kernel(borrows=True)
def _measure_polyline(table: GridTable, path: Floats) -> tuple[float, float, bool]:
    """Return the length and the blocked length of a polyline, and whether the latter is in doubt."""
    length, blocked = 0.0, 0.0
    x, y = control_point(table, path, 0)
    in_doubt = not _is_on_map(table, x, y)
    for point in range(1, table.base.shape[0]):
        to_x, to_y = control_point(table, path, point)
        dx, dy = to_x - x, to_y - y
        length += math.sqrt(dx * dx + dy * dy)
        in_doubt = in_doubt or not _is_on_map(table, to_x, to_y)
        if not in_doubt:
            colliding, in_doubt = segment(table, x, y, dx, dy)
            blocked += colliding
        x, y = to_x, to_y
    return length, blocked, in_doubt


@kernel(borrows=True)
def _measure_curve(table: GridTable, path: Floats) -> tuple[float, float, bool]:
    """Return the length and the blocked length of a curve, and whether the latter is in doubt."""
    lengths, blocked, in_doubt = broadcast(0.0), 0.0, False
    for point in range(table.base.shape[0]):
        x, y = control_point(table, path, point)
        in_doubt = in_doubt or not _is_on_map(table, x, y)
    for block in range(table.first.shape[0]):
        columns, rows, dx, dy = samples_of(table, path, block)
        lengths = lengths + square_root(dx * dx + dy * dy)
        if not in_doubt:
            colliding, in_doubt = pieces(table, columns, rows, dx, dy)
            blocked += colliding
    return total(lengths), blocked, in_doubt


@kernel(inline="late")
def _is_on_map(table: GridTable, x: float, y: float) -> bool:
    # Of the outermost cells, the outer edges are left out: they are in doubt.
    return -0.499 < x < table.num_columns - 2.501 and -0.499 < y < table.num_rows - 2.501


@kernel
def _exactly(table: GridTable, path: Floats) -> float:
    """Return the blocked length of a path that is in doubt."""
    return exact_length(table, _points(table, path))


@kernel
def _wishes(table: GridTable, path: Floats) -> float:
    """Return what the costs of cells and the curvature of a path add to its length, in cells."""
    points, found = _points(table, path), 0.0
    if table.row_costs.shape[0] > 0:
        found += integral(table, points)
    if table.curvature_weight > 0.0:
        found += table.curvature_weight * _bending(points)
    return found


@kernel(borrows=True)
def _bending(points: Floats) -> float:
    """Return the integral of the squared curvature along a polyline, (k, 2) cells, in 1 / cell.

    Points in the same place count once.
    """
    found, before, x, y = 0.0, 0.0, 0.0, 0.0
    for k in range(points.shape[0] - 1):
        dx, dy = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            dx, dy = dx / length, dy / length
            if before > 0.0:
                found += 2.0 * ((dx - x) * (dx - x) + (dy - y) * (dy - y)) / (before + length)
            before, x, y = length, dx, dy
    return found


@kernel
def _points(table: GridTable, path: Floats) -> Floats:
    """Return the path as a polyline, (k, 2), in cells."""
    num_points, num_blocks = table.base.shape[0], table.first.shape[0]
    if is_polyline(table):
        points = np.empty((num_points, 2))
        for point in range(num_points):
            points[point, 0], points[point, 1] = control_point(table, path, point)
        return points
    columns, rows = np.empty(num_blocks * NUM_LANES), np.empty(num_blocks * NUM_LANES)
    for block in range(num_blocks):
        xs, ys, _, _ = samples_of(table, path, block)
        store(columns, block * NUM_LANES, xs)
        store(rows, block * NUM_LANES, ys)
    points = np.empty((num_blocks * NUM_LANES, 2))
    points[:, 0], points[:, 1] = columns, rows
    return points
