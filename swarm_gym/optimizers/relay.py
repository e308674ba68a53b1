"""Who of a swarm of points sees whom, and how far it is to the target from one to the next in sight.

Light that is handed on: a point that does not see the target has the shortest way to it over points that see each
other. The ways of all are found by Dijkstra's algorithm from the target on; whether two see each other is only
looked at where it could make a way shorter, and remembered.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel, inner_kernel
from swarm_gym.population import Swarms
from swarm_gym.problem.sight import sees
from swarm_gym.problem.walks import WalkTable, to_cells

Floats = NDArray[np.float64]

UNKNOWN, HIDDEN, IN_SIGHT = 0, 1, 2


class Sight(NamedTuple):
    """The n members of a swarm as they are now, and the target as the last point."""

    x: Floats  # (n + 1,) map units
    y: Floats  # (n + 1,)
    columns: Floats  # (n + 1,) the same in cells
    rows: Floats  # (n + 1,)
    known: NDArray[np.uint8]  # (n + 1, n + 1) what is known of each pair, the higher number first


@inner_kernel
def look_around(swarms: Swarms, b: int, table: WalkTable) -> Sight:
    """The members of swarm `b`, of whom nothing is known yet."""
    size = swarms.size[b]
    number = size + 1
    sight = Sight(
        np.empty(number),
        np.empty(number),
        np.empty(number),
        np.empty(number),
        np.zeros((number, number), np.uint8),
    )
    for i in range(number):
        place = table.target if i == size else swarms.positions[b, i]
        sight.x[i], sight.y[i] = place[0], place[1]
        sight.columns[i], sight.rows[i] = to_cells(table, place[0], place[1])
    return sight


@inlined_kernel
def distance(sight: Sight, i: int, k: int) -> float:
    """Between two points, in map units."""
    dx, dy = sight.x[k] - sight.x[i], sight.y[k] - sight.y[i]
    return math.sqrt(dx * dx + dy * dy)


@inlined_kernel
def in_sight(table: WalkTable, sight: Sight, i: int, k: int) -> bool:
    """Whether two points see each other."""
    high, low = max(i, k), min(i, k)
    if sight.known[high, low] == UNKNOWN:
        is_free = sees(
            table.blocked,
            table.rooms,
            sight.columns[high],
            sight.rows[high],
            sight.columns[low],
            sight.rows[low],
        )
        sight.known[high, low] = IN_SIGHT if is_free else HIDDEN
    return sight.known[high, low] == IN_SIGHT


@inner_kernel
def relay_lengths(table: WalkTable, sight: Sight) -> Floats:
    """(n,) lengths of the shortest ways to the target over points in sight; infinite where there is none."""
    size = sight.x.shape[0] - 1
    lengths = np.full(size, math.inf)
    # The members whose way may still become shorter, in any order.
    waiting = np.arange(size)
    left, here, length = size, size, 0.0
    while True:
        least, place = math.inf, -1
        for j in range(left):
            i = waiting[j]
            over = length + distance(sight, i, here)
            if over < lengths[i] and in_sight(table, sight, i, here):
                lengths[i] = over
            if lengths[i] < least:
                least, place = lengths[i], j
        if place < 0:
            return lengths
        here, length = waiting[place], least
        left -= 1
        waiting[place] = waiting[left]
