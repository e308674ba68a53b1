"""What a straight way meets on a grid map: as `traversal` says, many times faster where there is room.

Swarms of points ask who sees whom for hundreds of thousands of pairs. Where all cells around a point are of
one kind, free or blocked, a segment leaves them somewhere and has met nothing else; only what of it is close
to where cells of both kinds meet is looked at in earnest.

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
# From this depth on, in cells, a point is in a blocked cell whatever `traversal.TOLERANCE` and rounding do.
DEEP = 1e-6
# Of steps, in cells, where cells of both kinds meet.
STEP = 0.5
# Points of a segment that are looked at first: what hides one end from the other is often broad.
PROBES = 7


def tabulate_rooms(blocked: Flags) -> Rooms:
    """How many cells are free around a free cell on all sides; of a blocked one -1 - how many are blocked.

    Args:
        blocked: a grid, (height, width), with a free cell. Everything outside is blocked.

    Returns:
        (height, width)
    """
    from scipy.ndimage import distance_transform_cdt

    ringed = np.pad(blocked, 1, constant_values=True)
    free, deep = (distance_transform_cdt(kind, "chessboard")[1:-1, 1:-1] for kind in (~ringed, ringed))
    return np.where(blocked, -deep, free - 1).astype(np.int16)


@kernel
def sees(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether a segment is free: `traversal.segment_is_free`.

    Args:
        blocked: the grid, (height, width).
        rooms: of its cells, see `tabulate_rooms`.
        x0: column of one end.
        y0: its row.
        x1: column of the other end.
        y1: its row.
    """
    return hidden_at(blocked, rooms, x0, y0, x1, y1) < 0.0


@kernel
def hidden_at(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> float:
    """Where a segment is in a blocked cell, or about to enter one, as a share of it; -1 if it is free.

    The arguments are those of `sees`.
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
    # Shares of the segment: how far it is known, and from where on it is near blocked cells, if it is now.
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
    """Find a square of blocked cells around a point: whoever looks through it sees nothing.

    Args:
        rooms: of the cells of the grid.
        x: column of the point.
        y: its row.
        shadow: (3,) becomes column and row of the middle and half the side of the square. It is a little
            smaller, clear of the edges; half the side is negative where the point is in a free cell.
    """
    column, row = _cell(x, rooms.shape[1]), _cell(y, rooms.shape[0])
    shadow[0], shadow[1], shadow[2] = column, row, -0.5 - DEEP - rooms[row, column]


@kernel(inline="late")
def is_in_shadow(shadow: Floats, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether the point of a segment that is closest to the middle of such a square is in it.

    Then the segment is not free; else it may be or not.
    """
    column, row = shadow[0], shadow[1]
    dx, dy = x1 - x0, y1 - y0
    share = ((column - x0) * dx + (row - y0) * dy) / max(dx * dx + dy * dy, DEEP)
    share = min(max(share, 0.0), 1.0)
    return max(abs(x0 + share * dx - column), abs(y0 + share * dy - row)) < shadow[2]


@kernel
def share_blocked(blocked: Flags, rooms: Rooms, x0: float, y0: float, x1: float, y1: float) -> float:
    """Share of a segment that is blocked, from 0 to 1: `traversal.blocked_share`, but for rounding.

    Args:
        blocked: the grid, (height, width).
        rooms: of its cells, see `tabulate_rooms`.
        x0: column of one end.
        y0: its row.
        x1: column of the other end.
        y1: its row.
    """
    dx, dy = x1 - x0, y1 - y0
    per_column, per_row, step = _paces(dx, dy)
    share, near, total = 0.0, -1.0, 0.0
    while share < 1.0:
        x, y = x0 + share * dx, y0 + share * dy
        column, row = _cell(x, rooms.shape[1]), _cell(y, rooms.shape[0])
        room = rooms[row, column]
        # Beside the map, the cell is only the next one.
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
    """Shares of a segment per column and per row, and of a step near blocked cells."""
    per_column = 1.0 / dx if dx != 0.0 else math.copysign(math.inf, dx)
    per_row = 1.0 / dy if dy != 0.0 else math.copysign(math.inf, dy)
    return per_column, per_row, STEP / max(abs(dx), abs(dy), STEP)


@kernel(inline="late")
def _cell(position: float, number: int) -> int:
    """The cell of 0 to `number` - 1 that a coordinate is in, or next to."""
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
    """From which share on a segment that comes through a cell is no more safely among those around it."""
    reach = around + 0.5 - CLEAR
    to_column = (column + math.copysign(reach, dx) - x0) * per_column
    to_row = (row + math.copysign(reach, dy) - y0) * per_row
    return min(to_column, to_row)
