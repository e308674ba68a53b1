"""The polyline of a taut path: its corners, and around each disc points that lie just outside it."""

import math

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.reference.free_arcs import Sites
from swarm_gym.reference.solids import NONE, Cells, Floats, Solids, extended, is_blocked
from swarm_gym.reference.tangents import ARRIVAL, DEPARTURE, PARENT, SIGN, SITE, Tangents

# Largest angle between two segments along an arc.
SAMPLING_ANGLE = math.radians(0.5)
# Points by which an arc may have more, because neighbouring obstacles leave little room.
MOST_MORE = 256


@kernel
def write_polyline(solids: Solids, cells: Cells, sites: Sites, tangents: Tangents, last: int) -> Floats:
    """Return the points of a path from its first tangent to its last one, (k, 2).

    Around a disc they lie outside it, on tangents. Where these enter another obstacle, they are shorter.
    """
    count, node = 1, last
    while tangents.marks[node, PARENT] >= 0:
        node = tangents.marks[node, PARENT]
        count += 1
    nodes = np.zeros(count, np.int64)
    node = last
    for k in range(count - 1, -1, -1):
        nodes[k] = node
        node = tangents.marks[node, PARENT]
    points = np.zeros((count + 2, 2))
    points[0, 0], points[0, 1] = tangents.lines[nodes[0], 0], tangents.lines[nodes[0], 1]
    n = NONE + 1
    for k in range(count):
        here = nodes[k]
        if k == count - 1 or sites.circles[tangents.marks[here, SITE], 2] == 0.0:
            points[n, 0], points[n, 1] = tangents.lines[here, 2], tangents.lines[here, 3]
            n += 1
            continue
        turn = tangents.marks[here, SIGN] * (
            tangents.lines[nodes[k + 1], DEPARTURE] - tangents.lines[here, ARRIVAL]
        )
        turn %= math.tau
        if turn > math.tau - 1e-3:  # no turn, rounded
            turn = 0.0
        most = math.ceil(turn / SAMPLING_ANGLE) + 2 * MOST_MORE
        if n + most + count > points.shape[0]:
            points = extended(points, 2 * (n + most + count), 0.0)
        n += _write_arc(solids, cells, sites, tangents, here, turn, points, n)
    return points[:n].copy()


@kernel
def _write_arc(
    solids: Solids,
    cells: Cells,
    sites: Sites,
    tangents: Tangents,
    before: int,
    turn: float,
    points: Floats,
    n: int,
) -> int:
    """Write points around the arc after a tangent from index `n` on; return their number.

    Between two places on the arc, the path goes along the tangents there; a point is where these meet.
    """
    site, sign, begin = (
        tangents.marks[before, SITE],
        tangents.marks[before, SIGN],
        tangents.lines[before, ARRIVAL],
    )
    x, y, radius = sites.circles[site, 0], sites.circles[site, 1], sites.circles[site, 2]
    usual = turn / max(1, math.ceil(turn / SAMPLING_ANGLE))
    # Tangents over so small an angle are no further from the circle than the tolerance.
    least = math.sqrt(solids.tolerance / radius)
    done, part, more, count = 0.0, usual, NONE, NONE
    px, py = tangents.lines[before, 2], tangents.lines[before, 3]
    while count == 0 or turn - done > 1e-3 * least:
        if turn - done < 1.001 * part:
            part = turn - done
        outer, angle = radius / math.cos(0.5 * part), begin + sign * (done + 0.5 * part)
        middle_x, middle_y = x + outer * math.cos(angle), y + outer * math.sin(angle)
        angle += 0.5 * sign * part
        qx, qy = x + radius * math.cos(angle), y + radius * math.sin(angle)
        if (
            part > least
            and more < MOST_MORE
            and (
                is_blocked(solids, cells, px, py, middle_x, middle_y)
                or is_blocked(solids, cells, middle_x, middle_y, qx, qy)
            )
        ):
            part *= 0.5
            more += 1
            continue
        points[n + count, 0], points[n + count, 1] = middle_x, middle_y
        count += 1
        done += part
        part = min(2.0 * part, usual)
        px, py = qx, qy
    return count
