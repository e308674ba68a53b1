"""Obstacles of analytic maps, circles and convex polygons, and checks of the numbers of a scenario."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import TypeVar

from swarm_gym.errors import ScenarioError, shown

Item = TypeVar("Item")
Point = tuple[float, float]

# Largest coordinate or length, in map units; products and differences of two such numbers stay finite.
MAX_COORDINATE = 1e12


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
            require_point(self, "a vertex", vertex)
            for vertex in require_sequence(self, "vertices", self.vertices)
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


def require_sequence(where: object, part: str, values: Iterable[Item]) -> tuple[Item, ...]:
    """Return the values as a tuple.

    Raises:
        ScenarioError: if they are no sequence.
    """
    try:
        return tuple(values)
    except TypeError as error:
        raise ScenarioError(f"{_shown(where)}: {part} must be a sequence, got {shown(values)}") from error


def require_point(where: object, part: str, values: Iterable[float]) -> Point:
    """Return the values as a point; `require_numbers` describes the arguments and errors."""
    x, y = require_numbers(where, part, values, 2)
    return x, y


def require_numbers(where: object, part: str, values: Iterable[float], length: int) -> tuple[float, ...]:
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
    """Return the area, positive for counter-clockwise vertices; products of large coordinates would round."""
    return math.fsum(_cross(vertices[0], a, b) for a, b in pairwise(vertices[1:])) / 2
