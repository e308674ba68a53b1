"""Files with a path: CSV, GeoJSON, ROS's nav_msgs/Path as YAML, or a picture, by the ending of the name."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from swarm_gym.errors import MissingExtraError, SettingError
from swarm_gym.files import write_atomically
from swarm_gym.outputs import require_outputs
from swarm_gym.planning.curve import COLUMNS
from swarm_gym.planning.drawing import as_png, as_svg
from swarm_gym.planning.result import Plan

Made = TypeVar("Made")


def as_csv(plan: Plan) -> str:
    """Return lines `x,y` below a head, in the coordinates of the map's file.

    Curves have the columns `heading` in degrees, `curvature` in 1 / map unit and `direction`, 1 or -1, too.
    """
    if plan.curve is not None:
        rows = np.column_stack([plan.path, plan.curve.poses[:, 2:]]).tolist()
        return "".join([",".join(COLUMNS) + "\n", *(",".join(map(repr, row)) + "\n" for row in rows)])
    return "".join(["x,y\n", *(f"{x!r},{y!r}\n" for x, y in plan.path.tolist())])


def as_geojson(plan: Plan) -> str:
    """Return a feature with a line string, in the map's coordinates, or one for each alternative."""
    content = _feature(plan)
    if len(plan.alternatives) > 1:
        content = {"type": "FeatureCollection", "features": [_feature(one) for one in _each(plan)]}
    if plan.reference is not None:  # without it, readers take coordinates for degrees
        content["crs"] = plan.reference
    return json.dumps(content, indent=1) + "\n"


def _each(plan: Plan) -> list[Plan]:
    """Return the plan once for each of its alternatives, with the path of that."""
    return [
        replace(
            plan,
            path=one.path,
            length=one.length,
            clearance=one.clearance,
            costs=one.costs,
            found_by=plan.found_by if number == 0 else "alternative",
            alternatives=(),
            curve=one.curve,
        )
        for number, one in enumerate(plan.alternatives)
    ]


def _feature(plan: Plan) -> dict[str, Any]:
    facts: dict[str, Any] = {
        "map": plan.map.name,
        "length": plan.length,
        "evaluations": plan.evaluations,
        "found_by": plan.found_by,
    }
    if np.isfinite(plan.clearance):
        facts["clearance"] = plan.clearance
    facts |= {f"cost_{name}": cost for name, cost in plan.costs.items() if name != "length"}
    if plan.curve is not None:
        facts |= {"turning_radius": plan.curve.turning_radius, "changes_of_direction": plan.curve.changes}
        facts |= {"headings": plan.curve.poses[:, 2].tolist(), "curvatures": plan.curve.poses[:, 3].tolist()}
    geometry = {"type": "LineString", "coordinates": plan.path.tolist()}
    return {"type": "Feature", "properties": facts, "geometry": geometry}


def as_ros_path(plan: Plan) -> str:
    """Return a message nav_msgs/Path in the frame `map`; poses look along the path, or as curves say."""
    if plan.curve is None:
        along = np.arctan2(*np.diff(plan.path_on_map, axis=0).T[::-1])
        headings = np.append(along, along[-1])
    else:
        headings = np.radians(plan.curve.poses[:, 2])
    lines = ["header:", "  frame_id: map", "poses:"]
    for (x, y), heading in zip(plan.path.tolist(), headings.tolist(), strict=True):
        sin, cos = np.sin(heading / 2.0), np.cos(heading / 2.0)
        lines += [
            "- header:",
            "    frame_id: map",
            "  pose:",
            f"    position: {{x: {_in_yaml(x)}, y: {_in_yaml(y)}, z: 0.0}}",
            f"    orientation: {{x: 0.0, y: 0.0, z: {_in_yaml(sin)}, w: {_in_yaml(cos)}}}",
        ]
    return "\n".join(lines) + "\n"


def _in_yaml(number: float) -> str:
    """Return a number with a point, without which readers of YAML 1.1 take 1e-05 for a text."""
    text = repr(float(number))
    return text if "." in text else text.replace("e", ".0e")


FORMATS: dict[str, Callable[[Plan], str | bytes]] = {
    ".csv": as_csv,
    ".geojson": as_geojson,
    ".yaml": as_ros_path,
    ".svg": as_svg,
    ".png": as_png,
}


def format_of(path: Path, formats: Mapping[str, Made]) -> Made:
    """Return the entry of the ending of a file's name.

    Args:
        path: file to write.
        formats: function that makes the content of a file, by the ending of its name.

    Raises:
        SettingError: for an ending that is not in `formats`.
    """
    if path.suffix not in formats:
        raise SettingError(f"output {str(path)!r}: the name must end with {', '.join(formats)}")
    return formats[path.suffix]


def require_formats(paths: Iterable[Path], read: Iterable[object] = (), alternatives: int = 1) -> None:
    """Raise an error unless the path of a plan can be written to files of these names.

    Args:
        paths: files to write.
        read: the map and other inputs of the plan; those that are paths of files must stay.
        alternatives: number of paths, at most.

    Raises:
        SettingError: for an ending that is not in `FORMATS`, and as `swarm_gym.outputs.require_outputs`.
        MissingExtraError: for a PNG, if Pillow is missing.
    """
    named = [*paths]
    require_outputs([one for path in named for one in _files(path, alternatives)], read, FORMATS)
    for path in named:
        if path.suffix == ".png" and find_spec("PIL") is None:
            raise MissingExtraError(f"output {str(path)!r}", "Pillow", "maps")


def _files(path: Path, alternatives: int) -> list[Path]:
    """Return the files of an output: one for each alternative, or one for all if it is GeoJSON."""
    numbers = range(2, alternatives + 1) if path.suffix != ".geojson" else ()
    return [path, *(path.with_stem(f"{path.stem}-{number}") for number in numbers)]


def write_plan(plan: Plan, *paths: Path) -> list[Path]:
    """Write the path of a plan to files, each in the format that its ending names; return their names.

    A GeoJSON file has all alternatives. Those behind the first have files of their own in other formats,
    such as `path-2.csv` next to `path.csv`.

    No file is written before the contents of all are complete, and each is written completely or not at all.

    Raises:
        SettingError: for an ending that is not in `FORMATS`.
        MissingExtraError: for a PNG, if Pillow is missing.
        OSError: naming the first file that cannot be written; those before it are complete.
    """
    contents: dict[Path, str | bytes] = {}
    for path in paths:
        make = format_of(path, FORMATS)
        first, *others = _files(path, len(plan.alternatives))
        contents[first] = make(plan)
        for file, one in zip(others, _each(plan)[1:], strict=False):  # GeoJSON has all in one file
            contents[file] = make(one)
    write_all(contents)
    return list(contents)


def write_all(contents: Mapping[Path, str | bytes]) -> None:
    """Write files, each completely or not at all.

    Raises:
        OSError: naming the first file that cannot be written; those before it are complete.
    """
    for path, content in contents.items():
        try:
            write_atomically(path, content)
        except OSError as error:
            reason = error.strerror or str(error)
            raise OSError(f"output {str(path)!r}: cannot be written: {reason}") from error
