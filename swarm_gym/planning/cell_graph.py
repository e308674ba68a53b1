"""The way of the least sum over the cells of a grid map: Dijkstra's algorithm, steps to sixteen neighbours.

The search is compiled, and looks at the clock after every few thousand cells. While it works, other threads
of Python run.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry
from swarm_gym.reference.priority_queue import PriorityQueue, enter, make_queue, take_first

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SLICE = 4_000  # cells between two looks at the clock: one or two milliseconds

# Steps (columns, rows), one of each two that are opposite, and the cells that they pass on the way.
STEPS = np.array([(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (2, -1), (1, 2), (1, -2)])
BETWEEN = np.array(
    [
        [(0, 0), (0, 0)],
        [(0, 0), (0, 0)],
        [(1, 0), (0, 1)],
        [(1, 0), (0, -1)],
        [(1, 0), (1, 1)],
        [(1, 0), (1, -1)],
        [(0, 1), (1, 1)],
        [(0, -1), (1, -1)],
    ]
)
STRAIGHT = 2  # first steps of the list, which pass no cell
# Length of a step over the number of cells that it passes.
SHARES = np.hypot(*STEPS.T) / np.where(np.arange(len(STEPS)) < STRAIGHT, 2, 4)

REACHED = -1  # instead of a number of entries of the queue


def cheapest_way(
    blocked: NDArray[np.bool_],
    field: Floats,
    start: tuple[int, int],
    goal: tuple[int, int],
    is_over: Callable[[], bool],
) -> Integers | None:
    """Return the cells (column, row) of the way of the least sum of a field over steps, (k, 2).

    A step costs its length in cells times the mean of the field over the cells that it passes. It leads
    through the areas of free cells only, and cuts no corner. Of cells with equal sums, the search settles the
    one with the larger number first, so that ties end alike everywhere.

    Args:
        blocked: (height, width) the grid.
        field: (height, width) positive costs of the cells.
        start: first cell, (column, row).
        goal: last cell, (column, row).
        is_over: whether time is up; asked after every `SLICE` cells.

    Returns:
        The cells; None if no steps lead to the goal, or time is up before.
    """
    width = blocked.shape[1]
    first, last = start[1] * width + start[0], goal[1] * width + goal[0]
    entries, places, sums, numbers = make_queue(blocked.size)
    numbers[:] = np.arange(blocked.size)
    queue = PriorityQueue(entries, places, sums, numbers)
    before = np.full(blocked.size, -1, np.int64)
    sums[first], entries[0], places[first] = 0.0, first, 0
    size = 1
    while size > 0:
        if is_over():
            return None
        size = settle(blocked, field, last, queue, before, size, SLICE)
    if size != REACHED:
        return None
    cells = [last]
    while before[cells[-1]] >= 0:
        cells.append(int(before[cells[-1]]))
    rows, columns = np.divmod(np.array(cells[::-1]), width)
    return np.stack([columns, rows], axis=-1)


@entry
def settle(
    blocked: NDArray[np.bool_],
    field: Floats,
    goal: int,
    queue: PriorityQueue,
    before: Integers,
    size: int,
    most: int,
) -> int:
    """Settle the next cells of a search; return the number of entries of the queue, or `REACHED`.

    Args:
        blocked: (height, width) the grid.
        field: (height, width) positive costs of the cells.
        goal: cell at which the search ends, row * width + column.
        queue: cells that were reached; `cost` has their least sums, and `length` the number of each cell,
            which orders equal sums.
        before: (height * width,) the cell before each cell; changed in place.
        size: number of entries of the queue.
        most: number of cells to settle, at most.
    """
    height, width = blocked.shape
    for _ in range(most):
        if size == 0:
            return 0
        cell = take_first(queue, size)
        size -= 1
        if cell == goal:
            return REACHED
        row, column = cell // width, cell % width
        for side in range(2 * STEPS.shape[0]):
            k = side // 2
            dx, dy = STEPS[k, 0], STEPS[k, 1]
            # Both directions of a step add the same numbers in the same order, so that they cost the same.
            x, y = (column, row) if side % 2 == 0 else (column - dx, row - dy)
            if x < 0 or x + dx >= width or min(y, y + dy) < 0 or max(y, y + dy) >= height:
                continue
            if blocked[y, x] or blocked[y + dy, x + dx]:
                continue
            total = field[y, x] + field[y + dy, x + dx]
            if k >= STRAIGHT:
                x1, y1 = x + BETWEEN[k, 0, 0], y + BETWEEN[k, 0, 1]
                x2, y2 = x + BETWEEN[k, 1, 0], y + BETWEEN[k, 1, 1]
                if blocked[y1, x1] or blocked[y2, x2]:
                    continue
                total = total + field[y1, x1] + field[y2, x2]
            found = queue.cost[cell] + SHARES[k] * total
            other = (y + dy) * width + x + dx if side % 2 == 0 else y * width + x
            if found < queue.cost[other]:
                queue.cost[other] = found
                before[other] = cell
                size = enter(queue, size, other)
    return size
