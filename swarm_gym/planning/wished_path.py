"""The path with a low sum of wishes: Dijkstra's algorithm over cells, then straight pieces, then small moves.

It is no exact optimum: steps over cells have sixteen directions, and what follows improves the path locally.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.cell_graph import cheapest_way
from swarm_gym.planning.certificate import certified, is_free
from swarm_gym.planning.wishes import WishedTask
from swarm_gym.scenarios import GridMap, GridScenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOVES = np.array([(math.cos(angle), math.sin(angle)) for angle in np.arange(8) * math.pi / 4.0])
LARGEST, SMALLEST = 2.0, 0.1  # moves of a point of the path, in cells
ROUNDS = 4  # of moves of all points with steps of one size
GAIN = 1e-6  # by which a sum must fall, as a share, to count


def wished_path(wished: WishedTask, is_over: Callable[[], bool]) -> Floats | None:
    """Return a path in map units, (k, 2), with a low sum of wishes.

    Args:
        wished: task and wishes.
        is_over: whether time is up; the search and local improvements end then.

    Returns:
        The path; None if it cannot be certified, or time is up before one is known.
    """
    grown = wished.task.grown
    assert isinstance(grown, GridScenario)
    grid, small = wished.scenario.map, grown.map
    if is_over():
        return None
    columns, rows = _lines_of(grid, small, 0), _lines_of(grid, small, 1)
    field = wished.field[rows[:, None], columns]
    ends = small.cell_of(grown.start), small.cell_of(grown.target)
    cells = cheapest_way(small.blocked, field, *ends, is_over)
    if cells is None:
        return None  # also where steps lead to fewer cells than sides that touch
    path = certified(wished.task, np.vstack([grown.start, small.to_map(cells), grown.target]))
    return None if path is None else improved(wished, path, is_over)


def _lines_of(grid: GridMap, small: GridMap, axis: int) -> Integers:
    """Return the column of a map in which each column of small cells lies, or the row of each row.

    Args:
        grid: the map.
        small: map of small cells on the same area.
        axis: 0 for columns, 1 for rows.
    """
    middles = np.zeros(((small.width, small.height)[axis], 2))
    middles[:, axis] = np.arange(len(middles))
    lines = np.rint(grid.to_cells(small.to_map(middles))[:, axis]).astype(np.int64)
    return np.clip(lines, 0, (grid.width, grid.height)[axis] - 1)


def improved(wished: WishedTask, path: Floats, is_over: Callable[[], bool]) -> Floats:
    """Return a path with a sum that is lower or the same, from a path that keeps the margin, (k, 2).

    Both are in map units. No obstacle comes between the two, apart from those that a straight piece jumps.
    """
    grid = wished.scenario.map
    points = _straightened(wished, grid.to_cells(path), is_over)
    step = LARGEST
    while step >= SMALLEST and not is_over():
        for _ in range(ROUNDS):
            if is_over() or not _moved(wished, points, step, is_over):
                break
        step /= 2.0
    mapped = grid.to_map(_straightened(wished, points, is_over))
    mapped[[0, -1]] = path[[0, -1]]
    return mapped if is_free(wished.task, mapped) else path


def _is_free(wished: WishedTask, points: Floats) -> bool:
    """Return whether a piece of a path, (k, 2) in cells, keeps the margin."""
    return is_free(wished.task, wished.scenario.map.to_map(points))


def _straightened(wished: WishedTask, points: Floats, is_over: Callable[[], bool]) -> Floats:
    """Return the path with straight pieces where these cost no more than what they replace."""
    sums = np.append(0.0, np.cumsum([wished.sum_of(points[k : k + 2]) for k in range(len(points) - 1)]))
    kept, here, last = [0], 0, len(points) - 1
    while here < last:
        reach, onward = 1, here + 1
        while not is_over():
            further = min(here + 2 * reach, last)
            if further == onward or not _is_as_good(wished, points, sums, here, further):
                break
            onward, reach = further, 2 * reach
        kept.append(onward)
        here = onward
    return points[kept]


def _is_as_good(wished: WishedTask, points: Floats, sums: Floats, here: int, further: int) -> bool:
    straight = points[[here, further]]
    limit = (sums[further] - sums[here]) * (1.0 + GAIN)
    return wished.sum_of(straight) <= limit and _is_free(wished, straight)


def _moved(wished: WishedTask, points: Floats, step: float, is_over: Callable[[], bool]) -> bool:
    """Move inner points, in place, where that lowers the sum; return whether one has moved."""
    has_moved = False
    for k in range(1, len(points) - 1):
        if is_over():
            break
        before = wished.sum_of(points[k - 1 : k + 2])
        best, least = None, before * (1.0 - GAIN)
        for move in step * MOVES:
            tried = np.stack([points[k - 1], points[k] + move, points[k + 1]])
            if (found := wished.sum_of(tried)) < least and _is_free(wished, tried):
                best, least = tried[1], found
        if best is not None:
            points[k], has_moved = best, True
    return has_moved
