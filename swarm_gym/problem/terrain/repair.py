"""Repair of flights that are not free, by a degree phi: segments leave threats, and waypoints rise.

This is a reading of the repair of the SPSFA paper, section III (docs/readings.md). There a segment in
collision moves in parallel by phi times its degree of collision. Segments follow from the start on, each
after the changes of those before it:

* A segment in contact with a threat moves to the nearer side. It moves by phi times the distance that takes
  its line out of the cylinder. Ends of a segment move across the start-goal line in the encoding
  `waypoints`, and across the segment in the others.
* Both ends of a segment below the ground rise by phi times its depth, at most to the top of the band.

Start and goal stay, and so does a flight that is free.
"""

import math

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.problem.padding import Floats
from swarm_gym.problem.terrain.ground import below_ground, height
from swarm_gym.problem.terrain.table import (
    ABOVE,
    CENTRE_X,
    CENTRE_Y,
    CONTACT,
    HIGHEST,
    WAYPOINTS,
    X_MAX,
    X_MIN,
    Y_MAX,
    Y_MIN,
    TerrainTable,
    X,
    Y,
)
from swarm_gym.problem.terrain.threats import danger_of, near
from swarm_gym.problem.terrain.waypoints import clipped, head_for, waypoint, write_waypoints

# A line that crosses the direction of movement at a smaller sine is moved as with this one.
LEAST_SINE = 0.1
# Distance in metres that a repaired segment keeps from a cylinder, so that rounding leaves no contact.
SPARE = 1e-6


@kernel
def repair(table: TerrainTable, path: Floats, repair_degree: float) -> None:
    """Repair a flight once, in place and inside the bounds; see `tables`."""
    places = np.empty((table.num_waypoints + 2, 3))
    write_waypoints(table, path, places)
    moved = _move_aside(table, places, repair_degree)
    moved = _rise(table, places, repair_degree) or moved
    if not moved:
        return
    before = (table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE])
    for number in range(1, table.num_waypoints + 1):
        there = (places[number, X], places[number, Y], places[number, ABOVE])
        head_for(table, path, number, before, there)
        before = waypoint(table, path, number, before[0], before[1], before[2])


@kernel(borrows=True)
def _move_aside(table: TerrainTable, places: Floats, repair_degree: float) -> bool:
    """Move segments out of threats; return whether any was in contact."""
    moved = False
    for number in range(places.shape[0] - 1):
        x, y = places[number, X], places[number, Y]
        dx, dy = places[number + 1, X] - x, places[number + 1, Y] - y
        for first in range(0, table.threats.shape[1], NUM_LANES):
            flags = near(table, first, x, y, dx, dy)
            for lane in range(NUM_LANES):
                if (flags >> lane) & 1 and _clear_of(table, first + lane, places, number, repair_degree):
                    moved = True
    return moved


@kernel(borrows=True)
def _clear_of(table: TerrainTable, threat: int, places: Floats, number: int, repair_degree: float) -> bool:
    """Move a segment away from a threat by phi; return whether it was in contact."""
    x, y = places[number, X], places[number, Y]
    dx, dy = places[number + 1, X] - x, places[number + 1, Y] - y
    z = height(table, x, y) + places[number, ABOVE]
    to_z = height(table, places[number + 1, X], places[number + 1, Y]) + places[number + 1, ABOVE]
    if danger_of(table, threat, x, y, z, dx, dy, to_z - z)[1] == 0.0:
        return False
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return False
    # Positive where the centre lies to the left of the segment, which then moves to the right.
    to_x, to_y = table.threats[CENTRE_X, threat] - x, table.threats[CENTRE_Y, threat] - y
    left = (dx * to_y - dy * to_x) / length
    aside_x, aside_y = -dy / length, dx / length
    sine = 1.0
    if table.encoding == WAYPOINTS:
        aside_x, aside_y = -table.forward[Y], table.forward[X]
        sine = max((dx * table.forward[X] + dy * table.forward[Y]) / length, LEAST_SINE)
    shift = repair_degree * (max(table.threats[CONTACT, threat] - abs(left), 0.0) + SPARE) / sine
    shift = -shift if left > 0.0 else shift
    for end in range(number, number + 2):
        if 0 < end < places.shape[0] - 1:
            reached = _kept_aside(table, places, end, shift, aside_x, aside_y)
            places[end, X], places[end, Y] = reached
    return True


@kernel(borrows=True)
def _kept_aside(
    table: TerrainTable, places: Floats, number: int, shift: float, aside_x: float, aside_y: float
) -> tuple[float, float]:
    """Return x and y of a waypoint that is moved by a shift, as far as bounds let it."""
    x, y = places[number, X], places[number, Y]
    if table.encoding == WAYPOINTS:
        offset = (y - table.ends[0, Y]) * table.forward[X] - (x - table.ends[0, X]) * table.forward[Y]
        kept = clipped(offset + shift, table.lower[number - 1], table.upper[number - 1]) - offset
        return x + kept * aside_x, y + kept * aside_y
    x, y = x + shift * aside_x, y + shift * aside_y
    x = clipped(x, table.extent[X_MIN], table.extent[X_MAX])
    return x, clipped(y, table.extent[Y_MIN], table.extent[Y_MAX])


@kernel(borrows=True)
def _rise(table: TerrainTable, places: Floats, repair_degree: float) -> bool:
    """Raise waypoints of segments that lie below the ground; return whether any did."""
    rose = False
    for number in range(places.shape[0] - 1):
        x, y, to_x, to_y = places[number, X], places[number, Y], places[number + 1, X], places[number + 1, Y]
        z = height(table, x, y) + places[number, ABOVE]
        to_z = height(table, to_x, to_y) + places[number + 1, ABOVE]
        depth = below_ground(table, x, y, z, to_x, to_y, to_z, 0.0, math.inf)[2]
        if depth > 0.0:
            rose = True
            for end in range(number, number + 2):
                if 0 < end < places.shape[0] - 1:
                    above = places[end, ABOVE] + repair_degree * depth
                    places[end, ABOVE] = min(above, table.band[HIGHEST])
    return rose
