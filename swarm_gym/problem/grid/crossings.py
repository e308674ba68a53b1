"""The exact length of a path in blocked cells, of eight pieces at a time.

Points are (column, row) in cells: cell (c, r) is the square c ± 0.5, r ± 0.5. The border of the map is column
and row -1 and those after the last.

What lies within rounding of an edge or a corner of a cell is not decided here: it is in doubt, and
`geometry.traversal` decides it. That is rare, since almost no path meets an edge at so small an angle.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import (
    NUM_LANES,
    Lanes,
    bits,
    broadcast,
    floor,
    look_up,
    maximum,
    minimum,
    square_root,
    store,
    total,
    where,
)
from swarm_gym.problem.geometry.traversal import blocked_length, path_is_free
from swarm_gym.problem.grid.table import BLOCKED, GridTable

# Lengths in cells, and shares of a piece, below this are in doubt: far above what is taken for touching.
DOUBT = 1e-6


@kernel(inline="late")
def place_of(table: GridTable, columns: Lanes, rows: Lanes) -> Lanes:
    """Return the places of cells, on the map or its border, in the arrays of the table."""
    return (rows + 1.0) * table.num_columns + (columns + 1.0)


@kernel(inline="late", borrows=True)
def pieces(table: GridTable, x: Lanes, y: Lanes, dx: Lanes, dy: Lanes) -> tuple[float, bool]:
    """Return the blocked length of eight pieces, and whether it is in doubt."""
    reach = maximum(maximum(dx, -1.0 * dx), maximum(dy, -1.0 * dy)) + 1.0
    column, row = floor(x + 0.5), floor(y + 0.5)
    steps = look_up(table.steps_to_other, place_of(table, column, row))
    begins_blocked = steps >= BLOCKED
    begins = where(begins_blocked, 1.0, broadcast(0.0))
    length = square_root(dx * dx + dy * dy)
    if bits(reach > steps - BLOCKED * begins) == 0:  # none comes to a cell of the other kind
        return total(begins * length), False
    columns, rows = floor(x + dx + 0.5) - column, floor(y + dy + 0.5) - row
    if bits(maximum(columns * columns, rows * rows) > 1.0) == 0:
        return _short_pieces(table, x, y, dx, dy, begins)
    return _long_pieces(table, x, y, dx, dy)


@kernel(inline="late", borrows=True)
def _short_pieces(
    table: GridTable, x: Lanes, y: Lanes, dx: Lanes, dy: Lanes, begins: Lanes
) -> tuple[float, bool]:
    """Do what `pieces` does, for pieces that end in the cell where they begin or in one of its neighbours.

    Such a piece lies in these two cells and, if it crosses two grid lines, in one between. `begins` is 1
    where the first cell is blocked.
    """
    column, row = floor(x + 0.5), floor(y + 0.5)
    end_column, end_row = floor(x + dx + 0.5), floor(y + dy + 0.5)
    crosses_x = maximum(column, end_column) > minimum(column, end_column)
    crosses_y = maximum(row, end_row) > minimum(row, end_row)
    # The shares of the piece at which it crosses a line; 1 if it crosses none.
    to_line_x, to_line_y = maximum(column, end_column) - 0.5 - x, maximum(row, end_row) - 0.5 - y
    at_x = where(crosses_x, to_line_x / where(crosses_x, dx, 1.0), broadcast(1.0))
    at_y = where(crosses_y, to_line_y / where(crosses_y, dy, 1.0), broadcast(1.0))
    first = minimum(maximum(minimum(at_x, at_y), 0.0), 1.0)
    last = minimum(maximum(maximum(at_x, at_y), 0.0), 1.0)
    ends = look_up(table.blocked, place_of(table, end_column, end_row))
    share = begins * first + ends * (1.0 - last)
    if bits(crosses_x & crosses_y) == 0:
        share = share + ends * (last - first)
    else:
        x_first = at_x < at_y
        middle = place_of(table, where(x_first, end_column, column), where(x_first, row, end_row))
        share = share + look_up(table.blocked, middle) * (last - first)
    lengths = share * square_root(dx * dx + dy * dy)
    at_corner = (crosses_x | crosses_y) & (last - first < DOUBT)
    from_line = minimum(_from_line(x), _from_line(y))
    touches = (lengths > 0.0) & ((lengths < DOUBT) | (from_line < DOUBT))
    return total(lengths), bits(at_corner | touches) != 0


@kernel(inline="late")
def _from_line(position: Lanes) -> Lanes:
    """Return the distance to the nearest grid line."""
    share = position + 0.5 - floor(position + 0.5)
    return minimum(share, 1.0 - share)


@kernel
def _long_pieces(table: GridTable, x: Lanes, y: Lanes, dx: Lanes, dy: Lanes) -> tuple[float, bool]:
    """Do what `pieces` does, for pieces of any length."""
    numbers = np.empty((4, NUM_LANES))
    store(numbers, 0, x)
    store(numbers, 1, y)
    store(numbers, 2, dx)
    store(numbers, 3, dy)
    length, in_doubt = 0.0, False
    for lane in range(NUM_LANES):
        blocked, doubtful = segment(
            table, numbers[0, lane], numbers[1, lane], numbers[2, lane], numbers[3, lane]
        )
        length += blocked
        in_doubt = in_doubt or doubtful
    return length, in_doubt


@kernel(borrows=True)
def segment(table: GridTable, x: float, y: float, dx: float, dy: float) -> tuple[float, bool]:
    """Return the blocked length of one piece of any length, and whether that is in doubt.

    Grid lines of the kind that it crosses less often cut it into bands: rows, or columns. In a band, the
    number of blocked cells up to each cell is known (`GridTable.row_runs`, `column_runs`).
    """
    reach = max(abs(dx), abs(dy)) + 1.0
    place = (math.floor(y + 0.5) + 1) * int(table.num_columns) + math.floor(x + 0.5) + 1
    if reach <= table.steps_to_other[place] < BLOCKED:
        return 0.0, False
    if abs(dx) >= abs(dy):
        return _in_bands(table.row_runs, int(table.num_columns) + 1, x, y, dx, dy)
    return _in_bands(table.column_runs, int(table.num_rows) + 1, y, x, dy, dx)


@kernel(borrows=True)
def _in_bands(
    runs: NDArray[np.int16], stride: int, along: float, across: float, change: float, rise: float
) -> tuple[float, bool]:
    """Do what `segment` does, for bands along the direction of the larger change.

    Args:
        runs: number of blocked cells before each cell of a band, band after band.
        stride: entries of `runs` for each band.
        along: coordinate of the beginning along bands.
        across: coordinate of the beginning across bands.
        change: change of `along` up to the end.
        rise: change of `across` up to the end, no larger in size.
    """
    if rise < 0.0:  # from the other end
        along, across, change, rise = along + change, across + rise, -change, -rise
    first_band, last_band = math.floor(across + 0.5), math.floor(across + rise + 0.5)
    slope = change / rise if last_band > first_band else 0.0
    enters, blocked, in_doubt = along, 0.0, False
    for band in range(first_band, last_band + 1):
        leaves = along + change
        if band < last_band:
            leaves = along + (band + 0.5 - across) * slope
            in_doubt = in_doubt or _beside(leaves) < DOUBT
        low, high = min(enters, leaves), max(enters, leaves)
        first, last = math.floor(low + 0.5), math.floor(high + 0.5)
        begin = (band + 1) * stride + 1  # one band and one cell are the border
        before_first, after_last = runs[begin + first], runs[begin + last + 1]
        if after_last > before_first:
            # What is blocked up to a point: whole cells, and a share of the one in which it lies.
            upto_low = before_first + (runs[begin + first + 1] - before_first) * (low + 0.5 - first)
            upto_high = after_last - (after_last - runs[begin + last]) * (last + 0.5 - high)
            blocked += max(upto_high - upto_low, 0.0)
        enters = leaves
    if blocked == 0.0 or change == 0.0:  # of a piece without length, rounding may leave a rest
        at_corner = max(_beside(across), _beside(along)) < DOUBT
        at_corner = at_corner or max(_beside(across + rise), _beside(along + change)) < DOUBT
        return 0.0, in_doubt or at_corner
    length = blocked * math.sqrt(change * change + rise * rise) / abs(change)
    # In doubt: where it barely touches cells, or runs along them.
    beside = min(_beside(across), _beside(across + rise))
    return length, in_doubt or length < DOUBT or (rise < DOUBT and beside < 2.0 * DOUBT)


@kernel(inline="late")
def _beside(position: float) -> float:
    """Return the distance of one coordinate to the nearest grid line."""
    share = position + 0.5 - math.floor(position + 0.5)
    return min(share, 1.0 - share)


@kernel
def exact_length(table: GridTable, points: NDArray[np.float64]) -> float:
    """Return the blocked length of a polyline, (k, 2), as `geometry.traversal` measures it.

    A path of length 0 there that is not free, since it passes a closed gap, has the length `DOUBT`.
    """
    num_columns, num_rows = int(table.num_columns), int(table.num_rows)
    cells: Any = table.blocked[: num_rows * num_columns].reshape(num_rows, num_columns)
    points = points + 1.0  # the border is row and column 0 of these cells
    length = blocked_length(cells, points)
    if length == 0.0 and not path_is_free(cells, points):
        return DOUBT
    return length
