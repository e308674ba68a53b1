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
    MARGIN,
    height,
    height_as_coded,
    height_of_place,
    highest_near,
    in_blocks,
    in_cells,
    unsure,
)
from swarm_gym.problem.terrain.table import (
    ABOVE,
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
    table: TerrainTable, path: Floats, measures: bool
) -> tuple[tuple[float, float, float, float, float, float, float], float]:
    """Return the terms in the order of `cost.TERMS`, the last two 0, and the exact degree of collision.

    Without `measures`, the degree of collision is 0: no term depends on it.
    """
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    z = height_as_coded(table, x, y) + above
    exact_z, collision = height(table, x, y) + above if measures else z, 0.0
    middle = (table.band[HIGHEST] + table.band[LOWEST]) / 2.0
    length, threats, altitude, angles = 0.0, 0.0, 0.0, 0.0
    before_x, before_y, before_level, before_rise = 0.0, 0.0, 0.0, 0.0
    is_clear, has_gap = True, False
    for number in range(1, table.num_waypoints + 2):
        to_x, to_y, above = waypoint(table, path, number, x, y, above)
        to_z = height_as_coded(table, to_x, to_y) + above
        exact_to_z = height(table, to_x, to_y) + above if measures else to_z
        dx, dy, dz = to_x - x, to_y - y, to_z - z
        level = math.sqrt(dx * dx + dy * dy)
        length += math.sqrt(dx * dx + dy * dy + dz * dz)
        if number <= table.num_waypoints:
            altitude += PENALTY if above < 0.0 else abs(above - middle)
        has_gap = has_gap or level == 0.0
        if number > 1 and not has_gap:
            turn, change = angles_as_coded(
                table, before_x, before_y, before_level, before_rise, dx, dy, level, dz
            )
            angles = angles + turn + change
        found, inside = _threats(table, x, y, exact_z, dx, dy, exact_to_z - exact_z, measures)
        threats, collision = threats + found, collision + inside
        u, v = in_cells(table, x, y)
        to_u, to_v = in_cells(table, to_x, to_y)
        du, dv, low, rise = to_u - u, to_v - v, min(z, exact_z), exact_to_z - exact_z
        begin, end = unsure(table, u, v, low, du, dv, min(to_z, exact_to_z) - low, 0.0, math.inf)
        if measures and begin < end:
            below = in_blocks(table, u, v, exact_z, du, dv, rise, 0.0, math.inf, begin, end)[0]
            if below > 0.0:
                collision += max(below * math.sqrt(dx * dx + dy * dy + rise * rise), LEAST_CONTACT)
        is_clear = is_clear and _is_clear(
            table, u + 1.0, v + 1.0, z, to_u + 1.0, to_v + 1.0, to_z, begin, end
        )
        x, y, z, exact_z = to_x, to_y, to_z, exact_to_z
        before_x, before_y, before_level, before_rise = dx, dy, level, dz
    if has_gap:
        angles = _angles_across_gaps(table, path)
    ground = 0.0 if is_clear else PENALTY
    return (length, threats, altitude, angles, ground, 0.0, 0.0), collision


@kernel(inline="late", borrows=True)
def angles_as_coded(
    table: TerrainTable,
    before_x: float,
    before_y: float,
    before_level: float,
    before_rise: float,
    dx: float,
    dy: float,
    level: float,
    rise: float,
) -> tuple[float, float]:
    """Return the turn and the change of climb from a step to the next, in degrees, each 0 within its limit.

    Of each step, `level` is its length seen from above, and `rise` what it climbs.
    """
    cross, dot = abs(before_x * dy - before_y * dx), before_x * dx + before_y * dy
    turn = _above(table, TURN, cross, dot)
    cross, dot = before_level * rise - before_rise * level, before_level * level + before_rise * rise
    return turn, _above(table, CLIMB, abs(cross), dot)


@kernel
def segment_as_coded(
    table: TerrainTable, x: float, y: float, z: float, to_x: float, to_y: float, to_z: float
) -> tuple[float, bool]:
    """Return what threats cost a segment, and whether its samples lie above the ground."""
    threats, _ = _threats(table, x, y, z, to_x - x, to_y - y, to_z - z, False)
    u, v = in_cells(table, x, y)
    to_u, to_v = in_cells(table, to_x, to_y)
    is_clear = _is_clear(table, u + 1.0, v + 1.0, z, to_u + 1.0, to_v + 1.0, to_z, 0.0, 1.0)
    return threats, is_clear


@kernel(inline="late", borrows=True)
def _above(table: TerrainTable, kind: int, cross: float, dot: float) -> float:
    """Return an angle in degrees, a turn or a climb, if it is above its limit; else 0."""
    if dot > 0.0 and cross < dot * table.tangents[kind]:
        return 0.0
    limit = table.limits[kind]
    angle = DEGREES * arctangent(cross, dot)
    return angle if angle > limit else 0.0


@kernel(inline="late", borrows=True)
def _threats(
    table: TerrainTable, x: float, y: float, z: float, dx: float, dy: float, dz: float, measures: bool
) -> tuple[float, float]:
    """Return what threats cost a segment, by depths and contacts, and its length inside cylinders or 0."""
    cost, inside = 0.0, 0.0
    for first in range(0, table.threats.shape[1], NUM_LANES):
        flags = near(table, first, x, y, dx, dy)
        for lane in range(NUM_LANES):
            if (flags >> lane) & 1:
                number = first + lane
                distance = distance_from(table, number, x, y, dx, dy, 0.0, 1.0)
                if distance < table.threats[CONTACT, number]:
                    cost += PENALTY
                    if measures:
                        inside += danger_of(table, number, x, y, z, dx, dy, dz)[1]
                else:
                    cost += max(table.threats[DANGER, number] - distance, 0.0)
    return cost, inside


@kernel(inline="late", borrows=True)
def _is_clear(
    table: TerrainTable,
    u: float,
    v: float,
    z: float,
    to_u: float,
    to_v: float,
    to_z: float,
    begin: float,
    end: float,
) -> bool:
    """Return whether samples of a segment lie above the ground; those outside of two shares do.

    Places are in cells, one cell off, as the code reads them.
    """
    if max(u, to_u) > table.num_columns - 1 or max(v, to_v) > table.num_rows - 1:
        return False  # there the code compares with NaN
    last = NUM_SAMPLES - 1
    for k in range(math.ceil(begin * last), math.floor(end * last) + 1):
        if k < last:
            share = float(k)
            at_u, at_v = share * ((to_u - u) / last) + u, share * ((to_v - v) / last) + v
            at_z = share * ((to_z - z) / last) + z
        else:
            at_u, at_v, at_z = to_u, to_v, to_z
        if at_z > highest_near(table, at_u, at_v) + MARGIN:
            continue
        if not at_z > height_of_place(table, at_u, at_v):
            return False
    return True


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
        angles += _above(table, TURN, abs(cross), dot)
        climb = arctangent(steps[k, 2], math.sqrt(steps[one, 0] ** 2 + steps[one, 1] ** 2))
        next_climb = arctangent(steps[k + 1, 2], math.sqrt(steps[other, 0] ** 2 + steps[other, 1] ** 2))
        change = DEGREES * abs(next_climb - climb)
        if change > table.limits[CLIMB]:
            angles += change
    return angles
