"""Whether a polyline keeps clear of circles and convex polygons, exactly; on grid maps `traversal` tells."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import Circle, Obstacle, Polygon
from swarm_gym.scenarios.scenario import TOUCHING

Floats = NDArray[np.float64]


def is_clear(points: Floats, obstacles: Iterable[Obstacle]) -> bool:
    """Whether a polyline, (k, 2) in map coordinates, enters no obstacle; it may touch them (`TOUCHING`)."""
    begins, ways = points[:-1], np.diff(points, axis=0)
    return not any(
        _enters_disc(begins, ways, obstacle)
        if isinstance(obstacle, Circle)
        else _enters_polygon(begins, ways, obstacle)
        for obstacle in obstacles
    )


def _enters_disc(begins: Floats, ways: Floats, circle: Circle) -> bool:
    """Whether one of the segments, given by begins and ways, (k, 2) each, comes closer than the radius."""
    to_centre = (circle.x, circle.y) - begins
    squares = (ways**2).sum(axis=1)
    along = (to_centre * ways).sum(axis=1)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    nearest = to_centre - share[:, None] * ways
    return bool((circle.radius - np.hypot(*nearest.T) > TOUCHING).any())


def _enters_polygon(begins: Floats, ways: Floats, polygon: Polygon) -> bool:
    """The same of a polygon: what is left of a segment, clipped by one side after the other."""
    first, last = np.zeros(len(ways)), np.ones(len(ways))
    for (x0, y0), (x1, y1) in polygon.edges():
        normal = np.array([y0 - y1, x1 - x0]) / np.hypot(x1 - x0, y1 - y0)  # to the inside
        depth = ((begins - (x0, y0)) * normal).sum(axis=1) - TOUCHING
        change = (ways * normal).sum(axis=1)
        crossing = np.divide(-depth, change, out=np.zeros_like(depth), where=change != 0.0)
        first = np.where(change > 0.0, np.maximum(first, crossing), first)
        last = np.where(change < 0.0, np.minimum(last, crossing), last)
        last = np.where((change == 0.0) & (depth <= 0.0), -1.0, last)
    return bool((first < last).any())
