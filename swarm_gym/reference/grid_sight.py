"""Search of the corners of blocked cells that a point of an occupancy grid sees.

Intervals of rays grow row by row.

Source: after the projection of intervals in D. Harabor, A. Grastien, D. Öz, V. Aksakalli, "Optimal any-angle
pathfinding in practice", J. Artif. Intell. Res. 56:89-118, 2016.

A grid has a ring of blocked cells around it here. The cell in column c and row r is the square from c to c +
1 and from r to r + 1: points (column, row) are shifted by `SHIFT`. A corner is a crossing of grid lines with
one blocked cell out of four: only there a shortest path can turn.

Sight is a set of rays, given by their slopes: columns per row of distance. The slope to a corner is one
division. For points at corners and centres, its numbers are exact, so that equal slopes have equal bits: two
corners on one ray leave nothing open between them. Rays that touch blocked cells on both sides are left out:
what they reach is also seen, straight on, from one of the corners that they touch. So gaps without width are
closed.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.geometry.traversal import TOLERANCE, is_gap

SHIFT = 1.5
# Columns by which a run of free cells is sought farther than an interval reaches: above rounding errors,
# below the distance of two corners.
MARGIN = 1e-6


class SightGrid(NamedTuple):
    """A grid with its corners, which are numbered by rows."""

    blocked: NDArray[np.bool_]
    "Cells with a ring of blocked ones around, (height, width)."
    run_begins: NDArray[np.int32]
    "First column of the run of cells of one kind in which a cell lies, (height, width)."
    run_ends: NDArray[np.int32]
    "The column behind that run, (height, width)."
    corners_before: NDArray[np.int32]
    "Number of corners above a crossing of grid lines, and left of it in its row, (height + 1, width + 2)."
    corner_columns: NDArray[np.int32]
    "Columns of the corners, (n,)."
    corner_rows: NDArray[np.int32]
    "Rows of the corners, (n,)."
    blocked_columns: NDArray[np.int32]
    "Side of a corner on which its blocked cell is, left (-1) or right (1), (n,)."
    blocked_rows: NDArray[np.int32]
    "Side of a corner on which its blocked cell is, above (-1) or below (1), (n,)."


def make_sight_grid(blocked: NDArray[np.bool_]) -> SightGrid:
    """Find the runs and corners of a grid, (height, width) without the ring."""
    ringed = np.pad(blocked, 1, constant_values=True)
    height, width = ringed.shape
    columns = np.arange(width, dtype=np.int32)
    changes = ringed[:, 1:] != ringed[:, :-1]
    begins = np.maximum.accumulate(np.where(np.pad(changes, ((0, 0), (1, 0))), columns, np.int32(0)), axis=1)
    last = np.where(np.pad(changes, ((0, 0), (0, 1))), columns + 1, np.int32(width))
    ends = np.minimum.accumulate(last[:, ::-1], axis=1)[:, ::-1]

    around = np.stack([ringed[:-1, :-1], ringed[:-1, 1:], ringed[1:, :-1], ringed[1:, 1:]])
    is_corner = np.zeros((height + 1, width + 2), bool)
    is_corner[1:height, 1:width] = around.sum(axis=0) == 1
    corner_rows, corner_columns = np.nonzero(is_corner)
    quadrant = around[:, corner_rows - 1, corner_columns - 1].argmax(axis=0)
    counts = np.cumsum(is_corner.ravel()).reshape(is_corner.shape) - is_corner
    return SightGrid(
        ringed,
        begins,
        np.ascontiguousarray(ends),
        counts.astype(np.int32),
        corner_columns.astype(np.int32),
        corner_rows.astype(np.int32),
        (quadrant % 2 * 2 - 1).astype(np.int32),
        (quadrant // 2 * 2 - 1).astype(np.int32),
    )


class CornerSight(NamedTuple):
    """Results and scratch arrays of the kernels below."""

    corners: NDArray[np.int64]
    "Numbers of corners, (n,)."
    intervals: NDArray[np.float64]
    "Least and greatest slopes of the rays through a row and through the next one, (2, width + 1, 2)."


def make_sight(grid: SightGrid) -> CornerSight:
    """Allocate the arrays for a grid."""
    return CornerSight(
        np.zeros(grid.corner_columns.size, np.int64), np.zeros((2, grid.blocked.shape[1] + 1, 2))
    )


@kernel
def see_from_point(grid: SightGrid, x: float, y: float, sight: CornerSight) -> int:
    """Find the corners to which a shortest path can lead straight from a point.

    They are those that are in sight, and behind which the path could turn: not where it would run into the
    corner's blocked cell straight on.

    Args:
        grid: the grid with its corners.
        x: shifted column of a point that touches a free cell.
        y: shifted row of that point.
        sight: arrays for the result; `corners` is set in place.

    Returns:
        The number of corners that were found.
    """
    return _see_around(grid, x, y, False, sight)


@kernel
def see_every_corner(grid: SightGrid, x: float, y: float, sight: CornerSight) -> int:
    """Find all corners that a point sees, also those where a path could not turn.

    The point is a corner or touches a free cell; arguments and result are as in `see_from_point`.
    """
    return _see_around(grid, x, y, True, sight)


@kernel
def _see_around(grid: SightGrid, x: float, y: float, every: bool, sight: CornerSight) -> int:
    """Find the corners that a point sees: `every` one, or those where a path could turn."""
    # A point that a rounding error puts next to a grid line would see nothing along that line.
    if abs(x - round(x)) <= TOLERANCE:
        x = float(round(x))
    if abs(y - round(y)) <= TOLERANCE:
        y = float(round(y))
    found = _see_rows(grid, x, y, -1, -math.inf, math.inf, every, sight, 0)
    found = _see_rows(grid, x, y, 1, -math.inf, math.inf, every, sight, found)
    if y == round(y):
        found = _see_along_line(grid, x, y, every, sight, found)
    return found


@kernel
def see_from_corner(grid: SightGrid, corner: int, sight: CornerSight) -> int:
    """Find the corners to which a shortest path can lead straight from a corner where it turns.

    Like `see_from_point`; in addition, nothing is sought opposite of the corner's blocked cell, since a path
    which goes there has no reason to turn at it.
    """
    x, y = float(grid.corner_columns[corner]), float(grid.corner_rows[corner])
    side, step = grid.blocked_columns[corner], grid.blocked_rows[corner]
    low, high = (-math.inf, 0.0) if side < 0 else (0.0, math.inf)
    found = _see_rows(grid, x, y, -step, low, high, False, sight, 0)
    found = _see_rows(grid, x, y, step, -math.inf, math.inf, False, sight, found)
    return _see_along_line(grid, x, y, False, sight, found)


@kernel
def _see_rows(
    grid: SightGrid,
    x: float,
    y: float,
    step: int,
    low: float,
    high: float,
    every: bool,
    sight: CornerSight,
    found: int,
) -> int:
    """Add the corners above (step -1) or below (1) a point on rays of the slopes `low` to `high`.

    Unless `every` is set, corners into whose blocked cell the ray would run are left out.
    """
    row = math.floor(y) if step > 0 else math.ceil(y) - 1
    line = row + 1 if step > 0 else row
    run = _free_run(grid, row, x)
    if run < 0:
        return found
    far = abs(line - y)
    low = max(low, (grid.run_begins[row, run] - x) / far)
    high = min(high, (grid.run_ends[row, run] - x) / far)
    if not low < high:
        return found
    sight.intervals[0, 0, 0], sight.intervals[0, 0, 1] = low, high
    found = _add_corners(grid, line, x, step, far, low, high, every, sight, found)
    number, now = 1, 0
    while number > 0:
        near = far
        row += step
        line += step
        far = abs(line - y)
        passed = 0
        for k in range(number):
            low, high = sight.intervals[now, k, 0], sight.intervals[now, k, 1]
            column = math.floor(x + low * near - MARGIN)
            last = math.floor(x + high * near + MARGIN)
            column, last = max(column, 0), min(last, grid.blocked.shape[1] - 1)
            while column <= last:
                end = grid.run_ends[row, column]
                if not grid.blocked[row, column]:
                    left, right = grid.run_begins[row, column] - x, end - x
                    least = max(low, left / near, left / far)
                    greatest = min(high, right / near, right / far)
                    if least < greatest:
                        sight.intervals[1 - now, passed, 0] = least
                        sight.intervals[1 - now, passed, 1] = greatest
                        passed += 1
                        found = _add_corners(grid, line, x, step, far, least, greatest, every, sight, found)
                column = end
        number, now = passed, 1 - now
    return found


@kernel
def _free_run(grid: SightGrid, row: int, x: float) -> int:
    """Return a column of the run of free cells in a row that a point is in or touches, or -1."""
    column = math.floor(x)
    if not grid.blocked[row, column]:
        return column
    if column == x and not grid.blocked[row, column - 1]:
        return column - 1
    return -1


@kernel
def _add_corners(
    grid: SightGrid,
    line: int,
    x: float,
    step: int,
    distance: float,
    low: float,
    high: float,
    every: bool,
    sight: CornerSight,
    found: int,
) -> int:
    """Add the corners on a line between two rays."""
    width = grid.blocked.shape[1]
    begin = max(math.ceil(x + low * distance - MARGIN), 0)
    end = min(math.floor(x + high * distance + MARGIN), width)
    for corner in range(grid.corners_before[line, begin], grid.corners_before[line, end + 1]):
        across = grid.corner_columns[corner] - x
        ends_here = grid.blocked_rows[corner] == step and grid.blocked_columns[corner] * across > 0.0
        if low <= across / distance <= high and (every or not ends_here):
            sight.corners[found] = corner
            found += 1
    return found


@kernel
def _see_along_line(grid: SightGrid, x: float, y: float, every: bool, sight: CornerSight, found: int) -> int:
    """Add the first corner, or every one, on both sides of a point on a horizontal grid line."""
    line = int(y)
    for step in (-1, 1):
        column = math.floor(x) if step > 0 else math.ceil(x) - 1
        while not (grid.blocked[line - 1, column] and grid.blocked[line, column]):
            crossing = column + 1 if step > 0 else column
            before = grid.corners_before[line, crossing]
            if grid.corners_before[line, crossing + 1] > before:
                sight.corners[found] = before
                found += 1
                if not every:
                    break
            if is_gap(grid.blocked, crossing, line):
                break
            column += step
    return found
