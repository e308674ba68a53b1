"""How bright the members of a glowworm swarm shine, and whom one of them follows.

Source: C. Brand, X.-H. Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013, eq. 1-3 and 5,
after K. N. Krishnanand, D. Ghose, Swarm Intelligence 3:87-124, 2009. The target shines too, as bright as a member
that stays where it is brightest.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel, inner_kernel
from swarm_gym.optimizers.relay import Sight, distance, in_sight, relay_lengths
from swarm_gym.population import Workspace
from swarm_gym.problem.walks import WalkTable
from swarm_gym.random_stream import fill_uniform

Floats = NDArray[np.float64]

# Named options, by their index in `Knob.choices`.
RELAY, SIGHT, DISTANCE = range(3)
RATIONAL, EXPONENTIAL = range(2)
RAW, DIFFERENCES = range(2)


class Glow(NamedTuple):
    """How bright everybody is now, and how light fades on its way."""

    luciferin: Floats  # (n + 1,) of the members, and of the target
    absorption: float  # gamma, per map unit
    dimming: int  # RATIONAL or EXPONENTIAL


@inner_kernel
def qualities(table: WalkTable, sight: Sight, glow: int, absorption: float) -> Floats:
    """(n,) J of the members' places, from 0 to 1: the nearer to the target, the higher."""
    size = sight.x.shape[0] - 1
    quality = np.zeros(size)
    if glow == DISTANCE:
        diagonal = table.resolution * math.hypot(float(table.num_columns), float(table.num_rows))
        for i in range(size):
            quality[i] = 1.0 - distance(sight, i, size) / diagonal
        return quality
    lengths = np.full(size, math.inf)
    if glow == RELAY:
        lengths = relay_lengths(table, sight)
    else:
        for i in range(size):
            if in_sight(table, sight, i, size):
                lengths[i] = distance(sight, i, size)
    for i in range(size):
        if lengths[i] < math.inf:
            quality[i] = 1.0 / (1.0 + absorption * lengths[i])
    return quality


@inlined_kernel
def perceived(glow: Glow, luciferin: float, way: float) -> float:
    """Light of that level from some way off, in map units."""
    if glow.dimming == EXPONENTIAL:
        return luciferin * math.exp(-glow.absorption * way) if luciferin < math.inf else luciferin  # eq. 2
    return luciferin / (1.0 + glow.absorption * way)  # eq. 3


@inner_kernel
def count_neighbours(table: WalkTable, sight: Sight, glow: Glow, i: int, reach: float) -> int:
    """How many are brighter than member i, in sight and nearer than its range; with the target."""
    luciferin, count = glow.luciferin, 0
    for k in range(luciferin.shape[0]):
        if luciferin[k] > luciferin[i] and distance(sight, i, k) < reach and in_sight(table, sight, i, k):
            count += 1
    return count


@inner_kernel
def find_brightest(table: WalkTable, sight: Sight, glow: Glow, i: int, reach: float) -> int:
    """The neighbour that member i sees shine brightest, the first of equals; -1 if it has none."""
    luciferin, brightest, most = glow.luciferin, -1, -1.0
    for k in range(luciferin.shape[0]):
        # Nobody is seen brighter than it is.
        if luciferin[k] > luciferin[i] and luciferin[k] > most:
            way = distance(sight, i, k)
            light = perceived(glow, luciferin[k], way)
            if way < reach and light > most and in_sight(table, sight, i, k):
                brightest, most = k, light
    return brightest


@inner_kernel
def draw_neighbour(
    table: WalkTable,
    sight: Sight,
    glow: Glow,
    i: int,
    reach: float,
    levels: int,
    stream: NDArray[np.uint64],
    work: Workspace,
) -> int:
    """A neighbour of member i, drawn in proportion to its light (eq. 1); -1, and no draw, if it has none."""
    luciferin, last, total = glow.luciferin, -1, 0.0
    shares = np.zeros(luciferin.shape[0])
    for k in range(luciferin.shape[0]):
        if luciferin[k] > luciferin[i]:
            way = distance(sight, i, k)
            if way < reach and in_sight(table, sight, i, k):
                level = luciferin[k] - luciferin[i] if levels == DIFFERENCES else luciferin[k]
                shares[k] = perceived(glow, level, way)
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
