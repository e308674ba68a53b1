"""The ground below a route seen from above: its height at every line between cells, and how far it bulges.

In a cell the ground is bilinear, so along a straight line it is quadratic. Its largest distance from the
chord between two lines of cells is known, so bounds at the lines hold everywhere between them.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import TerrainScenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class GroundTrack(NamedTuple):
    """The ground below a route, at n nodes: its vertices, and wherever it enters another cell.

    Attributes:
        along: (n,) distances from the start, seen from above.
        points: (n, 2) x and y.
        ground: (n,) heights of the ground.
        bulge: (n - 1,) largest height of the ground above the chord between two nodes, at least 0.
        sink: (n - 1,) largest depth of the ground below that chord, at least 0.
        segment: (n - 1,) number of the segment of the route that the piece belongs to.
        vertices: (k,) numbers of the nodes that are vertices of the route.
    """

    along: Floats
    points: Floats
    ground: Floats
    bulge: Floats
    sink: Floats
    segment: Integers
    vertices: Integers


def ground_track(scenario: TerrainScenario, route: Floats) -> GroundTrack:
    """Return the ground below a route, (k, 2) points of the map; a segment without length has one piece."""
    points, segments, vertices = [route[:1]], [], [0]
    for number, (begin, end) in enumerate(pairwise(route)):
        shares = _crossings(scenario, begin, end)
        points.append(begin + (end - begin) * shares[:, None])
        segments.append(np.full(len(shares), number))
        vertices.append(vertices[-1] + len(shares))
    nodes = np.vstack(points)
    nodes[vertices] = route
    ground = scenario.ground(nodes)
    middle = scenario.ground(0.5 * (nodes[:-1] + nodes[1:])) - 0.5 * (ground[:-1] + ground[1:])
    lengths = np.sqrt((np.diff(nodes, axis=0) ** 2).sum(axis=1))
    return GroundTrack(
        np.append(0.0, np.cumsum(lengths)),
        nodes,
        ground,
        np.maximum(middle, 0.0),
        np.maximum(-middle, 0.0),
        np.concatenate(segments),
        np.array(vertices),
    )


def _crossings(scenario: TerrainScenario, begin: Floats, end: Floats) -> Floats:
    """Return the shares of a segment, in (0, 1], at which it enters another cell or ends."""
    first = (begin - scenario.origin) / scenario.cell
    change = (end - begin) / scenario.cell
    found = [np.ones(1)]
    for axis in range(2):
        low, high = sorted((float(first[axis]), float(first[axis] + change[axis])))
        lines = np.arange(np.ceil(low), np.floor(high) + 1.0)
        if change[axis] != 0.0:
            found.append((lines - first[axis]) / change[axis])
    shares = np.unique(np.concatenate(found))
    return shares[(shares > 1e-12) & ((shares < 1.0 - 1e-12) | (shares == 1.0))]
