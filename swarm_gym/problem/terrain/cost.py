"""Cost of a flight: named terms with weights, and its degree of collision.

| term | `documented`, exactly | `metabox`, as published code has it |
|---|---|---|
| length | metres of the flight | the same, with the nearest height below each waypoint |
| threats | metres of depth in zones of danger; contacts cost a penalty | the same; cylinders have no top |
| altitude | metres off the middle of the band, at waypoints | the same |
| angles | all degrees of turns and of changes of climb | angles above the limits only |
| ground | segments below the ground cost a penalty | one penalty if any of 12 samples is below |
| band | metres outside the altitude band, anywhere | - |
| limits | degrees of turns and of climbs above the limits | - |

Source of the terms: M. A. Shehadeh, J. Kudela, "Benchmarking global optimization techniques for unmanned
aerial vehicle path planning", arXiv 2501.14503, 2025, and MetaBox-v2, which publishes a description and code
of them that differ; docs/readings.md lists how. The degree of collision is the same for both choices: the
metres of the flight below the ground, and inside each of the threats.
"""

import math

from swarm_gym.compiler.elementary import arctangent
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.problem.padding import Floats
from swarm_gym.problem.terrain.as_coded import metabox_terms
from swarm_gym.problem.terrain.ground import below_ground, height
from swarm_gym.problem.terrain.table import (
    ABOVE,
    CLIMB,
    HIGHEST,
    LOWEST,
    METABOX,
    TURN,
    TerrainTable,
    X,
    Y,
)
from swarm_gym.problem.terrain.threats import LEAST_CONTACT, dangers
from swarm_gym.problem.terrain.waypoints import waypoint

TERMS = ("length", "threats", "altitude", "angles", "ground", "band", "limits")
# Weights of the terms: the first five are published.
WEIGHTS = (5.0, 1.0, 10.0, 1.0, 1.0, 10.0, 100.0)
# Published penalty of a contact with a threat, or of a segment below the ground.
PENALTY = 1e4
# Added to it for each metre there, so that of two flights that are not free the shorter way there is better.
PENALTY_PER_METRE = 100.0

# Metres by which the altitude band is wider here: along its limits, rounding would decide about segments.
SLACK = 1e-6

DEGREES = 180.0 / math.pi

Terms = tuple[float, float, float, float, float, float, float]


@kernel(borrows=True)
def evaluate(table: TerrainTable, path: Floats) -> tuple[float, float]:
    """Return fitness (minimised) and degree of collision of a flight, in metres; see `tables`."""
    if table.cost == METABOX:
        terms, collision = metabox_terms(table, path, True)
    else:
        terms, collision = exact_terms(table, path)
    return _weighted(terms), collision


@kernel(inline="late")
def _weighted(terms: Terms) -> float:
    """Return the sum of the terms with their weights."""
    fitness = 0.0
    for k in range(len(terms)):
        fitness += WEIGHTS[k] * terms[k]
    return fitness


@entry
def costs_entry(table: TerrainTable, vectors: Floats, path: Floats, costs: Floats) -> None:
    """Write the fitness, (m,), of decision vectors, (m, D), for Python; `path` is workspace, (C + 1,).

    No degree of collision is measured where the fitness does not depend on it.
    """
    for i in range(vectors.shape[0]):
        for k in range(vectors.shape[1]):
            path[k + 1] = vectors[i, k]
        if table.cost == METABOX:
            costs[i] = _weighted(metabox_terms(table, path, False)[0])
        else:
            costs[i] = evaluate(table, path)[0]


@entry
def terms_entry(table: TerrainTable, path: Floats) -> Terms:
    """Return the terms of a flight, without their weights, in the order of `TERMS`; for callers in Python."""
    if table.cost == METABOX:
        return metabox_terms(table, path, False)[0]
    return exact_terms(table, path)[0]


@kernel(borrows=True)
def exact_terms(table: TerrainTable, path: Floats) -> tuple[Terms, float]:
    """Return the terms of the documented cost and the degree of collision.

    A turn or a change of climb is that between two steps with a length: a waypoint twice in the same place
    hides neither.
    """
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    z = height(table, x, y) + above
    middle = 0.5 * (table.band[LOWEST] + table.band[HIGHEST])
    length, threats, altitude, angles, ground, band, limits = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    collision, before_x, before_y, before_climb, has_before = 0.0, 0.0, 0.0, 0.0, False
    for number in range(1, table.num_waypoints + 2):
        to_x, to_y, above = waypoint(table, path, number, x, y, above)
        to_z = height(table, to_x, to_y) + above
        if number <= table.num_waypoints:
            altitude += abs(above - middle)
        dx, dy = to_x - x, to_y - y
        climb = DEGREES * arctangent(to_z - z, math.sqrt(dx * dx + dy * dy))
        limits += max(abs(climb) - table.limits[CLIMB], 0.0)
        is_level, is_step = dx != 0.0 or dy != 0.0, dx != 0.0 or dy != 0.0 or to_z != z
        if has_before and is_step:
            turn = turn_between(before_x, before_y, dx, dy)
            limits += max(turn - table.limits[TURN], 0.0)
            angles += turn + abs(climb - before_climb)
        metres, at_threats, at_ground, outside, inside = segment_terms(table, x, y, z, to_x, to_y, to_z)
        length, threats, ground = length + metres, threats + at_threats, ground + at_ground
        band, collision = band + outside, collision + inside
        if is_level:
            before_x, before_y = dx, dy
        if is_step:
            before_climb, has_before = climb, True
        x, y, z = to_x, to_y, to_z
    return (length, threats, altitude, angles, ground, band, limits), collision


@kernel(borrows=True)
def turn_between(before_x: float, before_y: float, dx: float, dy: float) -> float:
    """Return the turn between two steps, seen from above, in degrees."""
    cross, dot = before_x * dy - before_y * dx, before_x * dx + before_y * dy
    return DEGREES * arctangent(abs(cross), dot)


@kernel(borrows=True)
def segment_terms(
    table: TerrainTable, x: float, y: float, z: float, to_x: float, to_y: float, to_z: float
) -> tuple[float, float, float, float, float]:
    """Return the terms of one segment, without the terms of angles and limits.

    Returns:
        The length, the terms of threats, ground and band, and the metres in collision.
    """
    dx, dy, dz = to_x - x, to_y - y, to_z - z
    metres = math.sqrt(dx * dx + dy * dy + dz * dz)
    depth, contacts, inside = dangers(table, x, y, z, dx, dy, dz)
    threats, ground = depth + PENALTY * contacts + PENALTY_PER_METRE * inside, 0.0
    lowest, highest = table.band[LOWEST] - SLACK, table.band[HIGHEST] + SLACK
    below, outside, _ = below_ground(table, x, y, z, to_x, to_y, to_z, lowest, highest)
    if below > 0.0:
        depth = max(below * metres, LEAST_CONTACT)
        ground = PENALTY + PENALTY_PER_METRE * depth
        inside += depth
    return metres, threats, ground, outside * metres, inside
