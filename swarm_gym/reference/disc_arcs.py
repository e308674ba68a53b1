"""Arcs on which the centre of a disc can turn around a corner of blocked cells, and places where it can be.

A disc of radius r that touches a corner has its centre on the circle of radius r around it. Of this circle,
only the quarter opposite to the corner's blocked cell matters: elsewhere the disc would enter that cell. An
angle of a quarter is 0 along the columns and a quarter turn along the rows, both away from the blocked cell.
So it has the same meaning for all four kinds of corners, though it grows clockwise for two of them.

Coordinates are as in `grid_sight`. The outside of the grid is free, but the centre stays on the grid.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.reference.grid_sight import SightGrid

# How much closer than its radius, in cells, the disc may come to a blocked cell: well above rounding errors.
SLACK = 5e-10
QUARTER = 0.5 * math.pi


class FreeArcs(NamedTuple):
    """The free parts of the quarters around all corners."""

    first: NDArray[np.int64]
    "Number of the first arc of each of the n corners, and the number of all arcs, (n + 1,)."
    corners: NDArray[np.int64]
    "Number of the corner of each arc, (m,)."
    low: NDArray[np.float64]
    "Least angle of each arc, (m,)."
    high: NDArray[np.float64]
    "Greatest angle of each arc, (m,)."


@entry
def find_free_arcs(grid: SightGrid, radius: float) -> FreeArcs:
    """Find the parts of all quarters where the disc enters no blocked cell, and its centre is on the grid.

    Args:
        grid: the grid with its corners.
        radius: radius of the disc in cells.
    """
    number = grid.corner_columns.shape[0]
    first = np.zeros(number + 1, np.int64)
    corners, low, high = np.zeros(16, np.int64), np.zeros(16), np.zeros(16)
    size, scratch = 0, np.zeros((16, 2))
    for corner in range(number):
        first[corner] = size
        scratch, count = _closed_parts(grid, corner, radius, scratch)
        order = np.argsort(scratch[:count, 0])
        reached = 0.0
        for k in range(count + 1):
            begin, end = QUARTER, QUARTER
            if k < count:
                begin, end = scratch[order[k], 0], scratch[order[k], 1]
            if begin > reached:
                if size == low.shape[0]:
                    more = np.zeros(size)
                    low, high = np.concatenate((low, more)), np.concatenate((high, more))
                    corners = np.concatenate((corners, np.zeros(size, np.int64)))
                corners[size], low[size], high[size] = corner, reached, begin
                size += 1
            reached = max(reached, end)
    first[number] = size
    return FreeArcs(first, corners[:size].copy(), low[:size].copy(), high[:size].copy())


@entry
def disc_is_free(grid: SightGrid, x: float, y: float, radius: float) -> bool:
    """Return whether a point is on the grid, and a disc around it enters no blocked cell.

    Args:
        grid: the grid.
        x: shifted column of the point.
        y: shifted row of the point.
        radius: radius of the disc in cells, without slack.
    """
    bottom, right = grid.blocked.shape[0] - 1.0, grid.blocked.shape[1] - 1.0
    if not (1.0 - SLACK <= x <= right + SLACK and 1.0 - SLACK <= y <= bottom + SLACK):
        return False
    for row in range(int(max(math.floor(y - radius), 1.0)), int(min(math.ceil(y + radius), bottom))):
        across = max(row - y, y - row - 1.0, 0.0)
        if across < radius:
            reach = math.sqrt((radius - across) * (radius + across))
            if not cells_are_free(grid, row, x - reach, x + reach):
                return False
    return True


@kernel
def cells_are_free(grid: SightGrid, row: int, left: float, right: float) -> bool:
    """Return whether no cell of a row between two columns is blocked; those outside the grid are free."""
    width = grid.blocked.shape[1]
    first = int(max(math.floor(left), 1.0))
    last = int(min(math.ceil(right) - 1.0, width - 2.0))
    return first > last or (not grid.blocked[row, first] and grid.run_ends[row, first] > last)


@kernel
def _closed_parts(
    grid: SightGrid, corner: int, radius: float, scratch: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """Return the parts of a quarter that runs of blocked cells close, (k, 2), and how many there are.

    They are written into `scratch`, or into a larger array if there are too many.
    """
    height, width = grid.blocked.shape
    x, y = grid.corner_columns[corner], grid.corner_rows[corner]
    ahead, below = grid.blocked_columns[corner] < 0, grid.blocked_rows[corner] < 0
    count = 0
    # The border of the grid: the centre must not leave it.
    to_side = float(width - 1 - x if ahead else x - 1) + SLACK
    to_end = float(height - 1 - y if below else y - 1) + SLACK
    if to_side < radius:
        scratch[count, 0], scratch[count, 1] = 0.0, math.acos(to_side / radius)
        count += 1
    if to_end < radius:
        scratch[count, 0], scratch[count, 1] = math.asin(to_end / radius), QUARTER
        count += 1
    reach = int(min(math.ceil(2.0 * radius), float(height + width))) + 1
    for row in range(max(y - reach, 1), min(y + reach, height - 1)):
        column, end = max(x - reach, 1), min(x + reach, width - 1)
        while column < end:
            behind = min(grid.run_ends[row, column], end)
            if grid.blocked[row, column]:
                low, high = _closed_part(
                    column - x if ahead else x - behind,
                    behind - x if ahead else x - column,
                    row - y if below else y - row - 1,
                    radius,
                )
                if low < high:
                    if count == scratch.shape[0]:
                        scratch = np.concatenate((scratch, np.zeros((count, 2))))
                    scratch[count, 0], scratch[count, 1] = low, high
                    count += 1
                    if low == 0.0 and high == QUARTER:
                        return scratch, count
            column = behind
    return scratch, count


@kernel
def _closed_part(left: float, right: float, near: float, radius: float) -> tuple[float, float]:
    """Return the part of a quarter around the origin that is too close to a rectangle of height 1.

    The points that are too close form a rectangle with round corners: two rectangles and four discs. A
    rectangle that does not touch the origin from inside the quarter closes one interval. So this is all
    between the least and the greatest angle of these.

    Args:
        left: least coordinate of the rectangle along the columns, away from the corner's blocked cell.
        right: greatest coordinate of the rectangle in that direction.
        near: least coordinate of the rectangle along the rows, away from the blocked cell.
        radius: radius of the disc.

    Returns:
        Least and greatest angle; the first is larger if the rectangle closes nothing.
    """
    low, high = math.inf, -math.inf
    closest = radius - SLACK
    for k in range(2):
        wide, tall = (closest, 0.0) if k == 0 else (0.0, closest)
        x0, x1, y0, y1 = left - wide, right + wide, near - tall, near + 1.0 + tall
        if x1 >= 0.0 and y1 >= 0.0 and x0 <= radius and y0 <= radius:
            begin = max(math.acos(min(x1 / radius, 1.0)), math.asin(max(y0, 0.0) / radius))
            end = min(math.acos(max(x0, 0.0) / radius), math.asin(min(y1 / radius, 1.0)))
            if begin < end:
                low, high = min(low, begin), max(high, end)
    for k in range(4):
        x, y = left if k % 2 == 0 else right, near if k < 2 else near + 1.0
        distance = math.hypot(x, y)
        if distance == 0.0:
            continue
        cosine = (SLACK * (radius + closest) + distance * distance) / (2.0 * radius * distance)
        if cosine < 1.0:
            angle, half = math.atan2(y, x), math.acos(cosine)
            begin, end = max(angle - half, 0.0), min(angle + half, QUARTER)
            if begin < end:
                low, high = min(low, begin), max(high, end)
    return low, high
