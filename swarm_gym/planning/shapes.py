"""Obstacles that stand for the polygons, lines and points of a file."""

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError, ScenarioError
from swarm_gym.planning.geojson import Shape
from swarm_gym.planning.pieces import Ring, as_convex, cut, rounded, without_repeats
from swarm_gym.scenarios import Circle, Obstacle, Point, Polygon

Floats = NDArray[np.float64]

# Half the width of a line and the radius of a point, as a share of the map's extent. Obstacles have an
# inside, so a wall without width becomes this thin. That is above the depth up to which a path is free, and a
# path around a wall is longer by about that share.
THIN = 1e-9
ROUNDINGS = 8.0  # least half width, in distances between neighbouring floats at the map's farthest coordinate


def thinnest(points: Floats) -> float:
    """Return half the width of lines on a map whose points are these, (k, 2), in map units."""
    return max(THIN * extent_of(points), ROUNDINGS * float(np.spacing(np.abs(points).max())))


def extent_of(points: Floats) -> float:
    """Return the longer side of the box around points, (k, 2)."""
    return float(np.ptp(points, axis=0).max())


def obstacles_of(shape: Shape, extent: float, half_width: float) -> list[Obstacle]:
    """Return the obstacles whose union is a shape.

    A polygon is cut into convex pieces; its holes are free. If its rings cross themselves or each other, it
    is the area that its outer ring encloses, without what its holes enclose. Parts of the outer ring without
    width are walls.

    Args:
        shape: polygon, line or point.
        extent: extent of the map, in map units.
        half_width: half the width of lines, and radius of points, in map units.

    Raises:
        ScenarioError: if a polygon cannot be cut; the message names the feature.
        MissingExtraError: if a polygon has holes or is not convex, and shapely is missing.
    """
    if shape.kind != "Polygon":
        return _wall(shape.parts[0], half_width)
    outer, *holes = [ring for part in shape.parts if (ring := without_repeats(list(part)))]
    if len(outer) < 3:
        return _wall((*outer, outer[0]), half_width)
    convex = None if holes else as_convex(outer, extent)
    if convex is not None:
        return [Polygon(tuple(convex))]
    try:
        return _pieces(outer, [hole for hole in holes if len(hole) > 2], extent, half_width)
    except ImportError as error:
        raise MissingExtraError(
            f"{shape.name}, a polygon with holes or concave corners,", "shapely", "maps"
        ) from error
    except ScenarioError as error:
        raise ScenarioError(f"{shape.name}: {error}") from error


def _pieces(outer: Ring, holes: list[Ring], extent: float, half_width: float) -> list[Obstacle]:
    import shapely

    given = shapely.Polygon(outer, holes)
    areas = [given] if given.is_valid else _areas(_filled(outer).difference(_filled(*holes)))
    pieces = [cut(one, extent) for one in areas]
    if None in pieces:
        areas = _areas(rounded(shapely.union_all(areas), extent))
        pieces = [cut(one, extent) for one in areas]
    if None in pieces:
        raise ScenarioError("a polygon with corners that nearly lie on its other edges; simplify it")
    found: list[Obstacle] = [Polygon(tuple(ring)) for rings in pieces for ring in rings or ()]
    if areas == [given]:
        return found
    # Parts of the outer ring that have no width are not in the areas.
    covered = shapely.union_all([one.buffer(half_width) for one in areas])
    left = shapely.LineString([*outer, outer[0]]).difference(covered)
    for line in shapely.get_parts(left):
        if not line.is_empty:
            found += _wall(tuple(map(tuple, shapely.get_coordinates(line).tolist())), half_width)
    return found


def _filled(*rings: Ring) -> Any:
    """Return what rings enclose together; parts that a ring encloses twice are in it."""
    import shapely

    valid = [shapely.make_valid(shapely.Polygon(ring), method="structure") for ring in rings]
    return shapely.union_all([area for one in valid for area in _areas(one)])


def _areas(found: Any) -> list[Any]:
    """Return the polygons of a shapely geometry."""
    import shapely

    return [one for one in shapely.get_parts(found) if one.area > 0.0]


