"""The polyline of a taut path: its corners, and around each disc points that lie just outside it."""

import math

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.reference.free_arcs import Sites
from swarm_gym.reference.solids import NONE, Cells, Floats, Solids, extended, is_blocked
from swarm_gym.reference.tangents import ARRIVAL, DEPARTURE, PARENT, SIGN, SITE, Tangents

# Largest angle between two segments along an arc.
SAMPLING_ANGLE = math.radians(0.5)
# Parts that such an angle is cut into where a neighbouring obstacle leaves little room.
MOST_PARTS = 64


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
        pieces = _pieces(tangents, here, nodes[k + 1])
        most = MOST_PARTS * pieces
        if n + most + count + 2 > points.shape[0]:
            points = extended(points, 2 * (n + most + count + 2), 0.0)
        while True:
            _write_arc(sites, tangents, here, nodes[k + 1], pieces, points, n)
            if 2 * pieces > most or _is_free(solids, cells, tangents, here, nodes[k + 1], points, n, pieces):
                break
            pieces *= 2
        n += pieces
    return points[:n].copy()


@kernel
def _turn(tangents: Tangents, before: int, after: int) -> float:
    """Return the angle of the arc between two tangents, at least 0."""
    turn = (
        tangents.marks[before, SIGN]
        * (tangents.lines[after, DEPARTURE] - tangents.lines[before, ARRIVAL])
        % math.tau
    )
    return 0.0 if turn > math.tau - 1e-6 else turn


@kernel
def _pieces(tangents: Tangents, before: int, after: int) -> int:
    return max(1, math.ceil(_turn(tangents, before, after) / SAMPLING_ANGLE))


@kernel
def _write_arc(
    sites: Sites, tangents: Tangents, before: int, after: int, pieces: int, points: Floats, n: int
) -> None:
    """Write points around the arc between two tangents, from index `n` on."""
    site = tangents.marks[before, SITE]
    x, y, radius = sites.circles[site, 0], sites.circles[site, 1], sites.circles[site, 2]
    turn = _turn(tangents, before, after)
    outer = radius / math.cos(0.5 * turn / pieces)
    for k in range(pieces):
        angle = tangents.lines[before, ARRIVAL] + tangents.marks[before, SIGN] * turn * (k + 0.5) / pieces
        points[n + k, 0], points[n + k, 1] = x + outer * math.cos(angle), y + outer * math.sin(angle)


@kernel
def _is_free(
    solids: Solids,
    cells: Cells,
    tangents: Tangents,
    before: int,
    after: int,
    points: Floats,
    n: int,
    pieces: int,
) -> bool:
    """Return whether the points from index `n` on enter no obstacle between two tangents."""
    px, py = tangents.lines[before, 2], tangents.lines[before, 3]
    for k in range(n, n + pieces):
        if is_blocked(solids, cells, px, py, points[k, 0], points[k, 1]):
            return False
        px, py = points[k, 0], points[k, 1]
    return not is_blocked(solids, cells, px, py, tangents.lines[after, 0], tangents.lines[after, 1])
