"""Polylines: length, evenly spaced points, and an exact test of clearance.

The test says whether a polyline keeps clear of circles and convex polygons; `traversal` has the test for grid
maps.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import interpolate
from swarm_gym.scenarios import Circle, Obstacle, Polygon

Floats = NDArray[np.float64]


def length_of(path: Floats) -> float:
    """Return the length of a polyline, (k, 2)."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def evenly_spaced(path: Floats, number: int) -> Floats:
    """Return points at even distances along a polyline, (k, 2), as (number, 2)."""
    ends = np.concatenate([[0.0], np.cumsum(np.sqrt(np.square(np.diff(path, axis=0)).sum(axis=1)))])
    at = np.linspace(0.0, ends[-1], number)
    return np.stack([interpolate(at, ends, coordinates) for coordinates in path.T], axis=-1)


def is_clear(points: Floats, obstacles: Iterable[Obstacle], tolerance: float) -> bool:
    """Return whether a polyline, (k, 2) in map coordinates, enters no obstacle by more than a tolerance."""
    begins, changes = points[:-1], np.diff(points, axis=0)
    return not any(
        _enters_disc(begins, changes, obstacle, tolerance)
        if isinstance(obstacle, Circle)
        else _enters_polygon(begins, changes, obstacle, tolerance)
        for obstacle in obstacles
    )


def _enters_disc(begins: Floats, changes: Floats, circle: Circle, tolerance: float) -> bool:
    """Return whether a segment comes closer to the centre than the radius less a tolerance.

    `begins` and `changes`, (k, 2) each, are the first ends of the segments and the vectors to the others.
    """
    to_centre = (circle.x, circle.y) - begins
    squares = (changes**2).sum(axis=1)
    along = (to_centre * changes).sum(axis=1)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    nearest = to_centre - share[:, None] * changes
    return bool((circle.radius - np.hypot(*nearest.T) > tolerance).any())


def _enters_polygon(begins: Floats, changes: Floats, polygon: Polygon, tolerance: float) -> bool:
    """Return whether anything is left of a segment after every side of the polygon has clipped it."""
    first, last = np.zeros(len(changes)), np.ones(len(changes))
    for (x0, y0), (x1, y1) in polygon.edges():
        normal = np.array([y0 - y1, x1 - x0]) / np.hypot(x1 - x0, y1 - y0)  # to the inside
        depth = ((begins - (x0, y0)) * normal).sum(axis=1) - tolerance
        change = (changes * normal).sum(axis=1)
        crossing = np.divide(-depth, change, out=np.zeros_like(depth), where=change != 0.0)
        first = np.where(change > 0.0, np.maximum(first, crossing), first)
        last = np.where(change < 0.0, np.minimum(last, crossing), last)
        last = np.where((change == 0.0) & (depth <= 0.0), -1.0, last)
    return bool((first < last).any())
