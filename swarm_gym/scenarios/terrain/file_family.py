"""Flights over ground in files: the scenarios `terrain-file:<path>?start=<x>,<y>,<height>&goal=...`.

The file is an elevation model: `.asc` (ESRI ASCII grid), `.hgt` (SRTM) or `.tif` (GeoTIFF). x and y are
longitude and latitude where the file is in degrees. Heights are above ground, in metres. These parts may
follow:

* `&threats=<path>`: a GeoJSON file of points with a radius, see `formats.threat_file`;
* `&altitude=<least>-<greatest>`: heights above ground that are allowed, 100-200 by default;
* `&turn=<degrees>` and `&climb=<degrees>`: largest turn and climb, 45 by default;
* `&coordinates=longitude-latitude`: for a file in metres that names its reference system.
"""

import re

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import Family, spaceless
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.terrain.scenario import TerrainScenario
from swarm_gym.scenarios.terrain.survey import Limits, Survey, survey

NAME = "terrain-file"
USAGE = (
    f"{NAME}:<path>?start=<x>,<y>,<height>&goal=<x>,<y>,<height>"
    "[&threats=<path>][&altitude=<least>-<greatest>]"
)

OPTIONS = ("threats", "altitude", "turn", "climb", "coordinates")
_NUMBER = r"-?[0-9]{1,9}(?:\.[0-9]{1,15})?"


def expand(name: str) -> tuple[str, ...]:
    """Return the name itself; no file is read.

    Raises:
        ScenarioError: if the name has another form.
    """
    _parse(name)
    return (name,)


def make(name: str) -> TerrainScenario:
    """Return the scenario of that name.

    Raises:
        ScenarioError: if a file is missing or malformed, or a start or goal that cannot be.
        MissingExtraError: if rasterio or pyproj is missing and needed.
    """
    return surveyed(name).scenario


def surveyed(name: str, limits: Limits | None = None) -> Survey:
    """Return the scenario of that name with its coordinates.

    Args:
        name: name of the scenario.
        limits: limits that take the place of those in the name.
    """
    path, start, goal, options = _parse(name)
    least, greatest = _numbers(name, "altitude", options.get("altitude", "100-200"), "-", 2)
    (turn,) = _numbers(name, "turn", options.get("turn", "45"), ",", 1)
    (climb,) = _numbers(name, "climb", options.get("climb", "45"), ",", 1)
    threats = options.get("threats")
    all_limits: Limits = {"altitude": (least, greatest), "largest_turn": turn, "largest_climb": climb}
    all_limits.update(limits or {})
    return survey(
        find_data_file(path),
        start,
        goal,
        name=name,
        threats=None if threats is None else find_data_file(threats),
        coordinates=options.get("coordinates"),
        **all_limits,
    )


def _tidy(name: str) -> str:
    """Return a name without needless spaces; those inside the paths of its files stay."""
    path, mark, options = name.strip(" ").partition("?")
    family, _, path = path.partition(":")
    parts = [
        f"threats={part.partition('=')[2].strip(' ')}"
        if part.strip(" ").startswith("threats")
        else spaceless(part)
        for part in options.split("&")
    ]
    return f"{family.strip(' ')}:{path.strip(' ')}{mark}{'&'.join(parts)}"


FAMILY = Family(USAGE, (), expand, make, _tidy)

_Point = tuple[float, float, float]


def _parse(name: str) -> tuple[str, _Point, _Point, dict[str, str]]:
    """Return path, start, goal and the other parts by name."""
    point = f"({_NUMBER}),({_NUMBER}),({_NUMBER})"
    match = re.fullmatch(rf"{NAME}:([^?&]+)\?start={point}&goal={point}((?:&[a-z]+=[^&]+)*)", name)
    if not match:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, with decimal numbers, heights in metres"
        )
    x, y, height, goal_x, goal_y, goal_height = map(float, match.groups()[1:7])
    options: dict[str, str] = {}
    for part in match[8].split("&")[1:]:
        key, _, value = part.partition("=")
        if key not in OPTIONS or key in options:
            raise ScenarioError(
                f"scenario {shown(name)}: expected each of {', '.join(OPTIONS)} once, got {shown(part)}"
            )
        options[key] = value
    return match[1], (x, y, height), (goal_x, goal_y, goal_height), options


def _numbers(name: str, key: str, text: str, between: str, count: int) -> tuple[float, ...]:
    """Return the numbers of a part of a name."""
    found = re.fullmatch(between.join([r"([0-9]{1,9}(?:\.[0-9]{1,15})?)"] * count), text)
    if not found:
        example = "100-200" if count == 2 else "45"
        raise ScenarioError(
            f"scenario {shown(name)}: {key} must be a text such as {example}, got {shown(text)}"
        )
    return tuple(map(float, found.groups()))
