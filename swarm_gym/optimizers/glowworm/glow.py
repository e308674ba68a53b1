"""The brightness of the members of a glowworm swarm, and the choice of the member that one follows.

Source: M. Brand, X.-H. Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013, eq. 1-3
and 5, after K. N. Krishnanand, D. Ghose, Swarm Intelligence 3:87-124, 2009. The target shines, too: as
brightly as a member that stays at the best place.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.compiler.simd import NUM_LANES, bits, load
from swarm_gym.optimizers.glowworm.relay import Sight, distance, in_sight, inert, relay_lengths
from swarm_gym.population import Workspace
from swarm_gym.problem.geometry.sight import is_in_shadow
from swarm_gym.problem.walk.table import WalkTable

Floats = NDArray[np.float64]

# Named options, by their index in `Parameter.choices`.
RELAY, SIGHT, DISTANCE = range(3)
RATIONAL, EXPONENTIAL = range(2)
RAW, DIFFERENCES = range(2)
# Relative rounding error of a light.
ROUNDING = 1e-12


class Glow(NamedTuple):
    """The present luciferin of members and target, and how light fades with distance."""

    luciferin: Floats  # (N,) of the members, then of the target; then -1, which no member follows
    absorption: float  # gamma, per map unit
    dimming: int  # RATIONAL or EXPONENTIAL


@kernel
def qualities(table: WalkTable, sight: Sight, glow: int, absorption: float) -> Floats:
    """Return J of the members' places, (n,), from 0 to 1: the nearer to the target, the higher."""
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow = sight.blocked, sight.rooms, sight.shadow
    size = known.shape[0] - 1
    quality, lengths = np.zeros(size), inert(size, math.inf)
    if glow == DISTANCE:
        diagonal = table.resolution * math.hypot(float(table.num_columns), float(table.num_rows))
        for i in range(size):
            quality[i] = 1.0 - distance(x, y, i, size) / diagonal
        return quality
    if glow == RELAY:
        lengths = relay_lengths(sight)
    else:
        for i in range(size):
            if in_sight(blocked, rooms, columns, rows, known, shadow, i, size):
                lengths[i] = distance(x, y, i, size)
    for i in range(size):
        if lengths[i] < math.inf:
            quality[i] = 1.0 / (1.0 + absorption * lengths[i])
    return quality


@kernel(inline="late")
def perceived(glow: Glow, luciferin: float, length: float) -> float:
    """Return the light that arrives from a distance, in map units, of a source of this luciferin."""
    if glow.dimming == EXPONENTIAL:
        return luciferin * math.exp(-glow.absorption * length) if luciferin < math.inf else luciferin  # eq. 2
    return luciferin / (1.0 + glow.absorption * length)  # eq. 3


@kernel
def count_neighbours(sight: Sight, glow: Glow, i: int, reach: float) -> int:
    """Return the number of neighbours of member i: brighter, in sight and in reach; the target may be one."""
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow, luciferin = sight.blocked, sight.rooms, sight.shadow, glow.luciferin
    count = 0
    for k in range(known.shape[0]):
        if luciferin[k] > luciferin[i] and distance(x, y, i, k) < reach:
            count += in_sight(blocked, rooms, columns, rows, known, shadow, i, k)
    return count


@kernel
def find_brightest(sight: Sight, glow: Glow, i: int, reach: float, guess: int) -> int:
    """Return the neighbour whose light is brightest for member i, the first of equals; -1 if it has none.

    Args:
        sight: positions of the members, and what is known of the sight between them.
        glow: brightness of the members.
        i: number of the member that looks.
        reach: range in which it looks, in map units.
        guess: number of a likely neighbour: the better the guess, the fewer others have to be checked.
    """
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow, luciferin = sight.blocked, sight.rooms, sight.shadow, glow.luciferin
    own, brightest, most = luciferin[i], -1, 0.0
    length = distance(x, y, i, guess)
    is_neighbour = luciferin[guess] > own and length < reach
    if is_neighbour and in_sight(blocked, rooms, columns, rows, known, shadow, i, guess):
        brightest, most = guess, perceived(glow, luciferin[guess], length)
    if most == math.inf:
        return guess
    for block in range(0, x.shape[0], NUM_LANES):
        # Members as bright by eq. 3, and so, perhaps, by eq. 2; squared, to avoid roots and quotients.
        across, along = load(x, block) - x[i], load(y, block) - y[i]
        level, least = load(luciferin, block), most * (1.0 - ROUNDING)
        more, fading = level - least, least * glow.absorption * (1.0 - ROUNDING)
        squares = across * across + along * along
        if bits((level > own) & (more >= 0.0) & (more * more >= fading * fading * squares)) == 0:
            continue
        for k in range(block, block + NUM_LANES):
            length = distance(x, y, i, k)
            if luciferin[k] > own and length < reach:
                light = perceived(glow, luciferin[k], length)
                is_brighter = light > most or (light == most and (k < brightest or brightest < 0))
                # The obstacle that hid the last one often hides this one, too.
                if (
                    is_brighter
                    and not is_in_shadow(shadow, columns[i], rows[i], columns[k], rows[k])
                    and in_sight(blocked, rooms, columns, rows, known, shadow, i, k)
                ):
                    brightest, most = k, light
    return brightest


@kernel
def draw_neighbour(
    sight: Sight,
    glow: Glow,
    i: int,
    reach: float,
    levels: int,
    stream: NDArray[np.uint64],
    work: Workspace,
) -> int:
    """Draw a neighbour of member i in proportion to its light (eq. 1); return -1, without a draw, if none."""
    x, y, columns, rows, known = sight.x, sight.y, sight.columns, sight.rows, sight.known
    blocked, rooms, shadow, luciferin = sight.blocked, sight.rooms, sight.shadow, glow.luciferin
    shares, last, total = np.zeros(known.shape[0]), -1, 0.0
    for k in range(known.shape[0]):
        if luciferin[k] > luciferin[i]:
            length = distance(x, y, i, k)
            if length < reach and in_sight(blocked, rooms, columns, rows, known, shadow, i, k):
                level = luciferin[k] - luciferin[i] if levels == DIFFERENCES else luciferin[k]
                shares[k] = perceived(glow, level, length)
                total += shares[k]
                last = k
    if last < 0:
        return last
    fill_uniform(stream, work.noise)
    mark, running = work.noise[0] * total, 0.0
    for k in range(last):
        running += shares[k]
        if running > mark:
            return k
    return last
