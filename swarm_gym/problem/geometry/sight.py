"""Tests of straight segments on a grid map that agree with `traversal`, but are many times faster.

Swarms of points test hundreds of thousands of pairs. Where all cells around a point are free, or all blocked,
a segment can be followed to the last of them in one jump. Only near the edges between free and blocked cells
is it examined as in `traversal`.

Points are finite and, as in `traversal`, (column, row) in cells.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.geometry.traversal import blocked_share, segment_is_free

Rooms = NDArray[np.int16]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

# How far inside the cells of one kind, in cells, a jump ends: clear of the edges and corners that decide.
CLEAR = 0.25
# A point deeper than this, in cells, is in a blocked cell in spite of `traversal.TOLERANCE` and rounding.
DEEP = 1e-6
# Length of steps, in cells, where cells of both kinds meet.
STEP = 0.5
# Points of a segment that are examined first, since an obstacle between its ends is often broad.
PROBES = 7


def tabulate_rooms(blocked: Flags) -> Rooms:
    """Return, for each cell, how many cells around it on all sides are of its kind.

    For a free cell this is the number r of free cells in every direction; for a blocked one, -1 - r.

    Args:
        blocked: (height, width) the grid, with at least one free cell. Everything outside is blocked.

    Returns:
        An array of shape (height, width).
    """
    from scipy.ndimage import distance_transform_cdt

    ringed = np.pad(blocked, 1, constant_values=True)
    free, deep = (distance_transform_cdt(kind, "chessboard")[1:-1, 1:-1] for kind in (~ringed, ringed))
    return np.where(blocked, -deep, free - 1).astype(np.int16)


@kernel
def sees(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether a segment is free, as `traversal.segment_is_free` does.

    Args:
        blocked: (height, width) the grid.
        rooms: (height, width) the array of `tabulate_rooms`.
        x0: column of one end.
        y0: row of that end.
        x1: column of the other end.
        y1: row of the other end.
    """
    return hidden_at(blocked, rooms, x0, y0, x1, y1) < 0.0


@kernel
def hidden_at(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> float:
    """Return a place where a segment is in a blocked cell or about to enter one; -1 if it is free.

    The place is a share of the segment, from its first end on. The arguments are as in `sees`.
    """
    dx, dy = x1 - x0, y1 - y0
    broadest, found = -1, -1.0
    for k in range(PROBES):
        at = (k + 1.0) / (PROBES + 1.0)
        room = rooms[_cell(y0 + at * dy, rooms.shape[0]), _cell(x0 + at * dx, rooms.shape[1])]
        if room < broadest:
            broadest, found = room, at
    if found > 0.0:
        return found
    per_column, per_row, step = _paces(dx, dy)
    # Shares of the segment: it is examined up to `share`, but for the part from `near` on, near cells of both
    # kinds, if `near` is not negative.
    share, near = 0.0, -1.0
    while share < 1.0:
        x, y = x0 + share * dx, y0 + share * dy
        column, row = _cell(x, rooms.shape[1]), _cell(y, rooms.shape[0])
        room = rooms[row, column]
        if room > 0:
            if near >= 0.0:
                if not segment_is_free(blocked, x0 + near * dx, y0 + near * dy, x, y):
                    return near
                near = -1.0
            share = _leave(column, row, room, x0, y0, dx, dy, per_column, per_row)
        elif room < 0 and max(abs(x - column), abs(y - row)) < 0.5 - DEEP:
            return share
        else:
            if near < 0.0:
                near = share
            share += step
    if near < 0.0 or segment_is_free(blocked, x0 + near * dx, y0 + near * dy, x1, y1):
        return -1.0
    return near


@kernel(inline="late")
def cast_shadow(rooms: Rooms, x: float, y: float, shadow: Floats) -> None:
    """Find a square of blocked cells around a point, which hides what is behind it.

    Args:
        rooms: (height, width) the array of `tabulate_rooms`.
        x: column of the point.
        y: row of the point.
        shadow: (3,) is set to column and row of the middle and half the side of the square. The square is a
            little smaller than the cells. Half the side is negative if the point is in a free cell.
    """
    column, row = _cell(x, rooms.shape[1]), _cell(y, rooms.shape[0])
    shadow[0], shadow[1], shadow[2] = column, row, -0.5 - DEEP - rooms[row, column]


@kernel(inline="late")
def is_in_shadow(shadow: Floats, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether the point of a segment closest to the middle of the square `shadow` lies in the square.

    If so, the segment is not free. If not, it may be free or not.
    """
    column, row = shadow[0], shadow[1]
    dx, dy = x1 - x0, y1 - y0
    share = ((column - x0) * dx + (row - y0) * dy) / max(dx * dx + dy * dy, DEEP)
    share = min(max(share, 0.0), 1.0)
    return max(abs(x0 + share * dx - column), abs(y0 + share * dy - row)) < shadow[2]


@kernel
def share_blocked(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the share of a segment that is blocked, 0 to 1: `traversal.blocked_share`, but for rounding.

    Args:
        blocked: (height, width) the grid.
        rooms: (height, width) the array of `tabulate_rooms`.
        x0: column of one end.
        y0: row of that end.
        x1: column of the other end.
        y1: row of the other end.
    """
    dx, dy = x1 - x0, y1 - y0
    per_column, per_row, step = _paces(dx, dy)
    share, near, total = 0.0, -1.0, 0.0
    while share < 1.0:
        x, y = x0 + share * dx, y0 + share * dy
        column, row = _cell(x, rooms.shape[1]), _cell(y, rooms.shape[0])
        room = rooms[row, column]
        # For a point outside of the map, the cell is only the nearest one.
        is_inside = abs(x - column) < 1.0 and abs(y - row) < 1.0
        if room > 0 or (room < -1 and is_inside):
            if near >= 0.0:
                part = blocked_share(blocked, x0 + near * dx, y0 + near * dy, x, y, 1.0)
                total += part * (share - near)
                near = -1.0
            around = room if room > 0 else -1 - room
            end = min(_leave(column, row, around, x0, y0, dx, dy, per_column, per_row), 1.0)
            if room < 0:
                total += end - share
            share = end
        else:
            if near < 0.0:
                near = share
            share += step
    if near >= 0.0:
        total += blocked_share(blocked, x0 + near * dx, y0 + near * dy, x1, y1, 1.0) * (1.0 - near)
    return min(total, 1.0)


@kernel(inline="late")
def _paces(dx: float, dy: float) -> tuple[float, float, float]:
    """Return the shares of a segment per column, per row, and per step near blocked cells."""
    per_column = 1.0 / dx if dx != 0.0 else math.copysign(math.inf, dx)
    per_row = 1.0 / dy if dy != 0.0 else math.copysign(math.inf, dy)
    return per_column, per_row, STEP / max(abs(dx), abs(dy), STEP)


@kernel(inline="late")
def _cell(position: float, number: int) -> int:
    """Return the cell, 0 to `number` - 1, that a coordinate lies in or is nearest to."""
    return min(max(int(position + 0.5), 0), number - 1)


@kernel(inline="late")
def _leave(
    column: int,
    row: int,
    around: int,
    x0: float,
    y0: float,
    dx: float,
    dy: float,
    per_column: float,
    per_row: float,
) -> float:
    """Return the share at which a segment through a cell safely leaves the cells of one kind around it."""
    reach = around + 0.5 - CLEAR
    to_column = (column + math.copysign(reach, dx) - x0) * per_column
    to_row = (row + math.copysign(reach, dy) - y0) * per_row
    return min(to_column, to_row)
