"""Seams: thin obstacles over edges that two polygons share, so that no path leads between the two.

An obstacle is an open set: a path may run along its edge. Where two polygons lie on the two sides of one
edge, that edge is inside their union. A path along it would pass through both. A seam closes such an edge: a
quadrilateral with the edge as a diagonal, whose other two corners lie inside the polygons. With the seams of
all shared edges, a path that enters no obstacle stays out of the interior of the union.

Obstacles that touch in a single point have no edge in common. A path may pass through such a point, which is
on the boundary of the union.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios.obstacles import Obstacle, Polygon

Floats = NDArray[np.float64]

# Height of a seam over its edge, as a share of the way from the middle of the edge through the polygon.
HEIGHT = 0.5
# Number of edges that are compared with all others at once.
ROWS = 256


@lru_cache(maxsize=256)  # robots that drive begin anew on the same obstacles
def seams_of(obstacles: tuple[Obstacle, ...], tolerance: float) -> tuple[Polygon, ...]:
    """Return a seam for each stretch of an edge that two polygons share.

    Args:
        obstacles: obstacles in map units; circles share no edges.
        tolerance: largest distance between two edges that count as one, in map units. A seam is longer than
            that, too.
    """
    polygons = [obstacle for obstacle in obstacles if isinstance(obstacle, Polygon)]
    if len(polygons) < 2:
        return ()
    begins = np.array([vertex for polygon in polygons for vertex in polygon.vertices])
    ends = np.array([vertex for polygon in polygons for _, vertex in polygon.edges()])
    owners = np.repeat(np.arange(len(polygons)), [len(polygon.vertices) for polygon in polygons])
    found = []
    for first in range(0, len(begins), ROWS):
        for one, other in _facing(begins, ends, owners, first, tolerance):
            shared = _shared_stretch(begins[one], ends[one], begins[other], ends[other], tolerance)
            if shared is not None:
                seam = _seam(*shared, polygons[owners[one]], polygons[owners[other]])
                if seam is not None:
                    found.append(seam)
    return tuple(found)


def _facing(
    begins: Floats, ends: Floats, owners: NDArray[np.int64], first: int, tolerance: float
) -> list[tuple[int, int]]:
    """Return pairs of edges that may share a part: one from `first` to `first` + `ROWS` - 1, one behind it.

    Polygons are counter-clockwise, so that a shared edge has opposite directions in its two polygons.
    """
    rows = slice(first, first + ROWS)
    low, high = np.minimum(begins, ends) - tolerance, np.maximum(begins, ends) + tolerance
    near = ((low[rows, None] <= high) & (low <= high[rows, None])).all(axis=-1)
    near &= owners[rows, None] < owners
    along = ends - begins
    near &= (along[rows, None] * along).sum(axis=-1) < 0.0
    return [(int(one) + first, int(other)) for one, other in np.argwhere(near)]


def _shared_stretch(
    begin: Floats, end: Floats, other_begin: Floats, other_end: Floats, tolerance: float
) -> tuple[Floats, Floats] | None:
    """Return the ends, (2,) each, of the part that two opposite edges share; None if they share nothing."""
    length = float(np.hypot(*(end - begin)))
    along = (end - begin) / length
    across = np.array([-along[1], along[0]])
    first, last = float(along @ (other_end - begin)), float(along @ (other_begin - begin))
    low, high = max(first, 0.0), min(last, length)
    if high - low <= tolerance:
        return None
    heights = float(across @ (other_end - begin)), float(across @ (other_begin - begin))
    if any(abs(np.interp(at, (first, last), heights)) > tolerance for at in (low, high)):
        return None
    return begin + low * along, begin + high * along


def _seam(begin: Floats, end: Floats, left: Polygon, right: Polygon) -> Polygon | None:
    """Return the seam over a stretch between a polygon on its left and one on its right.

    None if one of the polygons is too thin for a seam that floating-point numbers hold.
    """
    middle = (begin + end) / 2.0
    across = np.array([begin[1] - end[1], end[0] - begin[0]]) / np.hypot(*(end - begin))
    above = middle + HEIGHT * _way_through(left, middle, across) * across
    below = middle - HEIGHT * _way_through(right, middle, -across) * across
    corners = tuple((float(x), float(y)) for x, y in (begin, below, end, above))
    return Polygon(corners) if _is_convex(corners) else None


def _way_through(polygon: Polygon, point: Floats, direction: Floats) -> float:
    """Return how far a point on the edge of a polygon may move in a direction until it leaves the polygon."""
    begins = np.array(polygon.vertices)
    edges = np.roll(begins, -1, axis=0) - begins
    depths = edges[:, 0] * (point - begins)[:, 1] - edges[:, 1] * (point - begins)[:, 0]
    approach = edges[:, 1] * direction[0] - edges[:, 0] * direction[1]
    leaves = approach > 0.0
    return max(float((depths[leaves] / approach[leaves]).min()), 0.0)


def _is_convex(corners: tuple[tuple[float, float], ...]) -> bool:
    points = np.array(corners)
    edges = np.roll(points, -1, axis=0) - points
    following = np.roll(edges, -1, axis=0)
    return bool((edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0] > 0.0).all())
