"""Scenarios on analytic maps: a workspace with obstacles, a start and a target.

Values are checked when an object is made.
"""

import math
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Any

from swarm_gym.errors import ScenarioError, shown

Point = tuple[float, float]

# Largest coordinate or length, in map units; products and differences of two such numbers stay finite.
MAX_COORDINATE = 1e9
# Depth in map units up to which a point counts as touching an obstacle, because numbers are rounded. It is
# larger than the depth up to which a path counts as feasible.
TOUCHING = 1e-8


@dataclass(frozen=True)
class Circle:
    """A disc-shaped obstacle: centre and radius in map units."""

    x: float
    y: float
    radius: float

    def __post_init__(self) -> None:
        require_numbers(self, "(x, y, radius)", (self.x, self.y, self.radius), 3)
        if self.radius <= 0:
            raise ScenarioError(f"{self}: the radius must be positive, got {self.radius!r}")

    def contains(self, point: Point) -> bool:
        """Return True if a point lies in the open disc."""
        return self.depth(point) > 0

    def depth(self, point: Point) -> float:
        """Return the distance of a point in the disc from its edge; it is negative outside."""
        return self.radius - math.hypot(point[0] - self.x, point[1] - self.y)

    def moved(self, by: Point) -> "Circle":
        """Return the disc, moved by (x, y)."""
        return Circle(self.x + by[0], self.y + by[1], self.radius)


@dataclass(frozen=True)
class Polygon:
    """A convex obstacle: its vertices in map units, given in either direction, stored counter-clockwise."""

    vertices: tuple[Point, ...]

    def __post_init__(self) -> None:
        vertices = tuple(
            require_numbers(self, "a vertex", vertex, 2)
            for vertex in _sequence(self, "vertices", self.vertices)
        )
        if len(vertices) < 3:
            raise ScenarioError(f"{self}: a polygon needs at least 3 vertices, got {len(vertices)}")
        if len(set(vertices)) < len(vertices):
            raise ScenarioError(f"{self}: the vertices must be different points, got one twice")
        if _signed_area(vertices) < 0:
            vertices = vertices[::-1]
        # Counter-clockwise, so that every edge has the inside on its left.
        object.__setattr__(self, "vertices", vertices)
        self._require_convex()

    @classmethod
    def rectangle(cls, x_min: float, y_min: float, x_max: float, y_max: float) -> "Polygon":
        """Return an axis-parallel rectangle.

        Raises:
            ScenarioError: if the extremes are not numbers, or not x_min < x_max and y_min < y_max.
        """
        extremes = (x_min, y_min, x_max, y_max)
        try:
            ordered = x_min < x_max and y_min < y_max
        except (TypeError, ValueError) as error:
            raise ScenarioError(f"rectangle {shown(extremes)}: expected four numbers") from error
        if not ordered:
            raise ScenarioError(f"rectangle {shown(extremes)}: expected x_min < x_max and y_min < y_max")
        return cls(((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)))

    def edges(self) -> list[tuple[Point, Point]]:
        """Return the edges, counter-clockwise."""
        return list(pairwise((*self.vertices, self.vertices[0])))

    def contains(self, point: Point) -> bool:
        """Return True if a point lies in the open polygon."""
        return all(_cross(a, b, point) > 0 for a, b in self.edges())

    def depth(self, point: Point) -> float:
        """Return the distance of a point in the polygon from its edges; it is negative outside."""
        return min(_cross(a, b, point) / math.dist(a, b) for a, b in self.edges())

    def moved(self, by: Point) -> "Polygon":
        """Return the polygon, moved by (x, y)."""
        return Polygon(tuple((x + by[0], y + by[1]) for x, y in self.vertices))

    def _require_convex(self) -> None:
        corners = self.vertices
        turn = 0.0
        for before, here, after in zip(
            corners, corners[1:] + corners[:1], corners[2:] + corners[:2], strict=True
        ):
            if _cross(before, here, after) <= 0:
                raise ScenarioError(
                    f"{self}: not strictly convex at vertex {here} (a concave, straight or crossing corner)"
                )
            heading_in = math.atan2(here[1] - before[1], here[0] - before[0])
            heading_out = math.atan2(after[1] - here[1], after[0] - here[0])
            turn += (heading_out - heading_in) % math.tau
        # A star turns left at every vertex, but more than once around.
        if round(turn / math.tau) != 1:
            raise ScenarioError(f"{self}: the outline crosses itself")


Obstacle = Circle | Polygon


