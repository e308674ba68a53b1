"""The ground below a route seen from above: its height at every line between cells, and how far it bulges.

In a cell the ground is bilinear, so along a straight line it is quadratic. Its largest distance from the
chord between two lines of cells is known, so bounds at the lines hold everywhere between them. Cells are
those of the file. Where these are in degrees, a line is taken to be straight in them for `LONGEST` metres:
there it departs from its chord by less than 0.1 mm, up to a latitude of 70 degrees.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.survey import Survey

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

LONGEST = 40.0  # metres
NEAREST = 1e-6  # metres from another node, nearer than which a line between cells is passed over


class GroundTrack(NamedTuple):
    """The ground below a route, at n nodes: its vertices, and wherever it enters another cell.

    Over a map that was sampled they are no more than `LONGEST` metres apart, too.

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

    @property
    def from_ends(self) -> Floats:
        """Distances of the nodes from the nearer one of start and goal, along the route."""
        nearer: Floats = np.minimum(self.along, self.along[-1] - self.along)
        return nearer


def ground_track(task: Survey, route: Floats, *, finer_ends: bool = False) -> GroundTrack:
    """Return the ground below a route, (k, 2) points of the map; a segment without length has one piece.

    Args:
        task: the task.
        route: the points from start to goal, seen from above.
        finer_ends: with further nodes, so that no piece but the first and the last is longer than its
            distance from start and goal. There are three nodes at least. Segments without length have no
            piece.
    """
    nodes, segments, vertices = _nodes_in_file(task, route) if task.is_resampled else _nodes(task, route)
    if finer_ends:
        nodes, segments, vertices = _with_finer_ends(nodes, segments, vertices)
    nodes, segments, vertices = _without_near_ones(nodes, segments, vertices)
    ground = task.ground(nodes)
    middle = task.ground(0.5 * (nodes[:-1] + nodes[1:])) - 0.5 * (ground[:-1] + ground[1:])
    lengths = np.sqrt((np.diff(nodes, axis=0) ** 2).sum(axis=1))
    return GroundTrack(
        np.append(0.0, np.cumsum(lengths)),
        nodes,
        ground,
        np.maximum(middle, 0.0),
        np.maximum(-middle, 0.0),
        segments,
        vertices,
    )


def _without_near_ones(
    nodes: Floats, segments: Integers, vertices: Integers
) -> tuple[Floats, Integers, Integers]:
    """Return nodes without those that lie next to another one, as at corners of cells; vertices stay.

    Beside a vertex, roundings would make a flight turn.
    """
    is_near = np.sqrt((np.diff(nodes, axis=0) ** 2).sum(axis=1)) <= NEAREST
    is_vertex = np.zeros(len(nodes), dtype=bool)
    is_vertex[vertices] = True
    before_vertex = np.append(is_near & is_vertex[1:], False)
    is_kept = is_vertex | ~(np.append(False, is_near) | before_vertex)
    places = np.cumsum(is_kept) - 1
    return nodes[is_kept], segments[is_kept[:-1]], places[vertices]


def _with_finer_ends(
    nodes: Floats, segments: Integers, vertices: Integers
) -> tuple[Floats, Integers, Integers]:
    """Return nodes with further ones at doubling distances from start and goal, without very near ones."""
    lengths = np.sqrt((np.diff(nodes, axis=0) ** 2).sum(axis=1))
    along = np.append(0.0, np.cumsum(lengths))
    whole = along[-1]
    is_kept = np.minimum(along, whole - along) > NEAREST
    is_kept[vertices] = True
    kept = np.unique(along[is_kept])
    doubled = 2.0 ** np.arange(1.0, 64.0)
    from_start, from_goal = kept[1] * doubled, (whole - kept[-2]) * doubled
    halves = from_start[from_start < 0.5 * whole], whole - from_goal[from_goal < 0.5 * whole]
    finer = np.unique(np.concatenate([kept, *halves, [0.5 * whole]]))
    piece = np.clip(np.searchsorted(along, finer[:-1], side="right") - 1, 0, len(segments) - 1)
    found = np.column_stack([np.interp(finer, along, nodes[:, axis]) for axis in range(2)])
    places = np.searchsorted(finer, along[vertices])
    found[places] = nodes[vertices]
    return found, segments[piece], places


def _nodes(task: Survey, route: Floats) -> tuple[Floats, Integers, Integers]:
    """Return the nodes on lines between cells of the task, the segments of pieces, and the vertices."""
    points, segments, vertices = [route[:1]], [], [0]
    for number, (begin, end) in enumerate(pairwise(route)):
        shares = _crossings(task.scenario, begin, end)
        points.append(begin + (end - begin) * shares[:, None])
        segments.append(np.full(len(shares), number))
        vertices.append(vertices[-1] + len(shares))
    nodes = np.vstack(points)
    nodes[vertices] = route
    return nodes, np.concatenate(segments), np.array(vertices)


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


def _nodes_in_file(task: Survey, route: Floats) -> tuple[Floats, Integers, Integers]:
    """Return the nodes on lines between cells of the file, the segments of pieces, and the vertices.

    The route is cut into pieces that are straight in the coordinates of the file, and no longer than a cell.
    """
    steps = np.diff(route, axis=0)
    longest = min(task.scenario.cell, LONGEST)
    counts = np.maximum(np.ceil(np.hypot(*steps.T) / longest).astype(int), 1)  # pieces of each segment
    ends = np.cumsum(counts)
    segment = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(ends[-1]) - (ends - counts)[segment]) / counts[segment]
    cuts = np.vstack([route[segment] + steps[segment] * share[:, None], route[-1:]])
    places = task.places_in_file(cuts)
    change = np.diff(places, axis=0)
    low, high = np.minimum(places[:-1], places[1:]), np.maximum(places[:-1], places[1:])
    found = [
        np.arange(len(cuts), dtype=np.float64)
    ]  # numbers of cuts, with a share of the way to the next one
    for axis in range(2):
        for further in range(2):  # a piece that is as long as a cell may end on a second line
            line = np.ceil(low[:, axis]) + further
            (crossed,) = np.nonzero((line <= high[:, axis]) & (change[:, axis] != 0.0))
            found.append(crossed + (line[crossed] - places[crossed, axis]) / change[crossed, axis])
    along = np.unique(np.concatenate(found))
    piece = np.minimum(along.astype(int), len(cuts) - 2)
    nodes = cuts[piece] + (cuts[piece + 1] - cuts[piece]) * (along - piece)[:, None]
    vertices = np.searchsorted(along, np.append(0, ends))
    nodes[vertices] = route
    return nodes, segment[piece[:-1]], vertices
