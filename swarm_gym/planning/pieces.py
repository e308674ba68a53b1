"""Polygons of any form, cut into few convex pieces whose union is the polygon.

A constrained Delaunay triangulation is made coarser: a diagonal is removed wherever the two pieces next to it
are convex together. Two pieces of a polygon that touch along an edge share that edge as a whole.

Source: S. Hertel, K. Mehlhorn, "Fast triangulation of simple polygons", FCT 1983, LNCS 158. The number of
pieces is at most four times the least possible.
"""

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import Point, Polygon

if TYPE_CHECKING:
    import shapely

Floats = NDArray[np.float64]
Ring = list[Point]  # corners; the first is not repeated at the end

# Height of a corner above the line between its neighbours, as a share of the map's extent, up to which it is
# straight. Moving and scaling a map rounds by about 1e-15 of its extent, so that pieces stay convex.
FLAT = 1e-13
SAME_AREA = 1e-12  # largest difference between the areas of a polygon and its triangles, as a share
# Spacing, as a share of the extent, of the points to which a polygon with corners nearly on edges is rounded.
GRID = 1e-11


def without_repeats(points: Ring) -> Ring:
    """Return a ring without points that repeat the point before, also without a last one that closes it."""
    kept = points[:1] + [here for before, here in pairwise(points) if here != before]
    while len(kept) > 1 and kept[-1] == kept[0]:
        kept.pop()
    return kept


def as_convex(ring: Ring, extent: float) -> Ring | None:
    """Return a ring without its straight corners if it is convex, else None.

    Args:
        ring: at least one corner, in either direction.
        extent: extent of the map, in map units.
    """
    flat = FLAT * extent
    first = min(range(len(ring)), key=ring.__getitem__)  # an extreme point, so it is no straight corner
    corners = ring[first:] + ring[:first]
    kept = corners[:1]
    for here, after in pairwise([*corners[1:], corners[0]]):
        if not _is_straight(kept[-1], here, after, flat):
            kept.append(here)
    if len(kept) < 3:
        return None
    heights = [_height(kept[k - 2], kept[k - 1], kept[k]) for k in range(len(kept))]
    if min(heights) <= flat and max(heights) >= -flat:
        return None
    try:
        Polygon(tuple(kept))
    except ScenarioError:  # a star, whose corners all turn in one direction
        return None
    return kept


def cut(area: "shapely.Polygon", extent: float) -> list[Ring] | None:
    """Return the convex pieces of a polygon, counter-clockwise; None if some of its triangles are flat.

    Args:
        area: a valid `shapely.Polygon`, which may have holes.
        extent: extent of the map, in map units.
    """
    triangles = _triangles(area, extent)
    return None if triangles is None else _merged(triangles, extent)


def rounded(area: "shapely.Geometry", extent: float) -> "shapely.Geometry":
    """Return a shapely geometry with corners on a grid so that none lies nearly on another edge.

    Args:
        area: any polygons of shapely.
        extent: extent of the map, in map units.
    """
    import shapely

    farthest = np.abs(area.bounds).max()
    spacing = max(GRID * extent, 4.0 * float(np.spacing(farthest)))
    return shapely.set_precision(area, 2.0 ** math.ceil(math.log2(spacing)))


def _triangles(area: Any, extent: float) -> Floats | None:
    """Return the triangles of a polygon, (n, 3, 2), counter-clockwise; None if one of them is flat."""
    import shapely

    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    triangles: Floats = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3].copy()
    a, b, c = (triangles[:, k] for k in range(3))
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    backward = doubled < 0.0
    triangles[backward] = triangles[backward, ::-1]
    longest = np.max([np.hypot(*(p - q).T) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    if (np.abs(doubled) <= FLAT * extent * longest).any():
        return None
    # Areas in coordinates from a corner: differences of far coordinates are exact, their products are not.
    expected = shapely.transform(area, lambda points: points - triangles[0, 0]).area
    return triangles if abs(np.abs(doubled).sum() / 2.0 - expected) <= SAME_AREA * expected else None


def _merged(triangles: Floats, extent: float) -> list[Ring]:
    """Return the pieces that remain when diagonals are removed, the longest ones first."""
    edges = _Edges(triangles, FLAT * extent)
    for edge in sorted(range(len(edges.origin)), key=lambda edge: (-edges.length(edge), edge)):
        edges.remove(edge)
    return edges.rings()


class _Edges:
    """The directed edges of pieces, each with its piece on the left, in linked lists.

    Attributes:
        origin: point where each edge begins.
        after: edge that follows each one around its piece.
        before: edge before each one.
        twin: edge between the same points in the other direction, with the piece on the other side; None on
            the boundary of the polygon.
        alive: whether each edge is still there.
    """

    def __init__(self, triangles: Floats, flat: float):
        corners = [(x, y) for x, y in triangles.reshape(-1, 2).tolist()]
        numbers = range(len(corners))
        self.origin: Ring = corners
        self.after = [edge + 1 if edge % 3 < 2 else edge - 2 for edge in numbers]
        self.before = [edge - 1 if edge % 3 > 0 else edge + 2 for edge in numbers]
        known = {(corners[edge], corners[self.after[edge]]): edge for edge in numbers}
        self.twin = [known.get((corners[self.after[edge]], corners[edge])) for edge in numbers]
        self.alive = [True] * len(corners)
        self._flat = flat

    def length(self, edge: int) -> float:
        """Return the length of an edge."""
        return math.dist(self.origin[edge], self.origin[self.after[edge]])

    def remove(self, edge: int) -> None:
        """Join the pieces on both sides of an edge if they are convex together."""
        twin = self.twin[edge]
        if twin is None or not self.alive[edge]:
            return
        joints = (self.before[edge], self.after[twin]), (self.before[twin], self.after[edge])
        if not all(self._fit(into, out) for into, out in joints):
            return
        self.alive[edge] = self.alive[twin] = False
        for into, out in joints:
            self._link(into, out)
        for into, out in joints:
            if self._turn(into, out) <= self._flat:
                self.alive[out] = False
                self._link(into, self.after[out])

    def rings(self) -> list[Ring]:
        """Return the corners of all pieces, counter-clockwise."""
        found: list[Ring] = []
        seen = [not alive for alive in self.alive]
        for first in range(len(self.origin)):
            ring: Ring = []
            edge = first
            while not seen[edge]:
                seen[edge] = True
                ring.append(self.origin[edge])
                edge = self.after[edge]
            if ring:
                found.append(ring)
        return found

    def _fit(self, into: int, out: int) -> bool:
        """Return whether two edges may follow each other: in a left turn, or straight along the boundary."""
        turn = self._turn(into, out)
        # A corner inside a straight diagonal must stay, since the pieces on the other side have it.
        on_boundary = self.twin[into] is None and self.twin[out] is None
        return turn > self._flat or (turn >= -self._flat and on_boundary)

    def _turn(self, into: int, out: int) -> float:
        return _height(self.origin[into], self.origin[out], self.origin[self.after[out]])

    def _link(self, into: int, out: int) -> None:
        self.after[into], self.before[out] = out, into


def _height(a: Point, b: Point, c: Point) -> float:
    """Return the distance of a corner b from the line through a and c; it is negative for a right turn."""
    doubled = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    base = math.dist(a, c)
    return doubled / base if base > 0.0 else 0.0


def _is_straight(a: Point, b: Point, c: Point, flat: float) -> bool:
    """Return whether b lies between a and c."""
    along = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])
    return along > 0.0 and abs(_height(a, b, c)) <= flat
