"""Files with a flight: CSV, GeoJSON, KML, QGroundControl, a picture or a page, by their endings."""

import json
import math
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError, SettingError
from swarm_gym.outputs import require_outputs
from swarm_gym.planning.flights.picture import as_page, as_png
from swarm_gym.planning.flights.result import Flight
from swarm_gym.planning.writing import format_of, write_all
from swarm_gym.scenarios.formats.elevation import NAME_SYSTEM
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC
from swarm_gym.scenarios.terrain.scenario import RADIUS, TOP
from swarm_gym.scenarios.terrain.survey import Survey

Floats = NDArray[np.float64]

# Numbers of MAVLink and QGroundControl: a waypoint, heights above sea level, a multicopter with PX4.
WAYPOINT, ABOVE_SEA, ABSOLUTE, MULTICOPTER, PX4 = 16, 0, 2, 2, 12
SPEED = 5.0  # metres a second
DECIMALS = 9  # of degrees, a tenth of a millimetre
NEAR = 0.1  # metres


def as_csv(flight: Flight) -> str:
    """Return lines `x,y,z,above_ground` below a head, x and y in the user's coordinates."""
    lines = [
        f"{x!r},{y!r},{z:.3f},{above:.3f}\n"
        for (x, y, z), above in zip(flight.path.tolist(), flight.above_ground.tolist(), strict=True)
    ]
    return "".join(["x,y,z,above_ground\n", *lines])


def as_geojson(flight: Flight) -> str:
    """Return a feature with a line string, whose positions have heights above sea level.

    Coordinates are longitude and latitude where the map has a place on the earth, else map coordinates. There
    long legs have positions between their waypoints, since lines of GeoJSON are straight in degrees.
    """
    waypoints = flight.waypoints if flight.in_degrees is None else _fine_waypoints(flight)
    degrees = flight.task.in_degrees(waypoints[:, :2])
    places = flight.path if degrees is None else np.column_stack([degrees, waypoints[:, 2]])
    above_ground = waypoints[:, 2] - flight.task.ground(waypoints[:, :2])
    facts = {
        "map": flight.map.name,
        "length": flight.length,
        "least_height_above_ground": flight.least_height,
        "greatest_height_above_ground": flight.greatest_height,
        "steepest_climb": flight.steepest_climb,
        "sharpest_turn": flight.sharpest_turn,
        "above_ground": above_ground.tolist(),
        "evaluations": flight.evaluations,
        "found_by": flight.found_by,
    }
    geometry = {"type": "LineString", "coordinates": places.tolist()}
    return json.dumps({"type": "Feature", "properties": facts, "geometry": geometry}, indent=1) + "\n"


def as_kml(flight: Flight) -> str:
    """Return a document of KML 2.2: the flight with heights above sea level, and threats as circles.

    Raises:
        SettingError: if the map has no place on the earth.
    """
    line = " ".join(f"{x:.{DECIMALS}f},{y:.{DECIMALS}f},{z:.3f}" for x, y, z in _degrees(flight).tolist())
    name = escape(flight.map.name)
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<kml xmlns="http://www.opengis.net/kml/2.2">',
        "<Document>",
        f"<name>{name}</name>",
        '<Style id="flight"><LineStyle><color>ff0c41c2</color><width>3</width></LineStyle></Style>',
        '<Style id="threat"><LineStyle><color>ff3b3bdc</color></LineStyle>'
        "<PolyStyle><color>603b3bdc</color></PolyStyle></Style>",
        f"<Placemark><name>{flight.length:.0f} m</name><styleUrl>#flight</styleUrl><LineString>"
        f"<altitudeMode>absolute</altitudeMode><coordinates>{line}</coordinates></LineString></Placemark>",
    ]
    for number, threat in enumerate(flight.map.threats):
        ring = _circle(flight, threat)
        if ring is None:
            continue
        parts.append(
            f"<Placemark><name>threat {number}</name><styleUrl>#threat</styleUrl><Polygon><outerBoundaryIs>"
            f"<LinearRing><coordinates>{ring}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
        )
    return "\n".join([*parts, "</Document>", "</kml>", ""])


def as_mission(flight: Flight) -> str:
    """Return a plan of QGroundControl: waypoints above sea level, and threats as circles to keep out of.

    Threats that the flight passes over are no circles, since a fence has no top.

    Source: "Plan File Format" in the developer guide of QGroundControl, version 1 of plans.

    Raises:
        SettingError: if the map has no place on the earth.
    """
    places = _degrees(flight)
    items = [
        {
            "AMSLAltAboveTerrain": None,
            "Altitude": round(z, 3),
            "AltitudeMode": ABSOLUTE,
            "autoContinue": True,
            "command": WAYPOINT,
            "doJumpId": number,
            "frame": ABOVE_SEA,
            "params": [0, 0, 0, None, round(latitude, DECIMALS), round(longitude, DECIMALS), round(z, 3)],
            "type": "SimpleItem",
        }
        for number, (longitude, latitude, z) in enumerate(places.tolist(), 1)
    ]
    longitude, latitude, _ = places[0].tolist()
    ground = float(flight.waypoints[0, 2] - flight.above_ground[0])
    plan: dict[str, Any] = {
        "fileType": "Plan",
        "geoFence": {"circles": _fences(flight), "polygons": [], "version": 2},
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": 15,
            "firmwareType": PX4,
            "hoverSpeed": SPEED,
            "items": items,
            "plannedHomePosition": [round(latitude, DECIMALS), round(longitude, DECIMALS), round(ground, 3)],
            "vehicleType": MULTICOPTER,
            "version": 2,
        },
        "rallyPoints": {"points": [], "version": 2},
        "version": 1,
    }
    return json.dumps(plan, indent=4, allow_nan=False) + "\n"


