"""Paths pulled tight: free paths made shorter by moves after which they are still free."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel, kernel_by_class
from swarm_gym.final_repair.obstacles import CLEAR, Obstacles, contact, number_of
from swarm_gym.problem.geometry.traversal import segment_is_free

Floats = NDArray[np.float64]

BISECTIONS = 8  # of the way that a point is moved
ENOUGH = 1e-5  # relative gain of a round below which a path counts as tight


class CellMap(NamedTuple):
    """The cells of a grid map; points are (column, row)."""

    blocked: NDArray[np.bool_]  # (height, width)


@kernel
def _clears_obstacles(obstacles: Obstacles, x0: float, y0: float, x1: float, y1: float) -> bool:
    deepest = 0.0
    for i in range(number_of(obstacles)):
        deepest = max(deepest, contact(obstacles, i, x0, y0, x1, y1).depth)
    return deepest <= CLEAR


@kernel
def _clears_cells(cells: CellMap, x0: float, y0: float, x1: float, y1: float) -> bool:
    return segment_is_free(cells.blocked, x0, y0, x1, y1)


clears: Callable[[Obstacles | CellMap, float, float, float, float], bool] = kernel_by_class(
    {Obstacles: _clears_obstacles, CellMap: _clears_cells}
)


@entry
def tighten(free_map: Obstacles | CellMap, path: Floats, most_rounds: int) -> tuple[Floats, int]:
    """Pull a free path, (k, 2), tight; its ends stay.

    A round drops points whose neighbours see each other, and moves the others as far as the path gets shorter
    and stays free. Rounds go on until one gains too little.

    Returns:
        The path, (m, 2) with m <= k, and the number of segments that were compared with the map.
    """
    points, number, compared = path.copy(), path.shape[0], 0
    length = _length(points, number)
    for _ in range(most_rounds):
        number, dropping = _drop(free_map, points, number)
        moving = _move(free_map, points, number)
        compared += dropping + moving
        before, length = length, _length(points, number)
        if before - length <= ENOUGH * before:
            break
    return points[:number].copy(), compared


@kernel
def _drop(free_map: Obstacles | CellMap, points: Floats, number: int) -> tuple[int, int]:
    """Drop points whose neighbours see each other; return the number of those left, and of comparisons."""
    kept, compared = 1, 0
    for k in range(1, number - 1):
        compared += 1
        if not clears(free_map, points[kept - 1, 0], points[kept - 1, 1], points[k + 1, 0], points[k + 1, 1]):
            points[kept] = points[k]
            kept += 1
    points[kept] = points[number - 1]
    return kept + 1, compared


@kernel
def _move(free_map: Obstacles | CellMap, points: Floats, number: int) -> int:
    """Move points as far as the path stays free; return the number of comparisons.

    A point moves towards the line between its neighbours, then along its segments towards each of them. All
    of this shortens the path.
    """
    compared = 0
    for k in range(1, number - 1):
        before, after = points[k - 1], points[k + 1]
        dx, dy = after[0] - before[0], after[1] - before[1]
        square, share = dx * dx + dy * dy, 0.5
        if square > 0.0:
            along = (points[k, 0] - before[0]) * dx + (points[k, 1] - before[1]) * dy
            share = min(max(along / square, 0.0), 1.0)
        compared += _approach(free_map, points, k, before[0] + share * dx, before[1] + share * dy)
        compared += _approach(free_map, points, k, before[0], before[1])
        compared += _approach(free_map, points, k, after[0], after[1])
    return compared


@kernel
def _approach(free_map: Obstacles | CellMap, points: Floats, k: int, x: float, y: float) -> int:
    """Move point `k` towards (x, y) as far as its segments stay free; return the number of comparisons."""
    from_x, from_y = points[k, 0], points[k, 1]
    reached, step = 0.0, 0.5
    for _ in range(BISECTIONS):
        new_x = from_x + (reached + step) * (x - from_x)
        new_y = from_y + (reached + step) * (y - from_y)
        if clears(free_map, points[k - 1, 0], points[k - 1, 1], new_x, new_y) and clears(
            free_map, new_x, new_y, points[k + 1, 0], points[k + 1, 1]
        ):
            reached += step
        step *= 0.5
    points[k, 0], points[k, 1] = from_x + reached * (x - from_x), from_y + reached * (y - from_y)
    return 2 * BISECTIONS


@kernel
def _length(points: Floats, number: int) -> float:
    length = 0.0
    for k in range(1, number):
        length += math.hypot(points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1])
    return length
