"""The geometry of GeoJSON files: every polygon, line and point, with the feature that it belongs to.

Heights, the third numbers of positions, do not matter here.

Source: H. Butler et al., "The GeoJSON format", RFC 7946 (2016).
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios import Point
from swarm_gym.scenarios.formats.data_files import open_file

MAX_FILE = 2**24  # bytes
MAX_SIZE = 1e9  # of a coordinate

MULTI = "Multi"  # before the name of a type of single parts
LEAST = {"LineString": 2, "Polygon": 4}  # positions of a line, and of a ring
SINGLE = ("Point", "LineString", "Polygon")
TYPES = (*SINGLE, *(MULTI + one for one in SINGLE), "GeometryCollection")


class Shape(NamedTuple):
    """A polygon, a line or a point of a file.

    Attributes:
        name: words that name the file and the feature in messages, such as "a.geojson: feature 2 (id 7)".
        kind: "Polygon", "LineString" or "Point".
        parts: outer ring and holes of a polygon, each closed; one list of positions for a line or a point.
    """

    name: str
    kind: str
    parts: tuple[tuple[Point, ...], ...]


class Features(NamedTuple):
    """The content of a file.

    Attributes:
        path: name of the file.
        shapes: all polygons, lines and points.
        total: number of features.
        incomplete: numbers of the features without a geometry, or with a part that has none, from 0 on.
        reference: member "crs", which names a coordinate reference system; None without one.
    """

    path: Path
    shapes: tuple[Shape, ...]
    total: int
    incomplete: tuple[int, ...]
    reference: object

    def left_out(self) -> str | None:
        """Return a sentence about the features that are left out; None if there are none."""
        if not self.incomplete:
            return None
        number = len(self.incomplete)
        named = ", ".join(map(str, self.incomplete[:10])) + (", ..." if number > 10 else "")
        features, have = ("features", "have") if number > 1 else ("feature", "has")
        return (
            f"{self.path}: {number} {features} of {self.total} {have} no geometry, or an empty part, which "
            f"is left out: {features} {named} (counted from 0)"
        )


def read_features(path: Path) -> Features:
    """Return the geometry of a file.

    Raises:
        ScenarioError: if the file cannot be read or is no GeoJSON; the message names the feature.
    """
    try:
        with open_file(path) as file:
            content = file.read(MAX_FILE + 1)
        if len(content) > MAX_FILE:
            raise ScenarioError(f"{path}: expected at most {MAX_FILE} bytes, the file has more")
        return _features(path, json.loads(content))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    except (ValueError, RecursionError) as error:
        if isinstance(error, ScenarioError):
            raise
        raise ScenarioError(f"{path}: expected GeoJSON: {error}") from error


def _features(path: Path, found: Any) -> Features:
    kind = _kind(str(path), found, ("FeatureCollection", "Feature", *TYPES))
    if kind != "FeatureCollection":
        given = [found]
    else:
        given = _member(str(path), found, "features", "a list of features") or []
    shapes: list[Shape] = []
    incomplete: list[int] = []
    for number, feature in enumerate(given):
        name = f"{path}: feature {number}{_known_as(feature)}"
        complete = True
        for shape in _of_feature(name, feature):
            if shape is None:
                complete = False
            else:
                shapes.append(shape)
        if not complete:
            incomplete.append(number)
    return Features(path, tuple(shapes), len(given), tuple(incomplete), found.get("crs"))


def _of_feature(name: str, feature: Any) -> Iterator[Shape | None]:
    """Yield the shapes of a feature, and None for whatever is null or empty."""
    if feature is None:
        yield None
    elif _kind(name, feature, ("Feature", *TYPES)) == "Feature":
        if "geometry" not in feature:
            raise ScenarioError(f"{name}: expected a geometry or null, the feature has no member 'geometry'")
        yield from _of_geometry(name, feature["geometry"])
    else:
        yield from _of_geometry(name, feature)


def _of_geometry(name: str, geometry: Any) -> Iterator[Shape | None]:
    if geometry is None:
        yield None
        return
    kind = _kind(name, geometry, TYPES)
    if kind == "GeometryCollection":
        parts = _member(name, geometry, "geometries", "a list of geometries")
        if not parts:
            yield None
        for part in parts or ():
            yield from _of_geometry(name, part)
    else:
        single, coordinates = kind.removeprefix(MULTI), _member(name, geometry, "coordinates", "a list")
        if not coordinates:
            yield None
        elif single == kind:
            yield _shape(name, kind, coordinates)
        else:
            for part in coordinates:
                yield _shape(name, single, part)


def _shape(name: str, kind: str, coordinates: Any) -> Shape | None:
    """Return a polygon, line or point; None if it is null or empty."""
    if coordinates is None or coordinates == []:
        return None
    if kind != "Polygon":
        positions = [coordinates] if kind == "Point" else coordinates
        return Shape(name, kind, (_positions(name, kind, positions),))
    _require_list(name, "rings of points [x, y]", coordinates)
    if coordinates[0] in ([], None):
        return None
    holes = (ring for ring in coordinates[1:] if ring not in ([], None))
    return Shape(name, kind, tuple(_positions(name, kind, ring) for ring in (coordinates[0], *holes)))


def _positions(name: str, kind: str, found: Any) -> tuple[Point, ...]:
    """Return the positions of a ring, which are closed, or of a line or a point."""
    what = {"Polygon": "rings of points [x, y]", "LineString": "points [x, y] of a line"}.get(kind, "[x, y]")
    _require_list(name, what, found)
    positions = tuple(_position(name, what, one) for one in found)
    least = LEAST.get(kind, 1)
    if len(positions) < least:
        part = "a ring" if kind == "Polygon" else "a line"
        raise ScenarioError(f"{name}: {part} needs at least {least} points [x, y], got {shown(found)}")
    is_open = kind == "Polygon" and positions[0] != positions[-1]
    return (*positions, positions[0]) if is_open else positions


def _position(name: str, what: str, found: Any) -> Point:
    if not isinstance(found, list) or len(found) < 2 or not all(map(_is_number, found[:2])):
        raise ScenarioError(f"{name}: expected {what}, got {shown(found)}")
    x, y = found[:2]
    if not (abs(x) <= MAX_SIZE and abs(y) <= MAX_SIZE):
        raise ScenarioError(
            f"{name}: a coordinate must be finite and at most {MAX_SIZE:g} in size, got {shown(found[:2])}"
        )
    return float(x), float(y)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _kind(name: str, found: Any, expected: tuple[str, ...]) -> str:
    """Return the type of an object.

    Raises:
        ScenarioError: if it is no object, or has another type or none.
    """
    if not isinstance(found, dict) or "type" not in found:
        raise ScenarioError(f"{name}: expected GeoJSON objects with a type, got {shown(found)}")
    kind = found["type"]
    if not isinstance(kind, str) or kind not in expected:
        meant = [one for one in expected if isinstance(kind, str) and one.lower() == kind.lower()]
        valid = f"{meant[0]!r}: capital letters count" if meant else f"one of {', '.join(expected)}"
        raise ScenarioError(f"{name}: unknown type {shown(kind)}; expected {valid}")
    return kind


def _member(name: str, found: dict[str, Any], member: str, what: str) -> Any:
    """Return a member that is a list or null."""
    if member not in found:
        raise ScenarioError(f"{name}: expected {what}, the {found['type']} has no member {member!r}")
    if found[member] is not None and not isinstance(found[member], list):
        raise ScenarioError(f"{name}: {member!r} must be {what}, got {shown(found[member])}")
    return found[member]


def _require_list(name: str, what: str, found: Any) -> None:
    if not isinstance(found, list):
        raise ScenarioError(f"{name}: expected {what}, got {shown(found)}")


def _known_as(feature: Any) -> str:
    """Return the id and the name of a feature in brackets; nothing if it has neither."""
    if not isinstance(feature, dict):
        return ""
    properties = feature.get("properties")
    name = properties.get("name") if isinstance(properties, dict) else None
    known = [
        f"{key} {shown(value)}"
        for key, value in (("id", feature.get("id")), ("name", name))
        if isinstance(value, str | int | float)
    ]
    return f" ({', '.join(known)})" if known else ""