@dataclass(frozen=True)
class Scenario:
    """A path-planning task on a map of circles and polygons, in map units.

    Attributes:
        name: name under which results are filed.
        start: (x, y) where the robot is.
        target: (x, y) where it has to go.
        obstacles: circles and convex polygons; they may overlap.
        workspace: (x_min, y_min, x_max, y_max); start and target lie in it.
        initial_range: (low, high) of the first waypoints, as offsets to the left of the line from start to
            target; None takes the extent of the obstacles.

    Raises:
        ScenarioError: if the task is malformed; the message names the part and its value.
    """

    name: str
    start: Point
    target: Point
    obstacles: tuple[Obstacle, ...]
    workspace: tuple[float, float, float, float] = (0.0, 0.0, 1000.0, 600.0)
    initial_range: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        object.__setattr__(self, "obstacles", _sequence(where, "obstacles", self.obstacles))
        for part, length in (("start", 2), ("target", 2), ("workspace", 4), ("initial_range", 2)):
            given = getattr(self, part)
            if part != "initial_range" or given is not None:
                object.__setattr__(self, part, require_numbers(where, part, given, length))
        x_min, y_min, x_max, y_max = self.workspace
        if not (x_min < x_max and y_min < y_max):
            raise ScenarioError(
                f"{where}: workspace needs x_min < x_max and y_min < y_max, got {self.workspace}"
            )
        if self.start == self.target:
            raise ScenarioError(f"{where}: start and target must be different points, both are {self.start}")
        for role, point in (("start", self.start), ("target", self.target)):
            if not (x_min <= point[0] <= x_max and y_min <= point[1] <= y_max):
                raise ScenarioError(f"{where}: {role} {point} lies outside the workspace {self.workspace}")
            for number, obstacle in enumerate(self.obstacles):
                if not isinstance(obstacle, Circle | Polygon):
                    raise ScenarioError(
                        f"{where}: obstacle {number} is {shown(obstacle)}, expected a Circle or a Polygon"
                    )
                if obstacle.depth(point) > TOUCHING:
                    raise ScenarioError(f"{where}: {role} {point} lies inside obstacle {number}, {obstacle}")
        if self.initial_range is not None and self.initial_range[0] >= self.initial_range[1]:
            raise ScenarioError(
                f"{where}: initial_range (low, high) needs low < high, got {self.initial_range}"
            )

    @property
    def y_up(self) -> bool:
        """True if y grows upwards in pictures."""
        return True

    @property
    def view(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the area that pictures show: the workspace."""
        return self.workspace

    @property
    def straight_line(self) -> float:
        """Distance from start to target in map units: no path is shorter."""
        return math.hypot(self.target[0] - self.start[0], self.target[1] - self.start[1])


def _sequence(where: object, part: str, values: Any) -> tuple[Any, ...]:
    try:
        return tuple(values)
    except TypeError as error:
        raise ScenarioError(f"{_shown(where)}: {part} must be a sequence, got {shown(values)}") from error


def require_numbers(where: object, part: str, values: Any, length: int) -> tuple[Any, ...]:
    """Return the values as a tuple of floats, `length` of them and none larger than `MAX_COORDINATE` in size.

    Args:
        where: object or text that a message begins with.
        part: name of the values, for messages.
        values: sequence of numbers.
        length: expected number of values.

    Raises:
        ScenarioError: if the values are not such numbers.
    """
    try:
        given = tuple(islice(values, length + 1))
        # float() would accept a text of digits, but a circle keeps the values as they are given.
        if any(isinstance(value, str | bytes) for value in given):
            raise TypeError
        numbers = tuple(float(value) for value in given)
    except (TypeError, ValueError, OverflowError) as error:
        raise ScenarioError(
            f"{_shown(where)}: {part} must be {length} numbers, got {shown(values)}"
        ) from error
    if len(numbers) != length:
        raise ScenarioError(f"{_shown(where)}: {part} must be {length} numbers, got {shown(values)}")
    if not all(abs(number) <= MAX_COORDINATE for number in numbers):
        raise ScenarioError(
            f"{_shown(where)}: {part} must be finite and at most {MAX_COORDINATE:g} in size, "
            f"got {shown(values)}"
        )
    return numbers


def _shown(where: object) -> str:
    """Return the subject of a message: a text as it is, any other object in short form."""
    return where if isinstance(where, str) else shown(where)


def _cross(a: Point, b: Point, c: Point) -> float:
    """Return twice the signed area of the triangle a, b, c; it is positive for a left turn."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _signed_area(vertices: tuple[Point, ...]) -> float:
    """Return the area of an outline, negative if it is clockwise.

    Products are those of differences: far from the origin, the coordinates' own would be too large.
    """
    origin = vertices[0]
    return math.fsum(_cross(origin, a, b) for a, b in pairwise(vertices)) / 2
