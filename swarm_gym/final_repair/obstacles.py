"""Circles and convex polygons as arrays: how deep segments enter them, and paths pushed out of them.

A segment that enters a convex obstacle is separated from it by the least shift along one of a few directions.
For a circle, the direction leads from its centre to the nearest point of the segment. For a polygon, the
directions are the normals of its edges and of the segment (the separating axis theorem).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.scenarios import Circle, Scenario

Floats = NDArray[np.float64]

# Depth, in map units, up to which a segment counts as clear: far below what scenarios call touching.
CLEAR = 1e-9
# Distance from an obstacle to which paths are pushed, in map units.
MARGIN = 1e-6
# Largest ratio of the move of a point to the depth of a segment, where the segment's other end cannot move.
LARGEST_MOVE = 20.0


class Obstacles(NamedTuple):
    """The obstacles of a scenario."""

    circles: Floats  # (n, 3) centre and radius
    vertices: Floats  # (m, 2) vertices of all polygons, each counter-clockwise
    first: NDArray[np.int64]  # (polygons + 1,) index of each polygon's first vertex, and m


class Contact(NamedTuple):
    """The least shift by which a segment leaves an obstacle that it enters."""

    depth: float  # length of the shift; not positive if the segment is clear
    share: float  # where the segment is to be shifted: 0 at its first end, 1 at the other
    x: float  # direction of the shift, a unit vector
    y: float


def obstacles_of(scenario: Scenario) -> Obstacles:
    """Return the solids of a scenario as arrays."""
    circles = [(o.x, o.y, o.radius) for o in scenario.solids if isinstance(o, Circle)]
    polygons = [np.array(o.vertices) for o in scenario.solids if not isinstance(o, Circle)]
    return Obstacles(
        np.array(circles, dtype=np.float64).reshape(-1, 3),
        np.concatenate([np.empty((0, 2)), *polygons]),
        np.cumsum([0, *map(len, polygons)]),
    )


@kernel
def contact_with_circle(circles: Floats, i: int, x0: float, y0: float, x1: float, y1: float) -> Contact:
    """Return the contact of a segment with circle `i`."""
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(max(((circles[i, 0] - x0) * dx + (circles[i, 1] - y0) * dy) / square, 0.0), 1.0)
    away_x, away_y = x0 + share * dx - circles[i, 0], y0 + share * dy - circles[i, 1]
    distance = math.hypot(away_x, away_y)
    if distance > 0.0:
        return Contact(circles[i, 2] - distance, share, away_x / distance, away_y / distance)
    length = math.sqrt(square)
    if length > 0.0:  # straight through the centre: to the left
        return Contact(circles[i, 2], share, -dy / length, dx / length)
    return Contact(circles[i, 2], share, 1.0, 0.0)


@kernel
def contact_with_polygon(
    vertices: Floats, first: int, end: int, x0: float, y0: float, x1: float, y1: float
) -> Contact:
    """Return the contact of a segment with the polygon of vertices `first` to `end` - 1."""
    best = Contact(math.inf, 0.0, 1.0, 0.0)
    for k in range(first, end):
        following = k + 1 if k + 1 < end else first
        x, y = vertices[k, 0], vertices[k, 1]
        edge_x, edge_y = vertices[following, 0] - x, vertices[following, 1] - y
        length = math.hypot(edge_x, edge_y)
        out_x, out_y = edge_y / length, -edge_x / length
        inside, other = -((x0 - x) * out_x + (y0 - y) * out_y), -((x1 - x) * out_x + (y1 - y) * out_y)
        depth = max(inside, other)
        if depth < best.depth:
            best = Contact(depth, 0.0 if inside >= other else 1.0, out_x, out_y)
    length = math.hypot(x1 - x0, y1 - y0)
    if length > 0.0 and best.depth > 0.0:
        along_x, along_y = (x1 - x0) / length, (y1 - y0) / length
        for side in (1.0, -1.0):
            out_x, out_y = -along_y * side, along_x * side
            depth, share = -math.inf, 0.0
            for k in range(first, end):
                to_x, to_y = vertices[k, 0] - x0, vertices[k, 1] - y0
                reach = to_x * out_x + to_y * out_y
                if reach > depth:
                    depth = reach
                    share = min(max((to_x * along_x + to_y * along_y) / length, 0.0), 1.0)
            if depth < best.depth:
                best = Contact(depth, share, out_x, out_y)
    return best


@kernel
def contact(obstacles: Obstacles, i: int, x0: float, y0: float, x1: float, y1: float) -> Contact:
    """Return the contact of a segment with obstacle `i`, counted over circles and then polygons."""
    num_circles = obstacles.circles.shape[0]
    if i < num_circles:
        return contact_with_circle(obstacles.circles, i, x0, y0, x1, y1)
    first, end = obstacles.first[i - num_circles], obstacles.first[i - num_circles + 1]
    return contact_with_polygon(obstacles.vertices, first, end, x0, y0, x1, y1)


@kernel
def number_of(obstacles: Obstacles) -> int:
    """Return the number of obstacles."""
    return obstacles.circles.shape[0] + obstacles.first.shape[0] - 1


@entry
def push_out(obstacles: Obstacles, path: Floats, most_sweeps: int) -> int:
    """Push a path, (k, 2), out of obstacles by small shifts, in place; its ends stay.

    Each sweep goes over all segments and obstacles. A segment that enters one is shifted to `MARGIN` outside
    it by moving its ends as little as possible.

    Returns:
        The number of sweeps, of which the last one found nothing to push; or `most_sweeps` + 1 if none did.
    """
    last = path.shape[0] - 1
    for sweep in range(1, most_sweeps + 1):
        pushed = False
        for s in range(last):
            for i in range(number_of(obstacles)):
                found = contact(obstacles, i, path[s, 0], path[s, 1], path[s + 1, 0], path[s + 1, 1])
                if found.depth > CLEAR:
                    pushed = True
                    _shift(path, s, found)
        if not pushed:
            return sweep
    return most_sweeps + 1


@kernel
def _shift(path: Floats, s: int, found: Contact) -> None:
    """Move the ends of segment `s`, but not the ends of the path, so that it leaves an obstacle."""
    first = 1.0 - found.share if s > 0 else 0.0
    second = found.share if s + 1 < path.shape[0] - 1 else 0.0
    weight = max(first * first + second * second, 1.0 / LARGEST_MOVE**2)
    move = (found.depth + MARGIN) / weight
    path[s, 0] += first * move * found.x
    path[s, 1] += first * move * found.y
    path[s + 1, 0] += second * move * found.x
    path[s + 1, 1] += second * move * found.y
