"""How far a segment of a path must be shifted along y' to clear an obstacle.

Source: SPSFA paper, section II; closed forms and the reading of the degree of collision in
docs/readings.md. A segment is y'(t) = y0 + slope * t for t in [0, spacing], t measured from its left end.

All functions here return the smallest shift of the whole segment along +y' and along -y', in map units.
Segment and obstacle are in contact if and only if both are positive; where one is not, neither has a meaning.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel
from swarm_gym.problem.waypoints import WaypointTable


@inlined_kernel
def circle_shifts(
    x: float,
    y: float,
    radius: float,
    begin: float,
    end: float,
    y0: float,
    slope: float,
    cosine: float,
) -> tuple[float, float]:
    """Shifts that clear a circle.

    Args:
        x: t of its centre.
        y: y' of its centre.
        radius: its radius.
        begin: where the overlap of the x' extents begins, relative to the centre.
        end: where it ends.
        y0: y' of the segment's left end.
        slope: slope of the segment.
        cosine: 1 / sqrt(1 + slope^2).
    """
    height = y - (y0 + slope * x)
    if height * height >= radius * radius * (1.0 + slope * slope):
        return -1.0, -1.0  # the line of the segment misses the circle
    touch = radius * slope * cosine  # where the tangent of the circle has the segment's slope
    u = min(max(-touch, begin), end)
    v = min(max(touch, begin), end)
    up = y + math.sqrt(radius * radius - u * u) - (y0 + slope * (x + u))
    down = (y0 + slope * (x + v)) - (y - math.sqrt(radius * radius - v * v))
    return up, down


@inlined_kernel
def polygon_shifts(
    corner: NDArray[np.float64], first: int, stop: int, y0: float, slope: float
) -> tuple[float, float]:
    """Shifts that clear a convex polygon.

    Its top is concave and its bottom convex, so each differs most from a line at a corner or at an end of
    the overlap: rows first to stop - 1 of `corner`, shape (Q, 3), hold t, top and bottom there.
    """
    up, down = -math.inf, -math.inf
    for k in range(first, stop):
        height = y0 + slope * corner[k, 0]
        up = max(up, corner[k, 1] - height)
        down = max(down, height - corner[k, 2])
    return up, down


@inlined_kernel
def clearing_shifts(
    table: WaypointTable, pair: int, y0: float, slope: float, cosine: float
) -> tuple[float, float]:
    """Shifts of the segment of a tabulated pair that clear the obstacle of that pair."""
    first, stop = table.first_corner[pair], table.first_corner[pair + 1]
    if first < stop:
        return polygon_shifts(table.corner, first, stop, y0, slope)
    return circle_shifts(
        table.pair_circle[pair, 0],
        table.pair_circle[pair, 1],
        table.pair_circle[pair, 2],
        table.pair_circle[pair, 3],
        table.pair_circle[pair, 4],
        y0,
        slope,
        cosine,
    )


@inlined_kernel
def segment_collision(table: WaypointTable, segment: int, left: float, right: float, length: float) -> float:
    """Degree of collision of one segment with all obstacles, in map units.

    For each obstacle in contact it is the distance between the segment and its nearer cleared parallel: the
    smaller shift times the cosine of the slope.

    Args:
        table: the problem.
        segment: its number, 0 to n.
        left: y' of its left end.
        right: y' of its right end.
        length: its length.
    """
    collision = 0.0
    low, high = min(left, right), max(left, right)
    for pair in range(table.first_pair[segment], table.first_pair[segment + 1]):
        if low < table.pair_top[pair] and high > table.pair_bottom[pair]:
            slope = (right - left) / table.spacing
            cosine = table.spacing / length
            up, down = clearing_shifts(table, pair, left, slope, cosine)
            if up > 0.0 and down > 0.0:
                collision += min(up, down) * cosine
    return collision
