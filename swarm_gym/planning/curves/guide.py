"""Guides: the least cost from every node of a lattice to a goal for a robot that can turn on the spot."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.planning.curves.field import SLACK, Field, cost_at, driven, room
from swarm_gym.reference.priority_queue import enter, make_queue, take_first

Floats = NDArray[np.float64]

make_priority_queue = kernel(make_queue)


@entry
def guide_to(field: Field, goal: Floats, start: Floats, beyond: float) -> Floats:
    """Return the least cost of a way to a goal over steps to eight neighbours, (rows, columns).

    It is infinite at nodes from which none leads, and at those that are too far.

    Args:
        field: obstacles and costs.
        goal: x and y of the goal, and perhaps more.
        start: x and y of the start.
        beyond: factor of the cost from the start up to which costs are calculated.
    """
    rows, columns = field.apart.shape
    queue = make_priority_queue(rows * columns)
    size = 0
    column = min(max(math.floor(goal[0] + 0.5), 0), columns - 1)
    row = min(max(math.floor(goal[1] + 0.5), 0), rows - 1)
    for near_row in range(max(row - 1, 0), min(row + 2, rows)):
        for near_column in range(max(column - 1, 0), min(column + 2, columns)):
            cost = _step(field, goal[0], goal[1], near_column, near_row)
            if math.isfinite(cost):
                node = near_row * columns + near_column
                queue.length[node] = queue.cost[node] = cost
                size = enter(queue, size, node)
    most = math.inf
    while size > 0:
        node = take_first(queue, size)
        size -= 1
        cost = queue.length[node]
        if cost > most:
            queue.length[node] = math.inf
            break
        row, column = node // columns, node % columns
        if math.isinf(most) and max(abs(column - start[0]), abs(row - start[1])) <= 1.0:
            most = beyond * cost + 8.0
        for side in range(9):
            near_row, near_column = row + side // 3 - 1, column + side % 3 - 1
            if side == 4 or not (0 <= near_row < rows and 0 <= near_column < columns):
                continue
            other = near_row * columns + near_column
            length = math.sqrt((near_row - row) ** 2 + (near_column - column) ** 2)
            if cost + length >= queue.length[other]:
                continue
            onward = cost + _step(field, column, row, near_column, near_row)
            if onward < queue.length[other]:
                queue.length[other] = queue.cost[other] = onward
                size = enter(queue, size, other)
    for k in range(size):  # these are bounds only
        queue.length[queue.entries[k]] = math.inf
    return queue.length.reshape(rows, columns)


@kernel
def _step(field: Field, x: float, y: float, to_x: float, to_y: float) -> float:
    """Return the cost of a straight step, or infinity if it is not free."""
    length = math.sqrt((to_x - x) ** 2 + (to_y - y) ** 2)
    free, free_there = room(field, x, y), room(field, to_x, to_y)
    if free < SLACK or free_there < SLACK:
        return math.inf
    if free + free_there < length:
        return driven(field, x, y, math.atan2(to_y - y, to_x - x), 0.0, length)
    if field.is_even:
        return length
    return 0.5 * length * (cost_at(field, x, y) + cost_at(field, to_x, to_y))


@kernel(borrows=True)
def rest_from(guide: Floats, x: float, y: float) -> float:
    """Return an estimate of the cost from a point to the goal, or infinity where no way is known."""
    rows, columns = guide.shape
    column = min(max(math.floor(x + 0.5), 0), columns - 1)
    row = min(max(math.floor(y + 0.5), 0), rows - 1)
    best = guide[row, column]
    if math.isfinite(best):
        # The best of the nodes around, by the cost from there: a straight way to it is assumed to be free.
        return best
    for near_row in range(max(row - 1, 0), min(row + 2, rows)):
        for near_column in range(max(column - 1, 0), min(column + 2, columns)):
            apart = math.sqrt((near_row - y) ** 2 + (near_column - x) ** 2)
            best = min(best, guide[near_row, near_column] + apart)
    return best
