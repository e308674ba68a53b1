"""The cost of a flight as the published code of MetaBox-v2 computes it, deviations from its page included.

The reading is of `src/environment/problem/SOO/UAV/uav_numpy.py`; docs/readings.md lists the deviations:

* the height below a waypoint is the height of the nearest cell, and cylinders have no top;
* only angles above the limits count, and the change of climb at a waypoint has the limit of climbs;
* the ground is tested at 12 points of each segment, one cell off in x and in y;
* a flight beyond the last height but one counts as below the ground.
"""

import math

import numpy as np

from swarm_gym.compiler.elementary import arctangent
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.problem.padding import Floats
from swarm_gym.problem.terrain.ground import (
    below_ground,
    height,
    height_as_coded,
    height_of_place,
    in_cells,
)
from swarm_gym.problem.terrain.table import (
    ABOVE,
    BLOCK,
    CLIMB,
    CONTACT,
    DANGER,
    HIGHEST,
    LOWEST,
    TURN,
    TerrainTable,
    X,
    Y,
)
from swarm_gym.problem.terrain.threats import LEAST_CONTACT, danger_of, distance_from, near
from swarm_gym.problem.terrain.waypoints import waypoint

NUM_SAMPLES = 12  # of a segment, its ends among them
PENALTY = 1e4
DEGREES = 180.0 / math.pi


@kernel(inline="late", borrows=True)
def metabox_terms(
    table: TerrainTable, path: Floats
) -> tuple[tuple[float, float, float, float, float, float, float], float]:
    """Return the terms in the order of `cost.TERMS`, the last two 0, and the exact degree of collision."""
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    z, exact_z, collision = height_as_coded(table, x, y) + above, height(table, x, y) + above, 0.0
    middle = (table.band[HIGHEST] + table.band[LOWEST]) / 2.0
    length, threats, altitude, angles = 0.0, 0.0, 0.0, 0.0
    before_x, before_y, before_level, before_rise = 0.0, 0.0, 0.0, 0.0
    is_clear, has_gap = True, False
    for number in range(1, table.num_waypoints + 2):
        to_x, to_y, above = waypoint(table, path, number, x, y, above)
        to_z = height_as_coded(table, to_x, to_y) + above
        exact_to_z = height(table, to_x, to_y) + above
        dx, dy, dz = to_x - x, to_y - y, to_z - z
        level = math.sqrt(dx * dx + dy * dy)
        length += math.sqrt(dx * dx + dy * dy + dz * dz)
        if number <= table.num_waypoints:
            altitude += PENALTY if above < 0.0 else abs(above - middle)
        has_gap = has_gap or level == 0.0
        if number > 1 and not has_gap:
            cross, dot = abs(before_x * dy - before_y * dx), before_x * dx + before_y * dy
            angles += _above(cross, dot, table.limits[TURN])
            cross, dot = before_level * dz - before_rise * level, before_level * level + before_rise * dz
            angles += _above(abs(cross), dot, table.limits[CLIMB])
        found, inside = _threats(table, x, y, exact_z, dx, dy, exact_to_z - exact_z)
        threats, collision = threats + found, collision + inside
        below = below_ground(table, x, y, exact_z, to_x, to_y, exact_to_z, 0.0, math.inf)[0]
        if below > 0.0:
            rise = exact_to_z - exact_z
            collision += max(below * math.sqrt(dx * dx + dy * dy + rise * rise), LEAST_CONTACT)
        is_clear = is_clear and _is_clear(table, x, y, z, to_x, to_y, to_z)
        x, y, z, exact_z = to_x, to_y, to_z, exact_to_z
        before_x, before_y, before_level, before_rise = dx, dy, level, dz
    if has_gap:
        angles = _angles_across_gaps(table, path)
    ground = 0.0 if is_clear else PENALTY
    return (length, threats, altitude, angles, ground, 0.0, 0.0), collision


@kernel(inline="late")
def _above(cross: float, dot: float, limit: float) -> float:
    """Return an angle in degrees if it is above a limit, else 0."""
    angle = DEGREES * arctangent(cross, dot)
    return angle if angle > limit else 0.0