FORMATS: dict[str, Callable[[Flight], str | bytes]] = {
    ".csv": as_csv,
    ".geojson": as_geojson,
    ".kml": as_kml,
    ".plan": as_mission,
    ".png": as_png,
    ".html": as_page,
}


def require_formats(paths: Iterable[Path], read: Iterable[object] = ()) -> None:
    """Raise an error unless a flight can be written to files of these names.

    Args:
        paths: files to write.
        read: the map and other inputs of the plan; those that are paths of files must stay.

    Raises:
        SettingError: for an ending that is not in `FORMATS`, and as `swarm_gym.outputs.require_outputs`.
        MissingExtraError: for a PNG, if Pillow is missing.
    """
    named = [*paths]
    require_outputs(named, read, FORMATS)
    for path in named:
        if path.suffix == ".png" and find_spec("PIL") is None:
            raise MissingExtraError(f"output {str(path)!r}", "Pillow", "terrain")


def require_places(paths: Iterable[Path], task: Survey) -> None:
    """Raise an error if a file needs longitude and latitude, and the task has no place on the earth.

    Raises:
        SettingError: for KML or a mission over such a task.
    """
    for path in paths:
        if path.suffix in (".kml", ".plan") and task.system is None:
            raise SettingError(f"output {str(path)!r}: {_without_a_place(task)}")


def _without_a_place(task: Survey) -> str:
    """Return words on a task that has no place on the earth."""
    reason = f"{task.scenario.name!r} has no place on the earth; write CSV or GeoJSON"
    if task.elevation is not None:
        reason = f"{task.elevation.path} names no coordinate reference system; {NAME_SYSTEM}"
    return f"KML and missions need {GEOGRAPHIC}, and {reason}"


def write_flight(flight: Flight, *paths: Path) -> None:
    """Write a flight to files, each in the format that its ending names.

    No file is written before the contents of all are complete, and each is written completely or not at all.

    Raises:
        SettingError: for an ending that is not in `FORMATS`, or a map without a place on the earth.
        MissingExtraError: for a PNG, if Pillow is missing.
        OSError: naming the first file that cannot be written; those before it are complete.
    """
    require_places(paths, flight.task)
    write_all({path: format_of(path, FORMATS)(flight) for path in paths})


def _fine_waypoints(flight: Flight) -> Floats:
    """Return waypoints and points between them, (n, 3) in metres, so that lines straight in degrees are near.

    Halfway between two of them such a line is no more than about `NEAR` away from the flight.
    """
    waypoints = flight.waypoints
    degrees = flight.task.in_degrees(waypoints[:, :2])
    assert flight.task.system is not None
    assert degrees is not None
    steps = np.diff(degrees, axis=0)
    steps[:, 0] -= 360.0 * np.round(steps[:, 0] / 360.0)
    straight = flight.task.system.to_metres(degrees[:-1] + 0.5 * steps)
    off = np.hypot(*(straight - 0.5 * (waypoints[:-1, :2] + waypoints[1:, :2])).T)
    pieces = [waypoints[:1]]
    for begin, end, count in zip(waypoints[:-1], waypoints[1:], np.ceil(np.sqrt(off / NEAR)), strict=True):
        pieces.append(np.linspace(begin, end, max(int(count), 1) + 1)[1:])
    return np.vstack(pieces)


def _degrees(flight: Flight) -> Floats:
    places = flight.in_degrees
    if places is None:
        raise SettingError(f"output: {_without_a_place(flight.task)}")
    return places


def _fences(flight: Flight) -> list[dict[str, Any]]:
    """Return the threats that the flight does not pass over as circles that exclude.

    Those that are too far away to have a place in degrees are left out.
    """
    over = {passed.number for passed in flight.passed if passed.distance < 0.0}
    threats = [one for number, one in enumerate(flight.map.threats) if number not in over]
    if not threats:
        return []
    centres = flight.task.in_degrees(np.array(threats)[:, :2])
    assert centres is not None
    return [
        {
            "circle": {
                "center": [round(latitude, DECIMALS), round(longitude, DECIMALS)],
                "radius": flight.task.true_radius(one),
            },
            "inclusion": False,
            "version": 1,
        }
        for one, (longitude, latitude) in zip(threats, centres.tolist(), strict=True)
        if math.isfinite(longitude) and math.isfinite(latitude)
    ]


def _circle(flight: Flight, threat: Floats) -> str | None:
    """Return the outline of a threat as coordinates of KML; None if it has no place in degrees."""
    angles = np.linspace(0.0, 2.0 * math.pi, 49)
    outline = threat[:2] + threat[RADIUS] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    outline[-1] = outline[0]
    places = flight.task.in_degrees(outline)
    assert places is not None
    if not np.isfinite(places).all():
        return None
    top = f",{threat[TOP]:.1f}" if math.isfinite(threat[TOP]) else ""
    return " ".join(f"{x:.{DECIMALS}f},{y:.{DECIMALS}f}{top}" for x, y in places.tolist())