def _wall(points: tuple[Point, ...], half_width: float) -> list[Obstacle]:
    """Return rectangles along the segments of a line, or a circle if all points are the same."""
    segments = [(a, b) for a, b in pairwise(points) if a != b]
    if not segments:
        return [Circle(*points[0], half_width)]
    return [_segment(a, b, half_width) for a, b in segments]


def _segment(a: Point, b: Point, half_width: float) -> Polygon:
    """Return a rectangle along a segment, longer by half its width at both ends, so that joints overlap."""
    share = half_width / math.dist(a, b)
    x, y = share * (b[0] - a[0]), share * (b[1] - a[1])
    return Polygon(
        (
            (a[0] - x + y, a[1] - y - x),
            (b[0] + x + y, b[1] + y - x),
            (b[0] + x - y, b[1] + y + x),
            (a[0] - x - y, a[1] - y + x),
        )
    )


class End(NamedTuple):
    """The start or the goal of a robot.

    Attributes:
        role: "start" or "goal".
        point: the end, in map units.
        given: the end in the user's coordinates, for messages.
    """

    role: str
    point: Point
    given: Point

    def __str__(self) -> str:
        return f"{self.role} {self.given}"

    def require_outside(self, shape: Shape, half_width: float, margin: float) -> None:
        """Raise an error if the end lies in a shape, or closer to it than the margin.

        Args:
            shape: polygon, line or point.
            half_width: half the width of lines, in map units.
            margin: distance that the robot keeps from obstacles, in map units.

        Raises:
            ScenarioError: with the end and the name of the feature.
        """
        distance, word = distance_to(shape.parts, self.point), _word(shape)
        if shape.kind != "Polygon":
            if distance <= 2.0 * half_width:
                raise ScenarioError(f"{self} lies on the {word} of {shape.name}; move it away")
        elif distance > half_width and is_inside(shape.parts, self.point):
            raise ScenarioError(f"{self} lies inside the polygon of {shape.name}; move it outside")
        self._require_margin(f"{word} of {shape.name}", distance, half_width, margin)

    def require_within(self, shape: Shape, tolerance: float, margin: float) -> None:
        """Raise an error if the end lies outside a workspace, or closer to its edge than the margin.

        Args:
            shape: workspace, in map units.
            tolerance: distance outside that counts as on the edge, in map units.
            margin: distance that the robot keeps from the edge, in map units.

        Raises:
            ScenarioError: with the end and the name of the workspace.
        """
        distance = distance_to(shape.parts, self.point)
        if distance > tolerance and not is_inside(shape.parts, self.point):
            raise ScenarioError(
                f"{self} lies outside the {shape.name}; move it inside, or choose a larger one"
            )
        self._require_margin(f"edge of the {shape.name}", distance, tolerance, margin)

    def _require_margin(self, what: str, distance: float, tolerance: float, margin: float) -> None:
        if distance < margin - tolerance:
            raise ScenarioError(
                f"{self} is {distance:g} from the {what}; expected at least {margin:g}, the robot's radius "
                "plus the clearance"
            )


def is_inside(rings: tuple[tuple[Point, ...], ...], point: Point) -> bool:
    """Return whether a point lies inside an odd number of rings: inside the outer one, and in no hole."""
    crossings = 0
    for ring in rings:
        (x, y), (after_x, after_y) = (np.array(corners).T for corners in (ring, ring[1:] + ring[:1]))
        spans = (y > point[1]) != (after_y > point[1])
        share = np.divide(point[1] - y, after_y - y, out=np.zeros_like(y), where=spans)
        crossings += int((spans & (point[0] < x + share * (after_x - x))).sum())
    return crossings % 2 == 1


def distance_to(lines: tuple[tuple[Point, ...], ...], point: Point) -> float:
    """Return the distance of a point from rings, lines or points, which are lines of one point."""
    least = math.inf
    for line in lines:
        ends = np.array(line)
        begins, changes = ends[: max(len(ends) - 1, 1)], np.diff(ends, axis=0)
        if not len(changes):
            changes = np.zeros((1, 2))
        offsets, squares = np.array(point) - begins, (changes**2).sum(axis=1)
        along = (offsets * changes).sum(axis=1)
        share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
        least = min(least, float(np.hypot(*(offsets - share[:, None] * changes).T).min()))
    return least


def _word(shape: Shape) -> str:
    return {"LineString": "line"}.get(shape.kind, shape.kind.lower())
