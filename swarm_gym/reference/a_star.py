"""A* on an occupancy grid: the shortest path over neighbouring cells, straight or diagonal.

Source: P. E. Hart, N. J. Nilsson, B. Raphael, "A formal basis for the heuristic determination of minimum
cost paths", IEEE Trans. Syst. Sci. Cybern. 4(2):100-107, 1968. A diagonal step needs both cells next to
it free, as in the benchmark of N. R. Sturtevant (IEEE TCIAIG 4(2):144-148, 2012).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.errors import NoPathError
from swarm_gym.problem.geometry.traversal import segment_is_free
from swarm_gym.reference.grid_input import as_free_cell, as_grid
from swarm_gym.reference.priority_queue import PriorityQueue, enter, make_queue, take_first

DIAGONAL = math.sqrt(2.0)
# Steps to the neighbours of a cell, in columns and in rows: first the straight ones.
STEP_COLUMNS = np.array([1, 0, -1, 0, 1, -1, -1, 1])
STEP_ROWS = np.array([0, 1, 0, -1, 1, 1, -1, -1])
NUM_STRAIGHT = 4


class GridPath(NamedTuple):
    """A shortest path over the cells of a grid."""

    length: float
    "Number of straight steps plus sqrt 2 times the number of diagonal steps, in cells."
    cells: NDArray[np.int64]
    "Cells (column, row) from start to goal, (k, 2)."
    expansions: int
    "Number of cells that the search took from its queue."


def shortest_grid_path(blocked: NDArray[np.bool_], start: Sequence[int], goal: Sequence[int]) -> GridPath:
    """Return a shortest path of straight and diagonal steps between two cells, always the same one.

    Args:
        blocked: (height, width) the grid, row 0 on top.
        start: first cell, (column, row).
        goal: last cell, (column, row).

    Raises:
        ScenarioError: if the grid is no array of booleans with two axes, an end is outside or blocked, or no
        path joins the ends.
    """
    grid = as_grid(blocked)
    width = grid.shape[1]
    first, last = as_free_cell(grid, start, "start"), as_free_cell(grid, goal, "goal")
    begin, end = first[1] * width + first[0], last[1] * width + last[0]
    queue = make_queue(grid.size)
    straight, diagonal = np.zeros(grid.size, np.int64), np.zeros(grid.size, np.int64)
    arrival = np.full(grid.size, -1, np.int64)
    expansions = search(grid, begin, end, queue, straight, diagonal, arrival)
    if math.isinf(queue.length[end]):
        raise NoPathError(f"blocked cells separate start {first} and goal {last}")
    cells = [end]
    while cells[-1] != begin:
        cells.append(int(arrival[cells[-1]]))
    rows, columns = np.divmod(np.array(cells[::-1]), width)
    return GridPath(float(queue.length[end]), np.stack([columns, rows], axis=-1), expansions)


@kernel(inline="late")
def length_of(straight: int, diagonal: int) -> float:
    """Return the length of a number of steps; it comes from counts, so that equal lengths have equal bits."""
    return straight + diagonal * DIAGONAL


@entry
def search(
    blocked: NDArray[np.bool_],
    start: int,
    goal: int,
    queue: PriorityQueue,
    straight: NDArray[np.int64],
    diagonal: NDArray[np.int64],
    arrival: NDArray[np.int64],
) -> int:
    """Search from one cell, row * width + column, until another one leaves the queue.

    Args:
        blocked: (height, width) the grid.
        start: first cell.
        goal: last cell; its `queue.length` stays infinite if it cannot be reached.
        queue: an empty queue; afterwards its lengths are the lengths of paths from the start.
        straight: number of straight steps of the path to a cell, changed in place.
        diagonal: number of diagonal steps of the path to a cell, changed in place.
        arrival: cell before a cell on its path, changed in place.

    Returns:
        The number of cells that left the queue.
    """
    height, width = blocked.shape
    goal_row, goal_column = goal // width, goal % width
    queue.length[start] = 0.0
    queue.cost[start] = 0.0
    size = enter(queue, 0, start)
    expansions = 0
    while size > 0:
        cell = take_first(queue, size)
        size -= 1
        expansions += 1
        if cell == goal:
            break
        row, column = cell // width, cell % width
        for k in range(STEP_COLUMNS.shape[0]):
            next_row, next_column = row + STEP_ROWS[k], column + STEP_COLUMNS[k]
            if not (0 <= next_row < height and 0 <= next_column < width) or blocked[next_row, next_column]:
                continue
            is_diagonal = k >= NUM_STRAIGHT
            if is_diagonal and (blocked[row, next_column] or blocked[next_row, column]):
                continue
            num_diagonal = diagonal[cell] + (1 if is_diagonal else 0)
            num_straight = straight[cell] + (0 if is_diagonal else 1)
            length = length_of(num_straight, num_diagonal)
            neighbour = next_row * width + next_column
            # The heuristic is consistent: the path to a cell that left the queue gets no shorter.
            if length < queue.length[neighbour]:
                columns_left, rows_left = abs(goal_column - next_column), abs(goal_row - next_row)
                both = min(columns_left, rows_left)
                straight[neighbour], diagonal[neighbour] = num_straight, num_diagonal
                arrival[neighbour] = cell
                queue.length[neighbour] = length
                queue.cost[neighbour] = length_of(
                    num_straight + max(columns_left, rows_left) - both, num_diagonal + both
                )
                size = enter(queue, size, neighbour)
    return expansions


@entry
def smooth(blocked: NDArray[np.bool_], cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Straighten a path over cells: go from each cell straight to the last one in sight.

    The result is shorter, but no optimum.

    Args:
        blocked: (height, width) the grid.
        cells: (k, 2) a path (column, row) whose steps are free, such as the path of `shortest_grid_path`.

    Returns:
        The cells that are kept, (m, 2), with the first and the last one.
    """
    kept = np.empty_like(cells)
    kept[0] = cells[0]
    here, number, last = 0, 1, cells.shape[0] - 1
    while here < last:
        onward = last
        while onward > here + 1 and not segment_is_free(
            blocked,
            float(cells[here, 0]),
            float(cells[here, 1]),
            float(cells[onward, 0]),
            float(cells[onward, 1]),
        ):
            onward -= 1
        kept[number] = cells[onward]
        number += 1
        here = onward
    return kept[:number].copy()
