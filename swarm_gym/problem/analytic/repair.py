"""Repair of infeasible paths: colliding segments are pushed out of obstacles, by a degree phi.

Source: SPSFA paper, section III, "treatment for infeasible path": a parallel movement of the segment by phi
times its degree of collision. The order is a reading (docs/readings.md): segments from the start, obstacles
as listed, each after the changes of earlier ones. What happens to shared waypoints is a reading, too.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, bits
from swarm_gym.problem.analytic.cost import clearing_shifts, segments_of, smaller_shifts
from swarm_gym.problem.analytic.table import PRESENCE, WaypointTable

Floats = NDArray[np.float64]


@kernel(inline="late")
def repair_segment(table: WaypointTable, segment: int, path: Floats, repair_degree: float) -> bool:
    """Push one segment out of one obstacle after the other; return whether its right end moved."""
    block, lane = segment // NUM_LANES, segment % NUM_LANES
    left, right = path[segment], path[segment + 1]
    before = right
    for tile in range(table.first_tile[block], table.first_tile[block + 1]):
        if table.rows[table.first_row[tile] + PRESENCE, lane] == -math.inf:
            continue
        rise = right - left
        length = math.sqrt(table.squared_spacing[segment] + rise * rise)
        up, down = clearing_shifts(table, tile, lane, left, rise, length)
        if up > 0.0 and down > 0.0:
            shift = repair_degree * (up if up <= down else -down)
            if segment > 0:
                left = min(max(left + shift, table.lower[segment - 1]), table.upper[segment - 1])
            # Beyond the last waypoint both bounds are zero: the target stays.
            right = min(max(right + shift, table.lower[segment]), table.upper[segment])
    path[segment], path[segment + 1] = left, right
    return right != before


@kernel(inline="late")
def repair(table: WaypointTable, path: Floats, repair_degree: float) -> None:
    """Repair all segments of a path once, from the start on.

    `path` is as in `cost.evaluate`; it is changed in place, but for its ends.

    A segment in contact moves along y' by `repair_degree` (phi in [0, 1]) times the smaller of its two
    clearing shifts. It moves to that side, and not out of the workspace.
    """
    for block in range(table.squared_spacing.shape[0] // NUM_LANES):
        left, rise, length = segments_of(table, path, block)
        contacts = bits(smaller_shifts(table, block, left, rise, length) > 0.0)
        if contacts == 0:
            continue
        moved = False
        for lane in range(NUM_LANES):
            # What was computed for a segment holds as long as the segment before it stays.
            if moved or (contacts >> lane) & 1:
                moved = repair_segment(table, block * NUM_LANES + lane, path, repair_degree)
