"""Threats near a flight: upright cylinders, and the zone of danger around each.

A cylinder counts with the size of the drone: contact is at its radius plus that size, and a flight passes
above it from its top plus that size on.
"""

import math

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, bits, load, maximum, minimum
from swarm_gym.problem.terrain.table import (
    CENTRE_X,
    CENTRE_Y,
    CONTACT,
    DANGER,
    SQUARED_DANGER,
    TOP,
    TerrainTable,
)

# Length in metres of a contact at least, where rounding could leave nothing of it.
LEAST_CONTACT = 1e-6


@kernel(inline="late", borrows=True)
def near(table: TerrainTable, first: int, x: float, y: float, dx: float, dy: float) -> int:
    """Return which of eight threats, from the number `first` on, a segment endangers, as bits."""
    squared = dx * dx + dy * dy
    inverse = 1.0 / squared if squared > 0.0 else 0.0
    to_x = load(table.threats[CENTRE_X], first) - x
    to_y = load(table.threats[CENTRE_Y], first) - y
    share = minimum(maximum((to_x * dx + to_y * dy) * inverse, 0.0), 1.0)
    away_x, away_y = to_x - share * dx, to_y - share * dy
    return bits(away_x * away_x + away_y * away_y < load(table.threats[SQUARED_DANGER], first))


@kernel(inline="late", borrows=True)
def distance_from(
    table: TerrainTable, number: int, x: float, y: float, dx: float, dy: float, begin: float, end: float
) -> float:
    """Return the distance, seen from above, of the centre of a threat from a part of a segment."""
    to_x, to_y = table.threats[CENTRE_X, number] - x, table.threats[CENTRE_Y, number] - y
    squared = dx * dx + dy * dy
    share = (to_x * dx + to_y * dy) / squared if squared > 0.0 else begin
    share = min(max(share, begin), end)
    away_x, away_y = to_x - share * dx, to_y - share * dy
    return math.sqrt(away_x * away_x + away_y * away_y)


@kernel(inline="late", borrows=True)
def danger_of(
    table: TerrainTable, number: int, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> tuple[float, float]:
    """Return the depth of a segment in the zone of a threat, and its length inside the cylinder, in metres.

    The depth is 0 in contact. Only the part of the segment below the top of the cylinder counts.
    """
    begin, end, top = 0.0, 1.0, table.threats[TOP, number]
    if dz > 0.0:
        end = min((top - z) / dz, 1.0)
    elif dz < 0.0:
        begin = max((top - z) / dz, 0.0)
    elif z >= top:
        return 0.0, 0.0
    if begin >= end:
        return 0.0, 0.0
    contact = table.threats[CONTACT, number]
    distance = distance_from(table, number, x, y, dx, dy, begin, end)
    if distance >= contact:
        return max(table.threats[DANGER, number] - distance, 0.0), 0.0
    squared = dx * dx + dy * dy
    length = math.sqrt(squared + dz * dz)
    if squared > 0.0:
        to_x, to_y = table.threats[CENTRE_X, number] - x, table.threats[CENTRE_Y, number] - y
        middle, away = (to_x * dx + to_y * dy) / squared, to_x * dy - to_y * dx
        half = math.sqrt(max(contact * contact - away * away / squared, 0.0) / squared)
        begin, end = max(begin, middle - half), min(end, middle + half)
    return 0.0, max((end - begin) * length, LEAST_CONTACT)


@kernel(inline="late", borrows=True)
def dangers(
    table: TerrainTable, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> tuple[float, int, float]:
    """Return the depth of a segment in zones of danger, its contacts, and its length inside cylinders."""
    depth, contacts, inside = 0.0, 0, 0.0
    for first in range(0, table.threats.shape[1], NUM_LANES):
        flags = near(table, first, x, y, dx, dy)
        for lane in range(NUM_LANES):
            if (flags >> lane) & 1:
                found, length = danger_of(table, first + lane, x, y, z, dx, dy, dz)
                depth += found
                if length > 0.0:
                    contacts, inside = contacts + 1, inside + length
    return depth, contacts, inside
