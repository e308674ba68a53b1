"""The waypoint encoding: a path as offsets from the line between start and target.

Source: SPSFA paper, section II, eq. 1. The map is rotated so that the start is the origin and the line to
the target the x' axis. `num_waypoints` waypoints stand evenly spaced on that axis; a decision vector holds
their offsets y'. Since the spacing never changes, which obstacles can touch which segment is known
beforehand: those pairs are tabulated here once, for the kernels of `collision`, `cost` and `repair`.

`num_waypoints` is not printed in the paper; see docs/readings.md.
"""

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.jit import kernel
from swarm_gym.scenarios import Circle, Obstacle, Point, Scenario

# Extents in x' that overlap by no more (map units) only touch: an edge on the line of a waypoint stays there
# when the rotation rounds.
OVERLAP_TOLERANCE = 1e-9

# An obstacle in the frame: a circle, or the vertices of a polygon. The latter need not be strictly convex any
# more, since the rotation rounds.
_Shape = Circle | list[Point]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Frame(NamedTuple):
    """The rotated map of eq. 1: its origin is the start, its x' axis points to the target."""

    origin: Point
    cosine: float
    sine: float

    @classmethod
    def of(cls, scenario: Scenario) -> "Frame":
        """The frame in which the scenario's start-target line is the x' axis."""
        length = scenario.straight_line
        return cls(
            scenario.start,
            (scenario.target[0] - scenario.start[0]) / length,
            (scenario.target[1] - scenario.start[1]) / length,
        )

    def from_map(self, point: Point) -> Point:
        """Map coordinates to (x', y')."""
        x, y = point[0] - self.origin[0], point[1] - self.origin[1]
        return x * self.cosine + y * self.sine, y * self.cosine - x * self.sine

    def to_map(self, x: Floats, y: Floats) -> Floats:
        """Coordinates (x', y'), arrays of one shape, to map coordinates, shape (..., 2)."""
        return np.stack(
            [
                self.origin[0] + x * self.cosine - y * self.sine,
                self.origin[1] + x * self.sine + y * self.cosine,
            ],
            axis=-1,
        )


class WaypointTable(NamedTuple):
    """What the kernels need of one problem, with n waypoints, P pairs and Q corner points.

    A pair is a segment (0..n) and an obstacle whose x' extents overlap. Its geometry is given relative to
    the left end of the segment. A polygon is the list of the corner points inside the overlap; a circle
    has an empty list. In a stacked table every field has a leading problem axis.
    """

    spacing: Any  # x' distance between waypoints: a number, in a stacked table an array
    length_weight: Any  # mu, likewise
    lower: Floats  # (n,) bounds of the offsets: the workspace
    upper: Floats  # (n,)
    initial_lower: Floats  # (n,) where the first population is drawn
    initial_upper: Floats  # (n,)
    first_pair: Integers  # (n + 2,) pairs of segment j: first_pair[j] .. first_pair[j + 1] - 1
    pair_bottom: Floats  # (P,) extent in y' of the obstacle over the overlap
    pair_top: Floats  # (P,)
    pair_circle: Floats  # (P, 5) centre x', centre y', radius, overlap relative to the centre (2)
    first_corner: Integers  # (P + 1,)
    corner: Floats  # (Q, 3) x', top and bottom of the polygon there


