"""Threats to flights in a GeoJSON file: points with a radius and a height, which are upright cylinders.

Every feature is a point. Its properties say, in metres:

* `radius`: radius of the cylinder; needed.
* `height`: height of the top above the ground at the point; or
* `top`: height of the top above sea level. Without both, the threat blocks every altitude.
"""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file
from swarm_gym.scenarios.formats.geographic import system_named

MAX_FILE = 2**24  # bytes
LARGEST = {"radius": 1e6, "height": 5e4, "top": 5e4}  # in metres


class Threat(NamedTuple):
    """A cylinder of a file.

    Attributes:
        name: words that name the file and the feature in messages.
        place: x and y, or longitude and latitude.
        radius: radius in metres.
        height: height of the top above the ground, in metres; infinite for all altitudes; None where `top` is
            given.
        top: height of the top above sea level, in metres; None where `height` is given.
    """

    name: str
    place: tuple[float, float]
    radius: float
    height: float | None
    top: float | None


class Threats(NamedTuple):
    """The content of a file: threats, and the reference system that it names; None if it names none."""

    threats: tuple[Threat, ...]
    system: str | None


def read_threats(path: Path) -> Threats:
    """Return the threats of a file.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names feature and value.
    """
    try:
        with open_file(path) as file:
            content = file.read(MAX_FILE + 1)
        if len(content) > MAX_FILE:
            raise ScenarioError(f"{path}: expected at most {MAX_FILE} bytes, the file has more")
        found = json.loads(content)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    except (ValueError, RecursionError) as error:
        if isinstance(error, ScenarioError):
            raise
        raise ScenarioError(f"{path}: expected GeoJSON: {error}") from error
    features = found.get("features") if isinstance(found, dict) else None
    if not isinstance(features, list) or found.get("type") != "FeatureCollection":
        raise ScenarioError(
            f"{path}: expected a FeatureCollection of GeoJSON with features, got {shown(found)}"
        )
    threats = tuple(_threat(f"{path}: feature {number}", one) for number, one in enumerate(features))
    return Threats(threats, system_named(str(path), found.get("crs")))


def _threat(name: str, feature: Any) -> Threat:
    geometry = feature.get("geometry") if isinstance(feature, dict) else None
    properties = feature.get("properties") if isinstance(feature, dict) else None
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if not isinstance(geometry, dict) or kind != "Point":
        raise ScenarioError(f"{name}: expected a Point with a radius as threat, got {shown(kind or feature)}")
    place = geometry.get("coordinates")
    if not isinstance(place, list) or len(place) < 2 or not all(map(_is_number, place[:2])):
        raise ScenarioError(f"{name}: expected coordinates [x, y], got {shown(place)}")
    if not all(abs(number) <= 1e9 for number in place[:2]):
        raise ScenarioError(
            f"{name}: coordinates must be finite, at most 1e9 in size, got {shown(place[:2])}"
        )
    if not isinstance(properties, dict) or "radius" not in properties:
        raise ScenarioError(
            f"{name}: a threat without radius; add the property radius, in metres, such as 75"
        )
    radius = _number(name, properties, "radius")
    if radius is None or not radius > 0.0:
        raise ScenarioError(f"{name}: radius must be positive, in metres, got {shown(properties['radius'])}")
    height, top = _number(name, properties, "height"), _number(name, properties, "top")
    if height is not None and top is not None:
        raise ScenarioError(
            f"{name}: both height above ground and top above sea level are given; expected one"
        )
    if height is not None and height <= 0.0:
        raise ScenarioError(f"{name}: height must be positive, in metres above ground, got {height:g}")
    if height is None and top is None:
        height = math.inf
    x, y = place[:2]
    return Threat(name, (float(x), float(y)), radius, height, top)


def _number(name: str, properties: dict[str, Any], key: str) -> float | None:
    """Return a property that is a number; None if it is missing or null."""
    value = properties.get(key)
    if value is None and key != "radius":
        return None
    if value is None or not _is_number(value) or not abs(value) <= LARGEST[key]:
        raise ScenarioError(
            f"{name}: {key} must be a number of metres, at most {LARGEST[key]:g}, got {shown(value)}"
        )
    return float(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
