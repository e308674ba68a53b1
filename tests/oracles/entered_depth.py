"""The depth to which a polyline enters a union of polygons and discs, by shapely and NumPy alone.

Points are complex numbers. A segment is cut where it meets an edge of the union, so that each piece lies
inside or outside as a whole. The depth of a point inside is its distance from the edges.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely

TOLERANCE = 1e-10  # depth that counts as touching, as a share of the extent
PRECISION = 1e-13  # of depths, as a share of the extent
NO_DISCS = np.empty((0, 3))
LARGEST_TABLE = 2**21  # pairs of a segment and an edge that are held at once


@dataclass(frozen=True, eq=False)
class Blocked:
    """Everything that a robot must not enter.

    Attributes:
        area: the closed union of all polygons; it may be empty. Its interior is blocked.
        discs: (k, 3) centres and radii of discs, whose interior is blocked.
        radius: radius of the robot, by which area and discs grow.
        box: (x_min, y_min, x_max, y_max) that the centre of the robot must not leave, or None.
        pinches: (k, 4) corners x, y where two parts of the area touch, and the signs of the directions x and
            y of a free quarter there. No path passes from a quarter to another one. Other corners that
            touch are open.
    """

    area: shapely.Geometry
    discs: np.ndarray = field(default_factory=lambda: NO_DISCS)
    radius: float = 0.0
    box: tuple[float, float, float, float] | None = None
    pinches: np.ndarray = field(default_factory=lambda: np.empty((0, 4)))

    def __post_init__(self):
        shapely.prepare(self.area)
        shapely.prepare(self.outline)

    @cached_property
    def outline(self):
        """The boundary of the area."""
        return shapely.boundary(self.area)

    @cached_property
    def edges(self):
        """Begins and ends of the edges, with the inside on the left."""
        rings = shapely.get_rings(shapely.orient_polygons(shapely.get_parts(self.area)))
        corners = [_complex(shapely.get_coordinates(ring)) for ring in rings]
        begins, ends = ([c[:-1] for c in corners], [c[1:] for c in corners])
        return (np.concatenate([*begins, []]).astype(complex), np.concatenate([*ends, []]).astype(complex))

    @cached_property
    def extent(self):
        """The larger side of the box around everything, without the growth."""
        (x0, y0), (x1, y1) = self.around
        return float(max(x1 - x0, y1 - y0))

    @property
    def tolerance(self):
        """Depth that counts as touching."""
        return TOLERANCE * self.extent

    @property
    def grown_discs(self):
        """Centres and radii of the grown discs."""
        return _complex(self.discs[:, :2]), self.discs[:, 2] + self.radius

    def points_inside(self, points):
        """Return which points lie deeper inside the grown union than the tolerance, or outside the box."""
        points = np.asarray(points, dtype=complex)
        x, y, tolerance = points.real, points.imag, self.tolerance
        if self.radius > 0.0:
            inside = shapely.distance(self.area, shapely.points(x, y)) < self.radius - tolerance
        else:
            inside = shapely.contains_xy(self.area, x, y)
            inside[inside] = shapely.distance(self.outline, shapely.points(x[inside], y[inside])) > tolerance
        for centre, radius in zip(*self.grown_discs, strict=True):
            inside |= np.abs(points - centre) < radius - tolerance
        if self.box is not None:
            x0, y0, x1, y1 = self.box
            inside |= (
                (x < x0 - tolerance) | (x > x1 + tolerance) | (y < y0 - tolerance) | (y > y1 + tolerance)
            )
        return inside

    def segments_inside(self, begins, ends):
        """Return which segments enter the grown union deeper than the tolerance, or leave the box."""
        inside = (
            self.points_inside(begins) | self.points_inside(ends) | self.points_inside((begins + ends) / 2)
        )
        for centre, radius in zip(*self.grown_discs, strict=True):
            inside |= _distances(np.array([centre]), begins, ends)[0] < radius - self.tolerance
        left = np.flatnonzero(~inside)
        if self.radius > 0.0:
            lines = _lines(begins[left], ends[left])
            inside[left] = shapely.distance(self.area, lines) < self.radius - self.tolerance
            return inside
        for chunk in np.array_split(left, 1 + len(left) * len(self.edges[0]) // LARGEST_TABLE):
            owners, first, last = self.pieces(begins[chunk], ends[chunk])
            deep = self.points_inside((first + last) / 2)
            inside[chunk[owners[deep]]] = True
        return inside

    def pieces(self, begins, ends):
        """Return pieces of segments between edges of the area: the segment of each, its begin and its end."""
        if not len(begins):
            return np.empty(0, dtype=int), begins, ends
        steps = ends - begins
        at = _cuts(begins, steps, *self.edges, self.tolerance)
        owners, k = np.nonzero(np.diff(at, axis=1) * np.abs(steps)[:, None] > PRECISION * self.extent)
        first, last = (begins[owners] + at[owners, k + j] * steps[owners] for j in (0, 1))
        return owners, first, last

    @cached_property
    def around(self):
        """Least and largest x and y of everything, without the growth."""
        points = [shapely.get_coordinates(self.area)]
        points += [self.discs[:, :2] + sign * self.discs[:, 2:] for sign in (-1.0, 1.0)]
        every = np.concatenate(points)
        return every.min(axis=0), every.max(axis=0)


def entered_depth(blocked, path):
    """Return how deep a polyline, (k, 2), enters the grown union; 0 if it does not.

    The depth counts from the boundary of the polygons' union, and from that of every single disc.
    """
    corners = _complex(np.asarray(path, dtype=np.float64))
    corners = corners[np.concatenate([[True], corners[1:] != corners[:-1]])]
    begins, ends = corners[:-1], corners[1:]
    deepest = 0.0
    for centre, radius in zip(*blocked.grown_discs, strict=True):
        deepest = max(deepest, radius - _distances(np.array([centre]), begins, ends).min())
    if blocked.area.is_empty:
        return float(deepest)
    _, first, last = blocked.pieces(begins, ends)
    middle = (first + last) / 2
    inside = shapely.contains_xy(blocked.area, middle.real, middle.imag)
    if inside.any():
        depth = _deepest(first[inside], last[inside], *blocked.edges, PRECISION * blocked.extent)
        deepest = max(deepest, blocked.radius + depth)
    if blocked.radius > 0.0:
        gap = shapely.distance(
            blocked.area, shapely.LineString(np.stack([corners.real, corners.imag], axis=-1))
        )
        deepest = max(deepest, blocked.radius - gap)
    return float(deepest)


def _deepest(begins, ends, from_corners, to_corners, precision):
    """Return the largest distance from the edges along segments, by branch and bound.

    The distance from one edge is convex along a segment. So on an interval it is at most the larger of the
    distances at the ends. The least of these bounds holds for the distance from all edges.
    """
    best = 0.0
    while len(begins):
        at_begins = _distances(begins, from_corners, to_corners)
        at_ends = _distances(ends, from_corners, to_corners)
        middle = (begins + ends) / 2
        in_middle = _distances(middle, from_corners, to_corners)
        best = max(best, *(d.min(axis=1).max() for d in (at_begins, at_ends, in_middle)))
        going = np.maximum(at_begins, at_ends).min(axis=1) > best + precision
        begins, middle, ends = begins[going], middle[going], ends[going]
        begins, ends = np.concatenate([begins, middle]), np.concatenate([middle, ends])
    return best


def _cuts(begins, steps, from_corners, to_corners, tolerance):
    """Return where along each segment the edges cross it or have a corner on it, sorted, in [0, 1]."""
    steps, offsets = steps[:, None], from_corners - begins[:, None]
    edges = to_corners - from_corners
    span = _cross(steps, edges)
    crossing = np.abs(span) > 1e-14 * np.abs(steps) * np.abs(edges)
    span = np.where(crossing, span, 1.0)
    along_edge = _cross(offsets, steps) / span
    slack = tolerance / np.abs(edges)
    crossing &= (along_edge >= -slack) & (along_edge <= 1.0 + slack)
    at_edges = np.where(crossing, _cross(offsets, edges) / span, 1.0)
    share = (offsets * steps.conj()).real / np.maximum(np.abs(steps) ** 2, np.finfo(float).tiny)
    at_corners = np.where(np.abs(offsets - share * steps) <= tolerance, share, 1.0)
    limits = np.tile([0.0, 1.0], (len(begins), 1))
    return np.sort(np.clip(np.concatenate([limits, at_edges, at_corners], axis=1), 0.0, 1.0), axis=1)


def _distances(points, begins, ends):
    """Return the distances of points, (n,), from segments, (m,), as (n, m)."""
    steps, offsets = ends - begins, points[:, None] - begins
    squares = np.maximum(np.abs(steps) ** 2, np.finfo(float).tiny)
    share = np.clip((offsets * steps.conj()).real / squares, 0.0, 1.0)
    return np.abs(offsets - share * steps)


def _cross(a, b):
    return a.real * b.imag - a.imag * b.real


def _complex(points):
    return points[:, 0] + 1j * points[:, 1]


def _lines(begins, ends):
    return shapely.linestrings(
        np.stack([begins.real, begins.imag, ends.real, ends.imag], axis=-1).reshape(-1, 2, 2)
    )