@kernel(inline="late", borrows=True)
def _threats(
    table: TerrainTable, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> tuple[float, float]:
    """Return what threats cost a segment, by depths and contacts, and its length inside cylinders."""
    cost, inside = 0.0, 0.0
    for first in range(0, table.threats.shape[1], NUM_LANES):
        flags = near(table, first, x, y, dx, dy)
        for lane in range(NUM_LANES):
            if (flags >> lane) & 1:
                number = first + lane
                distance = distance_from(table, number, x, y, dx, dy, 0.0, 1.0)
                if distance < table.threats[CONTACT, number]:
                    cost += PENALTY
                    inside += danger_of(table, number, x, y, z, dx, dy, dz)[1]
                else:
                    cost += max(table.threats[DANGER, number] - distance, 0.0)
    return cost, inside


@kernel(inline="late", borrows=True)
def _is_clear(
    table: TerrainTable, x: float, y: float, z: float, to_x: float, to_y: float, to_z: float
) -> bool:
    """Return whether all samples of a segment lie above the ground, as the code reads it, one cell off."""
    u, v = in_cells(table, x, y)
    to_u, to_v = in_cells(table, to_x, to_y)
    u, v, to_u, to_v = u + 1.0, v + 1.0, to_u + 1.0, to_v + 1.0
    if max(u, to_u) > table.num_columns - 1 or max(v, to_v) > table.num_rows - 1:
        return False  # there the code compares with NaN
    if min(z, to_z) > _highest_around(table, u, v, to_u, to_v):
        return True
    for k in range(NUM_SAMPLES):
        if k < NUM_SAMPLES - 1:
            share = float(k)
            at_u = share * ((to_u - u) / (NUM_SAMPLES - 1)) + u
            at_v = share * ((to_v - v) / (NUM_SAMPLES - 1)) + v
            at_z = share * ((to_z - z) / (NUM_SAMPLES - 1)) + z
        else:
            at_u, at_v, at_z = to_u, to_v, to_z
        if not at_z > height_of_place(table, at_u, at_v):
            return False
    return True


@kernel(inline="late")
def _highest_around(table: TerrainTable, u: float, v: float, to_u: float, to_v: float) -> float:
    """Return the highest ground in a rectangle of blocks around a segment; infinity if they are many."""
    last_column, last_row = table.num_columns - 2, table.num_rows - 2
    first_column = min(int(min(u, to_u)), last_column) // BLOCK
    final_column = min(int(max(u, to_u)), last_column) // BLOCK
    first_row = min(int(min(v, to_v)), last_row) // BLOCK
    final_row = min(int(max(v, to_v)), last_row) // BLOCK
    if (final_column - first_column) * (final_row - first_row) > 2 * NUM_SAMPLES * NUM_LANES:
        return math.inf
    highest = -math.inf
    for row in range(first_row, final_row + 1):
        for column in range(first_column, final_column + 1):
            highest = max(highest, table.blocks[1, row, column])
    return highest


@kernel
def _angles_across_gaps(table: TerrainTable, path: Floats) -> float:
    """Return the cost of angles of a flight in which a segment has no length, seen from above.

    At a waypoint, the last segment before it and the first one after it that have a length give the
    directions. Heights come from the segments themselves.
    """
    n = table.num_waypoints
    steps = np.zeros((n + 1, 3))
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    z = height_as_coded(table, x, y) + above
    for number in range(1, n + 2):
        to_x, to_y, above = waypoint(table, path, number, x, y, above)
        to_z = height_as_coded(table, to_x, to_y) + above
        steps[number - 1, 0], steps[number - 1, 1], steps[number - 1, 2] = to_x - x, to_y - y, to_z - z
        x, y, z = to_x, to_y, to_z
    angles = 0.0
    for k in range(n):
        one, other = k, k + 1
        while one > 0 and steps[one, 0] == 0.0 and steps[one, 1] == 0.0:
            one -= 1
        while other < n and steps[other, 0] == 0.0 and steps[other, 1] == 0.0:
            other += 1
        cross = steps[one, 0] * steps[other, 1] - steps[one, 1] * steps[other, 0]
        dot = steps[one, 0] * steps[other, 0] + steps[one, 1] * steps[other, 1]
        angles += _above(abs(cross), dot, table.limits[TURN])
        climb = arctangent(steps[k, 2], math.sqrt(steps[one, 0] ** 2 + steps[one, 1] ** 2))
        next_climb = arctangent(steps[k + 1, 2], math.sqrt(steps[other, 0] ** 2 + steps[other, 1] ** 2))
        change = DEGREES * abs(next_climb - climb)
        if change > table.limits[CLIMB]:
            angles += change
    return angles
