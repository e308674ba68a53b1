"""Sight between the members of a swarm of points, and shortest paths to the target over points in sight.

Light is passed on: a point that does not see the target has a shortest path to it over points that see each
other. The tests of sight take most of the time. So two points are tested only if that could make a path
shorter, and the result is stored.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, bits, load, square_root
from swarm_gym.population import Swarms
from swarm_gym.problem.geometry.sight import cast_shadow, hidden_at, is_in_shadow
from swarm_gym.problem.walk.table import WalkTable, to_cells

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rooms = NDArray[np.int16]
Bytes = NDArray[np.uint8]

UNKNOWN, HIDDEN, IN_SIGHT = range(3)


class Sight(NamedTuple):
    """The present n members of a swarm, and the target as the last point; zeros up to whole blocks.

    Kernels take the arrays out before they loop over pairs: each use of an array of a NamedTuple counts a
    reference, which took longer than all the rest.
    """

    x: Floats  # (N,) map units; N is the next multiple of eight from n + 1 on
    y: Floats  # (N,)
    columns: Floats  # (N,) positions in cells
    rows: Floats  # (N,)
    known: Bytes  # (n + 1, n + 1) UNKNOWN, HIDDEN or IN_SIGHT for each pair, the higher number first
    shadow: Floats  # (3,) the obstacle that was hit last, see `sight.cast_shadow`
    blocked: Flags  # (H, W) the map
    rooms: Rooms  # (H, W)


@kernel
def look_around(swarms: Swarms, b: int, table: WalkTable) -> Sight:
    """Return the members of swarm `b`, with no pair tested yet."""
    size = swarms.size[b]
    x, y, columns, rows = inert(size, 0.0), inert(size, 0.0), inert(size, 0.0), inert(size, 0.0)
    for i in range(size + 1):
        place = table.target if i == size else swarms.positions[b, i]
        x[i], y[i] = place[0], place[1]
        columns[i], rows[i] = to_cells(table, place[0], place[1])
    known = np.zeros((size + 1, size + 1), np.uint8)
    return Sight(x, y, columns, rows, known, np.full(3, -1.0), table.blocked, table.rooms)


@kernel
def inert(size: int, value: float) -> Floats:
    """Return an array of one value for the members, the target and the rest of the last block."""
    return np.full((size // NUM_LANES + 1) * NUM_LANES, value)


@kernel(inline="late")
def distance(x: Floats, y: Floats, i: int, k: int) -> float:
    """Return the distance between two points, in map units."""
    dx, dy = x[k] - x[i], y[k] - y[i]
    return math.sqrt(dx * dx + dy * dy)


@kernel(inline="early")
def in_sight(
    blocked: Flags,
    rooms: Rooms,
    columns: Floats,
    rows: Floats,
    known: Bytes,
    shadow: Floats,
    i: int,
    k: int,
) -> bool:
    """Return whether two points see each other; each pair is tested once."""
    high, low = max(i, k), min(i, k)
    if known[high, low] == UNKNOWN:
        x, y, to_x, to_y = columns[high], rows[high], columns[low], rows[low]
        share = hidden_at(blocked, rooms, x, y, to_x, to_y)
        known[high, low] = IN_SIGHT if share < 0.0 else HIDDEN
        if share >= 0.0:
            cast_shadow(rooms, x + share * (to_x - x), y + share * (to_y - y), shadow)
    return known[high, low] == IN_SIGHT


@kernel
def relay_lengths(sight: Sight) -> Floats:
    """Return the lengths, (N,), of the shortest paths to the target over points in sight; infinite if none.

    A point that sees the target has the straight path. The others have a path over one of these points, or
    over each other.
    """
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow = sight.blocked, sight.rooms, sight.shadow
    size = known.shape[0] - 1
    lengths, hidden, left = inert(size, math.inf), np.empty(size, np.int64), 0
    for i in range(size):
        if in_sight(blocked, rooms, columns, rows, known, shadow, i, size):
            lengths[i] = distance(x, y, i, size)
        else:
            hidden[left] = i
            left += 1
    over_one = np.full(left, math.inf)
    guess = 0
    for j in range(left):
        over_one[j], guess = _shortest(sight, lengths, hidden[j], guess)
    for j in range(left):
        lengths[hidden[j]] = over_one[j]
    # Dijkstra's algorithm among the points that do not see the target.
    while left > 0:
        nearest = 0
        for j in range(1, left):
            if lengths[hidden[j]] < lengths[hidden[nearest]]:
                nearest = j
        here = hidden[nearest]
        left -= 1
        hidden[nearest] = hidden[left]
        for j in range(left):
            i = hidden[j]
            over = lengths[here] + distance(x, y, i, here)
            if over < lengths[i] and in_sight(blocked, rooms, columns, rows, known, shadow, i, here):
                lengths[i] = over
    return lengths


@kernel
def _shortest(sight: Sight, lengths: Floats, i: int, guess: int) -> tuple[float, int]:
    """Return the length of the shortest path of member i over one point of known length, and that point.

    The better the guess, the fewer points have to be tested; if there is no path, the guess is returned.
    """
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow = sight.blocked, sight.rooms, sight.shadow
    least = lengths[guess] + distance(x, y, i, guess)
    if not (least < math.inf and in_sight(blocked, rooms, columns, rows, known, shadow, i, guess)):
        least = math.inf
    for block in range(0, x.shape[0], NUM_LANES):
        across, along = load(x, block) - x[i], load(y, block) - y[i]
        shorter = bits(load(lengths, block) + square_root(across * across + along * along) < least)
        if shorter == 0:
            continue
        for k in range(block, block + NUM_LANES):
            over = lengths[k] + distance(x, y, i, k)
            # The obstacle that hid the last one often hides this one, too.
            if (
                over < least
                and not is_in_shadow(shadow, columns[i], rows[i], columns[k], rows[k])
                and in_sight(blocked, rooms, columns, rows, known, shadow, i, k)
            ):
                least, guess = over, k
    return least, guess
