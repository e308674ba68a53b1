"""Discs and convex polygons as arrays, in square cells that name the obstacles near them.

An obstacle blocks a segment that comes deeper into it than a tolerance.
"""

import math
from typing import NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel

Entry = TypeVar("Entry", bound=np.generic)
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_CELLS_PER_SIDE = 64
NONE = cast(int, np.int64(0))  # counts begin with it: Numba would compile what takes a literal 0 twice
SLACK = 1e-6  # by which obstacles reach beyond their outline when cells are filled, in cells


class Solids(NamedTuple):
    """Obstacles, and the depth up to which a path may enter them."""

    circles: Floats
    "Centre and radius of each disc, or of a circle around each polygon, (n, 3)."
    first: Integers
    "Index of the first plane of each obstacle, and the number of planes, (n + 1,). A disc has none."
    planes: Floats
    "Half-planes, whose intersections are the polygons: unit normal inwards, and where the edge is, (m, 3)."
    tolerance: float
    "Depth up to which an obstacle counts as touched."


class Cells(NamedTuple):
    """A grid of square cells over a scene, and the obstacles that reach into each."""

    x: float
    "Left end of the grid."
    y: float
    "Lower end of the grid."
    side: float
    "Side of a cell."
    columns: int
    "Number of columns."
    rows: int
    "Number of rows."
    first: Integers
    "Index of the first entry of each cell, row by row, and the number of entries."
    entries: Integers
    "Numbers of obstacles."
    stamps: Integers
    "Query that saw an obstacle last, (n,); the last element, with index n, counts the queries."


@kernel
def extended(array: NDArray[Entry], length: int, fill: float) -> NDArray[Entry]:
    """Return an array that begins with the elements of another and continues with a value."""
    longer = np.empty((length,) + array.shape[1:], array.dtype)  # noqa: RUF005 (Numba knows no other way)
    # Loops are compiled in a tenth of the time that slices take.
    old, new = array.reshape(array.size), longer.reshape(longer.size)
    for k in range(old.size):
        new[k] = old[k]
    for k in range(old.size, new.size):
        new[k] = fill
    return longer


@kernel
def depth(solids: Solids, o: int, x: float, y: float) -> float:
    """Return the distance of a point from the outside of an obstacle; negative at a point outside."""
    circles, planes = solids.circles, solids.planes
    least = circles[o, 2] - math.sqrt((x - circles[o, 0]) ** 2 + (y - circles[o, 1]) ** 2)
    for k in range(solids.first[o], solids.first[o + 1]):
        least = min(least, planes[k, 0] * x + planes[k, 1] * y - planes[k, 2])
    return least


@kernel
def enters(solids: Solids, o: int, px: float, py: float, qx: float, qy: float) -> bool:
    """Return whether a segment comes deeper into an obstacle than the tolerance."""
    circles, planes, tolerance = solids.circles, solids.planes, solids.tolerance
    x, y, reach = circles[o, 0], circles[o, 1], circles[o, 2] - tolerance
    dx, dy = qx - px, qy - py
    square = dx * dx + dy * dy
    t = 0.0
    if square > 0.0:
        t = min(max(((x - px) * dx + (y - py) * dy) / square, 0.0), 1.0)
    x, y = px + t * dx - x, py + t * dy - y
    if reach <= 0.0 or x * x + y * y >= reach * reach:
        return False
    begin, end = 0.0, 1.0
    for k in range(solids.first[o], solids.first[o + 1]):
        inside = planes[k, 0] * px + planes[k, 1] * py - planes[k, 2] - tolerance
        change = planes[k, 0] * dx + planes[k, 1] * dy
        if inside <= 0.0 and inside + change <= 0.0:
            return False
        if inside < 0.0:
            begin = max(begin, -inside / change)
        elif inside + change < 0.0:
            end = min(end, -inside / change)
    return begin < end


