"""Which obstacle can touch which segment of a waypoint path, and the geometry of each such pair.

Source: SPSFA paper, section II. Waypoints are evenly spaced on the x' axis, so the x' extent of a segment
never changes: the pairs whose extents overlap are known beforehand.
"""

import math
from itertools import pairwise
from typing import NamedTuple

from swarm_gym.problem.geometry.rotation import Frame
from swarm_gym.scenarios import Circle, Obstacle, Point, Scenario

# Extents in x' that overlap by no more (map units) only touch: an edge on the line of a waypoint stays there
# when the rotation rounds.
OVERLAP_TOLERANCE = 1e-9

# An obstacle in the frame: a circle, or the vertices of a polygon. The latter need not be strictly convex any
# more, since the rotation rounds.
Shape = Circle | list[Point]


class Pair(NamedTuple):
    """A segment and an obstacle over it; x' relative to the segment's left end, in map units."""

    segment: int
    bottom: float  # extent in y' of the obstacle over the overlap
    top: float
    circle: tuple[float, float, float, float, float] | None  # centre x', y', radius, overlap less the centre
    corners: tuple[tuple[float, float, float], ...]  # of a polygon: x', top and bottom there


def shapes_in_frame(scenario: Scenario) -> list[Shape]:
    """The obstacles of a scenario in its frame."""
    frame = Frame.of(scenario)
    return [_in_frame(obstacle, frame) for obstacle in scenario.obstacles]


def extent_of_all(shapes: list[Shape]) -> tuple[float, float]:
    """The extent in y' of all shapes; unbounded without any."""
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
    """All pairs, by segment and then in the order of the shapes."""
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


def _in_frame(obstacle: Obstacle, frame: Frame) -> Shape:
    if isinstance(obstacle, Circle):
        return Circle(*frame.from_map((obstacle.x, obstacle.y)), obstacle.radius)
    return [frame.from_map(vertex) for vertex in obstacle.vertices]


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
    """Largest and smallest y of a polygon at x inside its x extent."""
    heights = []
    for (x0, y0), (x1, y1) in pairwise([*vertices, vertices[0]]):
        if x0 == x1:
            if x == x0:
                heights += [y0, y1]
        elif min(x0, x1) <= x <= max(x0, x1):
            heights.append(y0 + (y1 - y0) * ((x - x0) / (x1 - x0)))
    return max(heights), min(heights)
