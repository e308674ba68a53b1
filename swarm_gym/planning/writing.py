"""Files with a path: CSV, GeoJSON, ROS's nav_msgs/Path as YAML, or a picture, by the ending of the name."""

import json
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from swarm_gym.errors import MissingExtraError, SettingError
from swarm_gym.files import write_atomically
from swarm_gym.planning.drawing import as_png, as_svg
from swarm_gym.planning.result import Plan


def as_csv(plan: Plan) -> str:
    """Return lines `x,y` below a head, in the coordinates of the map's file."""
    return "".join(["x,y\n", *(f"{x!r},{y!r}\n" for x, y in plan.path.tolist())])


def as_geojson(plan: Plan) -> str:
    """Return a feature with a line string, in the coordinates of the map's file."""
    facts: dict[str, Any] = {
        "map": plan.map.name,
        "length": plan.length,
        "evaluations": plan.evaluations,
        "found_by": plan.found_by,
    }
    if np.isfinite(plan.clearance):
        facts["clearance"] = plan.clearance
    geometry = {"type": "LineString", "coordinates": plan.path.tolist()}
    return json.dumps({"type": "Feature", "properties": facts, "geometry": geometry}, indent=1) + "\n"


def as_ros_path(plan: Plan) -> str:
    """Return a message nav_msgs/Path in the frame `map`; poses look along the path."""
    headings = np.arctan2(*np.diff(plan.path_on_map, axis=0).T[::-1])
    lines = ["header:", "  frame_id: map", "poses:"]
    for (x, y), heading in zip(plan.path.tolist(), [*headings.tolist(), headings[-1]], strict=True):
        sin, cos = np.sin(heading / 2.0), np.cos(heading / 2.0)
        lines += [
            "- header:",
            "    frame_id: map",
            "  pose:",
            f"    position: {{x: {x!r}, y: {y!r}, z: 0.0}}",
            f"    orientation: {{x: 0.0, y: 0.0, z: {sin:.17g}, w: {cos:.17g}}}",
        ]
    return "\n".join(lines) + "\n"


FORMATS: dict[str, Callable[[Plan], str | bytes]] = {
    ".csv": as_csv,
    ".geojson": as_geojson,
    ".yaml": as_ros_path,
    ".svg": as_svg,
    ".png": as_png,
}


def require_formats(paths: Iterable[Path]) -> None:
    """Raise an error unless the path of a plan can be written to files of these names.

    Raises:
        SettingError: for an ending that is not in `FORMATS`, a folder, or a name that is given twice.
        MissingExtraError: for a PNG, if Pillow is missing.
    """
    seen = set()
    for path in paths:
        _format_of(path)
        if path.is_dir():
            raise SettingError(f"output {str(path)!r}: a folder; name a file in it")
        if path.suffix == ".png" and find_spec("PIL") is None:
            raise MissingExtraError(f"output {str(path)!r}", "Pillow", "maps")
        if path in seen:
            raise SettingError(f"output {str(path)!r}: given twice; name each file once")
        seen.add(path)


def write_plan(plan: Plan, *paths: Path) -> None:
    """Write the path of a plan to files, each in the format that its ending names.

    No file is written before the contents of all are complete, and each is written completely or not at all.

    Raises:
        SettingError: for an ending that is not in `FORMATS`.
        MissingExtraError: for a PNG, if Pillow is missing.
        OSError: naming the first file that cannot be written; those before it are complete.
    """
    contents = [_format_of(path)(plan) for path in paths]
    for path, content in zip(paths, contents, strict=True):
        write_atomically(path, content)


def _format_of(path: Path) -> Callable[[Plan], str | bytes]:
    """Return the function that makes the content of a file of that name."""
    if path.suffix not in FORMATS:
        raise SettingError(f"output {str(path)!r}: the name must end with {', '.join(FORMATS)}")
    return FORMATS[path.suffix]