@kernel
def make_cells(solids: Solids, left: float, bottom: float, right: float, top: float) -> Cells:
    """Return the cells of a scene that lies in a box."""
    num_obstacles = solids.circles.shape[0]
    wider, per_obstacle = max(right - left, top - bottom), 0.0
    if num_obstacles > 0:
        per_obstacle = math.sqrt((right - left) * (top - bottom) / num_obstacles)
    side = max(per_obstacle, wider / MOST_CELLS_PER_SIDE)
    columns, rows = int((right - left) / side) + 1, int((top - bottom) / side) + 1
    half = (0.5 + SLACK) * side
    first = np.zeros(columns * rows + 1, np.int64)
    stamps = np.zeros(num_obstacles + 1, np.int64)
    empty = Cells(left, bottom, side, columns, rows, first, first, stamps)
    entries = first
    for filling in range(2):
        for o in range(num_obstacles):
            x, y, radius = solids.circles[o, 0], solids.circles[o, 1], solids.circles[o, 2]
            left_column, low_row = cell_at(empty, x - radius - SLACK * side, y - radius - SLACK * side)
            right_column, high_row = cell_at(empty, x + radius + SLACK * side, y + radius + SLACK * side)
            for row in range(low_row, high_row + 1):
                for column in range(left_column, right_column + 1):
                    middle_x, middle_y = left + (column + 0.5) * side, bottom + (row + 0.5) * side
                    if _reaches(solids, o, middle_x, middle_y, half):
                        cell = row * columns + column
                        if filling:
                            first[cell] -= 1
                            entries[first[cell]] = o
                        else:
                            first[cell] += 1
        if not filling:
            for cell in range(columns * rows):
                first[cell + 1] += first[cell]
            entries = np.zeros(first[columns * rows], np.int64)
    return Cells(left, bottom, side, columns, rows, first, entries, stamps)


@kernel
def _reaches(solids: Solids, o: int, x: float, y: float, half: float) -> bool:
    """Return whether an obstacle can reach into a square around a point."""
    circles, planes = solids.circles, solids.planes
    beside, above = max(abs(x - circles[o, 0]) - half, 0.0), max(abs(y - circles[o, 1]) - half, 0.0)
    if beside * beside + above * above > circles[o, 2] * circles[o, 2]:
        return False
    for k in range(solids.first[o], solids.first[o + 1]):
        reach = half * (abs(planes[k, 0]) + abs(planes[k, 1]))
        if planes[k, 0] * x + planes[k, 1] * y + reach < planes[k, 2]:
            return False
    return True


@kernel
def cell_at(cells: Cells, x: float, y: float) -> tuple[int, int]:
    """Return the column and the row of the cell at a point, or nearest to it."""
    column = math.floor((x - cells.x) / cells.side)
    row = math.floor((y - cells.y) / cells.side)
    return min(max(column, 0), cells.columns - 1), min(max(row, 0), cells.rows - 1)


@kernel
def is_new(cells: Cells, o: int) -> bool:
    """Return whether the present query sees an obstacle for the first time."""
    query = cells.stamps[cells.stamps.shape[0] - 1]
    if cells.stamps[o] == query:
        return False
    cells.stamps[o] = query
    return True


@kernel
def begin_query(cells: Cells) -> None:
    """Begin a query, which sees each obstacle once."""
    cells.stamps[cells.stamps.shape[0] - 1] += 1


@kernel
def is_blocked(solids: Solids, cells: Cells, px: float, py: float, qx: float, qy: float) -> bool:
    """Return whether a segment from p to q enters an obstacle; cells are searched from p on."""
    begin_query(cells)
    column, row = cell_at(cells, px, py)
    last_column, last_row = cell_at(cells, qx, qy)
    forward = 1 if last_column >= column else -1
    slope = 0.0 if last_column == column else (qy - py) / (qx - px)
    while True:
        end_row = last_row
        if column != last_column:
            border = cells.x + (column + (forward + 1) // 2) * cells.side
            _, end_row = cell_at(cells, border, py + slope * (border - px))
        upward = 1 if end_row >= row else -1
        while True:
            cell = row * cells.columns + column
            for k in range(cells.first[cell], cells.first[cell + 1]):
                o = cells.entries[k]
                if is_new(cells, o) and enters(solids, o, px, py, qx, qy):
                    return True
            if row == end_row:
                break
            row += upward
        if column == last_column:
            return False
        column += forward
