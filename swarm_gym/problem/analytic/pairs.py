"""Pairs of a segment of a waypoint path and an obstacle that it can touch, and their geometry.

Source: SPSFA paper, section II. Waypoints are evenly spaced on the x' axis, so the x' extent of a segment
never changes. The pairs whose extents overlap are known beforehand.
"""

import math
from itertools import pairwise
from typing import NamedTuple

from swarm_gym.problem.geometry.rotated_axes import RotatedAxes
from swarm_gym.scenarios import Circle, Obstacle, Point, Scenario

# Extents in x' that overlap by no more (map units) only touch: an edge on the line of a waypoint stays there
# when the rotation rounds.
OVERLAP_TOLERANCE = 1e-9

# An obstacle in coordinates (x', y'): a circle, or the vertices of a polygon. Since the rotation rounds, the
# polygon need not be strictly convex any more.
Shape = Circle | list[Point]


class Pair(NamedTuple):
    """A segment and an obstacle over it; x' relative to the segment's left end, in map units."""

    segment: int
    bottom: float  # extent in y' of the obstacle over the overlap
    top: float
    # x' and y' of the centre, radius, and x' of both ends of the overlap, less x' of the centre.
    circle: tuple[float, float, float, float, float] | None
    corners: tuple[tuple[float, float, float], ...]  # x', top and bottom of a polygon's corners


def rotated_shapes(scenario: Scenario) -> list[Shape]:
    """Return the solids of a scenario in coordinates (x', y')."""
    axes = RotatedAxes.of(scenario)
    return [_rotated(obstacle, axes) for obstacle in scenario.solids]


def extent_of_all(shapes: list[Shape]) -> tuple[float, float]:
    """Return the least and the largest y' of all shapes; unbounded without any."""
    lows, highs = [], []
    for shape in shapes:
        if isinstance(shape, Circle):
            lows.append(shape.y - shape.radius)
            highs.append(shape.y + shape.radius)
        else:
            lows.append(min(y for _, y in shape))
            highs.append(max(y for _, y in shape))
    return min(lows, default=-math.inf), max(highs, default=math.inf)


def list_pairs(shapes: list[Shape], num_segments: int, spacing: float) -> list[Pair]:
    """Return all pairs, ordered by segment and then as the shapes."""
    pairs = []
    for segment in range(num_segments):
        left, right = segment * spacing, (segment + 1) * spacing
        for shape in shapes:
            pair = (
                _with_circle(shape, segment, left, right)
                if isinstance(shape, Circle)
                else _with_polygon(shape, segment, left, right)
            )
            if pair is not None:
                pairs.append(pair)
    return pairs


def _rotated(obstacle: Obstacle, axes: RotatedAxes) -> Shape:
    if isinstance(obstacle, Circle):
        return Circle(*axes.from_map((obstacle.x, obstacle.y)), obstacle.radius)
    return [axes.from_map(vertex) for vertex in obstacle.vertices]


def _with_circle(circle: Circle, segment: int, left: float, right: float) -> Pair | None:
    x, y, radius = circle.x, circle.y, circle.radius
    begin, end = max(left, x - radius), min(right, x + radius)
    if end - begin <= OVERLAP_TOLERANCE:
        return None
    nearest = min(max(x, begin), end) - x
    height = math.sqrt(max(radius**2 - nearest**2, 0.0))
    # Clamped, since (x - radius) - x may be a last bit outside the circle.
    overlap = (max(begin - x, -radius), min(end - x, radius))
    return Pair(segment, y - height, y + height, (x - left, y, radius, *overlap), ())


def _with_polygon(vertices: list[Point], segment: int, left: float, right: float) -> Pair | None:
    xs = [x for x, _ in vertices]
    begin, end = max(left, min(xs)), min(right, max(xs))
    if end - begin <= OVERLAP_TOLERANCE:
        return None
    # Top is concave and bottom convex: both differ most from a line at a break or an end.
    breaks = sorted({begin, end, *(x for x in xs if begin < x < end)})
    corners = tuple((x - left, *_top_and_bottom(vertices, x)) for x in breaks)
    bottom, top = min(bottom for _, _, bottom in corners), max(top for _, top, _ in corners)
    return Pair(segment, bottom, top, None, corners)


def _top_and_bottom(vertices: list[Point], x: float) -> tuple[float, float]:
    """Return the largest and the smallest y of a polygon at an x inside its extent."""
    heights = []
    for (x0, y0), (x1, y1) in pairwise([*vertices, vertices[0]]):
        if x0 == x1:
            if x == x0:
                heights += [y0, y1]
        elif min(x0, x1) <= x <= max(x0, x1):
            heights.append(y0 + (y1 - y0) * ((x - x0) / (x1 - x0)))
    return max(heights), min(heights)
