"""Smooth members of flights: bends sideways and upwards, of the kinds of `problem.geometry.bends`.

Bends are drawn on their own. The largest offset sideways is a share of amplitude times the width of the map.
That upwards is a share of amplitude times the height of the band. The encoding `shifted` has a bend along the
line, too, of the first two harmonics. Its largest offset is a share of amplitude times the range of these
offsets.

Around the line these shares are uniform. Around planned flights they are third powers of uniform shares,
since small offsets often touch a threat or the ground: with uniform ones, swarms were behind the planned
flights after 2,500 evaluations.
"""

import math

from swarm_gym.compiler.elementary import logarithm, sine_and_cosine
from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.geometry.bends import HARMONICS, NUM_HARMONICS, NUM_MODES
from swarm_gym.problem.padding import Floats
from swarm_gym.problem.terrain.table import (
    ABOVE,
    HIGHEST,
    LARGEST_SHIFT,
    LOWEST,
    SHIFTED,
    SPHERICAL,
    TerrainTable,
    X,
    Y,
)
from swarm_gym.problem.terrain.waypoints import clipped, head_for, waypoint

# Random numbers: for the middle flight, then the largest offset and the coefficients of each bend. Those of
# the bend along the line follow, if there is one.
NUM_NUMBERS = 1 + 2 * (1 + NUM_MODES)
NUM_ALONG = 2  # its modes
NUM_MORE_NUMBERS = 1 + NUM_ALONG


@kernel(borrows=True)
def draw_flight(table: TerrainTable, amplitude: float, kind: int, noise: Floats, path: Floats) -> None:
    """Write a smooth flight into a path, (C + 1,); arguments are as in `geometry.bends.draw_bend`.

    `noise` has at least `NUM_NUMBERS` numbers, which are used up. With the encoding `shifted` it has
    `NUM_MORE_NUMBERS` more.
    """
    n, num_middles = table.num_waypoints, table.middles.shape[0]
    middle = min(int(noise[0] * num_middles), num_middles - 1)
    count = NUM_HARMONICS if kind == HARMONICS else NUM_MODES
    _draw_offsets(table, 0, kind, count, amplitude * table.width, noise, path)
    band = table.band[HIGHEST] - table.band[LOWEST]
    _draw_offsets(table, 1, kind, count, amplitude * band, noise, path)
    if table.encoding == SHIFTED:
        along = 2.0 * LARGEST_SHIFT * table.spacing
        _draw_offsets(table, 2, HARMONICS, NUM_ALONG, amplitude * along, noise, path)
    for k in range(table.middles.shape[1]):
        noise[k] = table.middles[middle, k] + path[k + 1]
    if table.encoding < SPHERICAL:
        for k in range(table.middles.shape[1]):
            path[k + 1] = clipped(noise[k], table.lower[k], table.upper[k])
        return
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    rise = table.ends[1, ABOVE] - table.ends[0, ABOVE]
    for number in range(1, n + 1):
        along, sideways = number * table.spacing, noise[number - 1]
        to_x = table.ends[0, X] + along * table.forward[X] - sideways * table.forward[Y]
        to_y = table.ends[0, Y] + along * table.forward[Y] + sideways * table.forward[X]
        to_above = table.ends[0, ABOVE] + rise * (number / (n + 1)) + noise[n + number - 1]
        to_above = clipped(to_above, table.band[LOWEST], table.band[HIGHEST])
        head_for(table, path, number, (x, y, above), (to_x, to_y, to_above))
        x, y, above = waypoint(table, path, number, x, y, above)


@kernel(borrows=True)
def _draw_offsets(
    table: TerrainTable, component: int, kind: int, count: int, largest: float, noise: Floats, path: Floats
) -> None:
    """Write the offsets of a bend into a path: n components.

    Args:
        table: problem table.
        component: 0 for offsets sideways, 1 for those upwards, 2 for those along the line.
        kind: kind of modes, a value of `geometry.bends.BENDS`.
        count: number of modes.
        largest: upper limit of the largest offset, in metres.
        noise: random numbers, of which the coefficients are changed.
        path: path that is written.
    """
    n, first = table.num_waypoints, 2 + component * (1 + NUM_MODES)
    if table.middles.shape[0] > 1:
        noise[first - 1] *= noise[first - 1] * noise[first - 1]
    if kind == HARMONICS:
        for h in range(count):
            noise[first + h] = 2.0 * noise[first + h] - 1.0
    else:
        for h in range(0, count, 2):  # Box-Muller
            k = first + h
            radius, angle = math.sqrt(-2.0 * logarithm(1.0 - noise[k])), 2.0 * math.pi * noise[k + 1]
            sine, cosine = sine_and_cosine(angle)
            noise[k], noise[k + 1] = radius * cosine, radius * sine
    height = 0.0
    for k in range(n):
        offset = 0.0
        for h in range(count):
            offset += noise[first + h] * table.modes[kind, h, k]
        path[component * n + k + 1] = offset
        height = max(height, abs(offset))
    scale = noise[first - 1] * largest / height if height > 0.0 else 0.0
    for k in range(component * n + 1, (component + 1) * n + 1):
        path[k] = path[k] * scale