@kernel
def select(tables: WaypointTable, index: int) -> WaypointTable:
    """One problem out of stacked tables, as views."""
    return WaypointTable(
        tables.spacing[index],
        tables.length_weight[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.first_pair[index],
        tables.pair_bottom[index],
        tables.pair_top[index],
        tables.pair_circle[index],
        tables.first_corner[index],
        tables.corner[index],
    )


def stack(tables: list[WaypointTable]) -> WaypointTable:
    """Tables of equal n as one table with a leading axis; shorter pair lists are padded with zeros."""
    return WaypointTable._make(_pad_and_stack(column) for column in zip(*tables, strict=True))


def tabulate(scenario: Scenario, num_waypoints: int, length_weight: float) -> WaypointTable:
    """The table of a scenario for a number of waypoints and a weight mu of the length."""
    frame = Frame.of(scenario)
    spacing = scenario.straight_line / (num_waypoints + 1)
    lower, upper = _bounds(scenario, frame, spacing * np.arange(1.0, num_waypoints + 1))
    shapes = [_in_frame(obstacle, frame) for obstacle in scenario.obstacles]
    initial_lower, initial_upper = _initial_range(scenario, shapes, lower, upper)

    first_pair, extents, circles, first_corner, corners = [0], [], [], [0], []
    for segment in range(num_waypoints + 1):
        for shape in shapes:
            pair = _pair(shape, segment * spacing, (segment + 1) * spacing)
            if pair is not None:
                extent, circle, corner = pair
                extents.append(extent)
                circles.append(circle)
                corners.extend(corner)
                first_corner.append(len(corners))
        first_pair.append(len(extents))
    extent_table = np.array(extents, dtype=np.float64).reshape(-1, 2)
    return WaypointTable(
        float(spacing),
        float(length_weight),
        lower,
        upper,
        initial_lower,
        initial_upper,
        np.array(first_pair, dtype=np.int64),
        np.ascontiguousarray(extent_table[:, 0]),
        np.ascontiguousarray(extent_table[:, 1]),
        np.array(circles, dtype=np.float64).reshape(-1, 5),
        np.array(first_corner, dtype=np.int64),
        np.array(corners, dtype=np.float64).reshape(-1, 3),
    )


def _bounds(scenario: Scenario, frame: Frame, x: Floats) -> tuple[Floats, Floats]:
    """The interval of y' inside the workspace, on the line of each waypoint."""
    x_min, y_min, x_max, y_max = scenario.workspace
    lower, upper = np.full(len(x), -np.inf), np.full(len(x), np.inf)
    foot = frame.to_map(x, np.zeros_like(x))
    # Along a line the map coordinates change with y' at these rates.
    for axis, rate, low, high in ((0, -frame.sine, x_min, x_max), (1, frame.cosine, y_min, y_max)):
        if rate != 0.0:
            ends = np.stack([(low - foot[:, axis]) / rate, (high - foot[:, axis]) / rate])
            lower = np.maximum(lower, ends.min(axis=0))
            upper = np.minimum(upper, ends.max(axis=0))
    return np.minimum(lower, 0.0), np.maximum(upper, 0.0)


def _initial_range(
    scenario: Scenario, shapes: list[_Shape], lower: Floats, upper: Floats
) -> tuple[Floats, Floats]:
    low, high = scenario.initial_range or _extent_of_all(shapes)
    initial_lower, initial_upper = np.maximum(lower, low), np.minimum(upper, high)
    empty = initial_lower >= initial_upper
    if scenario.initial_range is None:
        # Obstacles far from this part of the line say nothing about it.
        return np.where(empty, lower, initial_lower), np.where(empty, upper, initial_upper)
    if empty.any():
        raise ScenarioError(
            f"scenario {scenario.name!r}: the initial range ({low}, {high}) does not meet the workspace "
            f"{scenario.workspace} at every waypoint"
        )
    return initial_lower, initial_upper


def _in_frame(obstacle: Obstacle, frame: Frame) -> _Shape:
    if isinstance(obstacle, Circle):
        return Circle(*frame.from_map((obstacle.x, obstacle.y)), obstacle.radius)
    return [frame.from_map(vertex) for vertex in obstacle.vertices]


def _extent_of_all(shapes: list[_Shape]) -> tuple[float, float]:
    """The extent in y' of all obstacles; unbounded without any."""
    lows, highs = [], []
    for shape in shapes:
        if isinstance(shape, Circle):
            lows.append(shape.y - shape.radius)
            highs.append(shape.y + shape.radius)
        else:
            lows.append(min(y for _, y in shape))
            highs.append(max(y for _, y in shape))
    return min(lows, default=-math.inf), max(highs, default=math.inf)


_Pair = tuple[tuple[float, float], tuple[float, ...], list[tuple[float, float, float]]]


def _pair(shape: _Shape, left: float, right: float) -> _Pair | None:
    """Extent, circle and corner points of an obstacle over [left, right]; None without an overlap."""
    if isinstance(shape, Circle):
        x, y, radius = shape.x, shape.y, shape.radius
        begin, end = max(left, x - radius), min(right, x + radius)
        if end - begin <= OVERLAP_TOLERANCE:
            return None
        nearest = min(max(x, begin), end) - x
        height = math.sqrt(max(radius**2 - nearest**2, 0.0))
        # Clamped, since (x - radius) - x may be a last bit outside the circle.
        overlap = (max(begin - x, -radius), min(end - x, radius))
        return (y - height, y + height), (x - left, y, radius, *overlap), []
    xs = [x for x, _ in shape]
    begin, end = max(left, min(xs)), min(right, max(xs))
    if end - begin <= OVERLAP_TOLERANCE:
        return None
    # Top is concave and bottom convex: both differ most from a line at a break or an end.
    breaks = sorted({begin, end, *(x for x in xs if begin < x < end)})
    points = [(x - left, *_top_and_bottom(shape, x)) for x in breaks]
    extent = (min(bottom for _, _, bottom in points), max(top for _, top, _ in points))
    return extent, (0.0,) * 5, points


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


def _pad_and_stack(values: tuple) -> NDArray:
    arrays = [np.asarray(value) for value in values]
    shape = np.max([array.shape for array in arrays], axis=0).astype(int)
    out = np.zeros((len(arrays), *shape), dtype=arrays[0].dtype)
    for row, array in enumerate(arrays):
        index: tuple[Any, ...] = (row, *map(slice, array.shape))
        out[index] = array
    return out
