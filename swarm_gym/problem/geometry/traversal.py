"""Exact tests of a polyline on an occupancy grid: whether it is free, and how much of it is blocked.

Points are (column, row) in cells: cell (c, r) is the square c ± 0.5, r ± 0.5, row 0 on top, and grid line
k lies at k - 0.5. Everything outside the grid is blocked. Blocked cells are open sets: a path may touch
them and run along them, but not between two that share an edge. Where two blocked cells touch at a corner
and the two others are free, the gap has no width and is closed.

Planners turn at corners of cells, so that segments through corners and along edges are the normal case:
the grid lines cut a segment into pieces, and the middle of a piece, clear of all crossings, stands for it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel

# How deep, in cells, a path may enter a blocked cell and still only touch it: well above rounding errors,
# and well below 1/(6 n), by which a segment between corners or centres of n x n cells misses a third.
TOLERANCE = 1e-9


@entry
def segment_is_free(blocked: NDArray[np.bool_], x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether a segment enters no blocked cell, stays on the grid and passes no closed gap.

    It may end in a gap: whether a path that turns there passes it, only `path_is_free` tells. A segment of
    length zero is free where it touches a free cell.

    Args:
        blocked: (height, width) the grid.
        x0: column of one end.
        y0: row of that end.
        x1: column of the other end.
        y1: row of the other end.
    """
    if not (math.isfinite(x0) and math.isfinite(y0) and math.isfinite(x1) and math.isfinite(y1)):
        return False
    return blocked_share(blocked, x0, y0, x1, y1, 0.0) == 0.0 and not _passes_gap(blocked, x0, y0, x1, y1)


@entry
def path_is_free(blocked: NDArray[np.bool_], points: NDArray[np.float64]) -> bool:
    """Return whether all segments of a polyline, (k, 2), are free, and it passes no gap by turning in it."""
    side = 0.0
    for k in range(points.shape[0]):
        x, y = points[k]
        if k == 0:
            if not segment_is_free(blocked, x, y, x, y):
                return False
            continue
        x0, y0 = points[k - 1]
        if not segment_is_free(blocked, x0, y0, x, y):
            return False
        if max(abs(x - x0), abs(y - y0)) <= TOLERANCE:
            continue
        leaves = _side_of_gap(blocked, x0, y0, x, y)
        if leaves * side < 0.0:
            return False
        side = _side_of_gap(blocked, x, y, x0, y0)
    return True


@entry
def blocked_length(blocked: NDArray[np.bool_], points: NDArray[np.float64]) -> float:
    """Return the length of a polyline, (k, 2), in blocked cells and outside the grid, in cells.

    An edge between two blocked cells is blocked; an edge of a free cell is not. The length is infinite if a
    point is not finite.
    """
    length = 0.0
    for k in range(1, points.shape[0]):
        x0, y0 = points[k - 1]
        x1, y1 = points[k]
        whole = math.hypot(x1 - x0, y1 - y0)
        if not math.isfinite(whole):
            return math.inf
        length += whole * blocked_share(blocked, x0, y0, x1, y1, 1.0)
    return length


@kernel
def blocked_share(
    blocked: NDArray[np.bool_], x0: float, y0: float, x1: float, y1: float, enough: float
) -> float:
    """Return the share of a segment that is blocked, 0 to 1; counting ends once it exceeds `enough`."""
    height, width = blocked.shape
    dx, dy = x1 - x0, y1 - y0
    vertical, horizontal = _first_line(x0, dx, width), _first_line(y0, dy, height)
    share = begin = 0.0
    while begin < 1.0 and share <= enough:
        at_vertical = _crossing(vertical, x0, dx, width)
        at_horizontal = _crossing(horizontal, y0, dy, height)
        end = min(at_vertical, at_horizontal, 1.0)
        if end > begin:
            middle = 0.5 * (begin + end)
            if not _touches_free(blocked, x0 + middle * dx, y0 + middle * dy):
                share += end - begin
            begin = end
        if at_vertical <= end:
            vertical += 1 if dx > 0.0 else -1
        if at_horizontal <= end:
            horizontal += 1 if dy > 0.0 else -1
    return share


@kernel
def is_gap(blocked: NDArray[np.bool_], i: int, j: int) -> bool:
    """Return whether the crossing of the grid lines i (vertical) and j (horizontal) is a closed gap.

    There is none on the border of the grid, since everything outside is blocked.
    """
    height, width = blocked.shape
    if i < 1 or j < 1 or i >= width or j >= height:
        return False
    falling = blocked[j - 1, i - 1]
    rising = blocked[j - 1, i]
    return falling != rising and blocked[j, i] == falling and blocked[j, i - 1] == rising


@kernel(inline="late")
def _first_line(position: float, change: float, number: int) -> int:
    """Return the grid line, 0 to `number`, that comes next after a coordinate, or one that does not exist."""
    # These stay floats until they are limited, since far lines do not fit into integers.
    if change > 0.0:
        return int(min(max(np.floor(position + 0.5) + 1.0, 0.0), number + 1.0))
    return int(min(max(np.ceil(position + 0.5) - 1.0, -1.0), float(number)))


@kernel(inline="late")
def _crossing(line: int, position: float, change: float, number: int) -> float:
    """Return the share of a segment at which it crosses a grid line; infinite if there is no such line."""
    if change == 0.0 or line < 0 or line > number:
        return math.inf
    return (line - 0.5 - position) / change


@kernel
def _touches_free(blocked: NDArray[np.bool_], x: float, y: float) -> bool:
    height, width = blocked.shape
    # These are compared before they become integers, into which far points do not fit.
    if not (-1.0 < x < width and -1.0 < y < height):
        return False
    left = max(math.floor(x + 0.5 - TOLERANCE), 0)
    right = min(math.floor(x + 0.5 + TOLERANCE), width - 1)
    top = max(math.floor(y + 0.5 - TOLERANCE), 0)
    bottom = min(math.floor(y + 0.5 + TOLERANCE), height - 1)
    for row in range(top, bottom + 1):
        for column in range(left, right + 1):
            if not blocked[row, column]:
                return True
    return False


@kernel
def _passes_gap(blocked: NDArray[np.bool_], x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether a closed gap lies on a segment, but not at its ends."""
    height, width = blocked.shape
    steep = abs(y1 - y0) > abs(x1 - x0)
    if steep:
        u0, v0, u1, v1, number = y0, x0, y1, x1, height
    else:
        u0, v0, u1, v1, number = x0, y0, x1, y1, width
    first = max(np.ceil(min(u0, u1) + 0.5 + TOLERANCE), 1.0)
    last = min(np.floor(max(u0, u1) + 0.5 - TOLERANCE), number - 1.0)
    if first > last:
        return False
    for line in range(int(first), int(last) + 1):
        across = v0 + (line - 0.5 - u0) / (u1 - u0) * (v1 - v0) + 0.5
        other = round(across)
        i, j = (other, line) if steep else (line, other)
        if abs(across - other) <= TOLERANCE and is_gap(blocked, i, j):
            return True
    return False


@kernel
def _side_of_gap(blocked: NDArray[np.bool_], x: float, y: float, to_x: float, to_y: float) -> float:
    """Return, by its sign, the side of the gap at a point on which another lies; 0 if there is no gap."""
    i, j = round(x + 0.5), round(y + 0.5)
    if max(abs(x + 0.5 - i), abs(y + 0.5 - j)) > TOLERANCE or not is_gap(blocked, i, j):
        return 0.0
    along = to_y - y if blocked[j - 1, i] else y - to_y
    return to_x - x + along
