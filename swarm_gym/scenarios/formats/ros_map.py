"""Maps of ROS's map_server, a YAML file and an image: the scenarios `ros:<map>?start=<x>,<y>&goal=<x>,<y>`.

With `&unknown=` or `&lethal=` the map of a scenario has its grades, see `swarm_gym.scenarios.graded_map`.

Source: the documentation of map_server (http://wiki.ros.org/map_server) and of its successor in Nav2.

Map coordinates are metres, x to the right and y upwards. The key `mode` says what a grey value v means:

* `trinary`, the default: a cell is occupied with probability p = (255 - v) / 255, or v / 255 in a negated
  map. It is free where p < free_thresh, occupied where p > occupied_thresh, and unknown between them.
* `scale`: p is the same. Where p is at most free_thresh map_server publishes 0, and the cell is free. The
  values from 1 to 99 that it publishes between the thresholds are no promise that a cell is free.
* `raw`: v is the published value itself, p = v / 100 up to 100, and unknown above it. Map_server leaves it to
  the reader what is free; here it is p < free_thresh.
* `costmap`, which map_server does not know: v is the cost of a cell of a Nav2 cost map. Inscribed cells
  (253), lethal ones (254) and unknown ones (255) are not free. Thresholds may be left out.

`read_graded_ros_map` takes the values that map_server publishes as grades. In a map of free and blocked
cells, unknown cells count as blocked. A robot must not plan through an area that it has not seen. In every
mode a pixel that is not opaque is unknown. `ros_image` reads the pictures.
"""

import math
import re
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.family import Family, spaceless_beside_path
from swarm_gym.scenarios.formats.data_files import find_data_file, open_file, stamp_of
from swarm_gym.scenarios.formats.ros_image import ARRAYS, Picture, locate_picture, read_picture
from swarm_gym.scenarios.graded_map import SCALES, UNKNOWN_CELLS, GradedMap, Grading, graded
from swarm_gym.scenarios.grid_map import MAX_ORIGIN, MAX_RESOLUTION, MIN_RESOLUTION, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.obstacles import Point

NAME = "ros"
USAGE = (
    f"{NAME}:<map>?start=<x>,<y>&goal=<x>,<y>[&inflate=<radius>][&unknown=<{'|'.join(UNKNOWN_CELLS)}>]"
    "[&lethal=<value>]"
)

ENDINGS = (".yaml", ".yml")  # of the YAML file, in small letters
COSTMAP = "costmap"
MODES = ("trinary", "scale", "raw", COSTMAP)
ARRAY_MODES = ("raw", COSTMAP)  # of which the image may be an array
MAX_YAML = 2**16  # bytes
MAX_YAW = 1e-6  # radians that count as rounding: a map of 4096 cells turns by less than 0.005 cells
# Values of p * 255 that are usual for unknown cells: map_saver writes grey 205, other programs a middle grey.
UNKNOWN = (50, 127, 128)
_NUMBER = r"-?[0-9]{1,9}(?:\.[0-9]{1,15})?"


class RosMapFile(NamedTuple):
    """The content of a YAML file of map_server.

    Attributes:
        image: path of the image.
        resolution: side of a pixel in metres.
        origin: (x, y) of the outer corner of the lower left pixel, in metres.
        negate: whether white means occupied.
        free_thresh: probability of occupation below which a cell is free.
        occupied_thresh: probability of occupation above which a cell is occupied.
        mode: meaning of a grey value, one of `MODES`.
    """

    image: Path
    resolution: float
    origin: Point
    negate: bool
    free_thresh: float
    occupied_thresh: float
    mode: str


def read_yaml(path: str | Path) -> RosMapFile:
    """Read the YAML file of a map; keys that map_server does not know are skipped.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names file, key and value.
        MissingExtraError: if PyYAML is missing.
    """
    path = Path(path)
    entries = _Entries(path, _load(path))
    mode = entries.text("mode", MODES[0])
    if mode not in MODES:
        raise entries.refused("mode", f"one of {', '.join(MODES)}")
    is_costmap = mode == COSTMAP
    negate = entries.text("negate", "0" if is_costmap else None).lower()
    if negate not in ("0", "1", "false", "true"):
        raise entries.refused("negate", "0 or 1")
    if mode == "raw" and negate in ("1", "true"):
        raise entries.refused("negate", "0 in mode raw, where ROS 1 negates values and Nav2 does not")
    if is_costmap and negate in ("1", "true"):
        raise entries.refused("negate", "0 in mode costmap, where pixels are costs")
    usual = "0.5" if is_costmap else None
    occupied, free = (entries.number(f"{key}_thresh", 0, 1, usual) for key in ("occupied", "free"))
    if free > occupied:
        raise entries.refused("free_thresh", f"at most occupied_thresh, which is {occupied:g}")
    resolution = entries.number("resolution", MIN_RESOLUTION, MAX_RESOLUTION)
    image = locate_picture(path, entries.text("image"))
    if image.suffix.lower() == ARRAYS and mode not in ARRAY_MODES:
        raise entries.refused(
            "image", f"a picture in mode {mode}; an array has values of {' or '.join(ARRAY_MODES)}"
        )
    return RosMapFile(image, resolution, entries.origin(), negate in ("1", "true"), free, occupied, mode)


def read_ros_map(path: str | Path, radius: float = 0.0) -> GridMap:
    """Read the map of a YAML file and inflate it by a radius in metres.

    A warning counts the cells that are free though their grey value is usual for unknown cells.

    Raises:
        ScenarioError: if a file cannot be read or is malformed; the message names file and reason.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    path = Path(path)
    described = read_yaml(path)
    return _inflated(path, described, _stamp_of(path, described), radius)


def read_graded_ros_map(path: str | Path, grading: Grading) -> GradedMap:
    """Read the map of a YAML file with its grades: the values that map_server publishes, or costs of Nav2.

    The cells that are free in the map without grades are so here, too, and warnings are the same.

    Raises:
        ScenarioError: if a file cannot be read or is malformed; the message names file and reason.
        SettingError: for choices that the map cannot have.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    path = Path(path)
    described = read_yaml(path)
    grid = _read(path, described, _stamp_of(path, described))
    values = _published(described, _picture_of(path, described))
    return graded(grid, values, "costmap" if described.mode == COSTMAP else "occupancy", grading)


def expand(name: str) -> tuple[str, ...]:
    """Return the name itself; no file is read.

    Raises:
        ScenarioError: if the name has another form.
    """
    _parse(name)
    return (name,)


def tidy(name: str) -> str:
    """Return the name without spaces between its parts, and without `.yaml` in the data folder; `.yml` stays.

    Raises:
        ScenarioError: if the name has another form.
    """
    name = spaceless_beside_path(name)
    given = _parse(name).map
    short = given if Path(given).is_absolute() else given.removesuffix(".yaml")
    return name.replace(f":{given}", f":{short}", 1)


def make(name: str) -> GridScenario:
    """Return the scenario of that name; start, goal and radius are in metres.

    The map is the file `<map>.yaml` in the data folder, or in a folder of it as in `ros:house/map`. It may be
    an absolute path that ends with `.yaml`. A name that ends with `.yml` names the file itself. A radius
    blocks cells next to lethal ones, whatever their grades are.

    Raises:
        ScenarioError: if a file is missing or malformed, or there is no path from start to goal.
        SettingError: for a value of `lethal` that the map cannot have.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    given, start, goal, radius, grading = _parse(name)
    path = find_data_file(given if given.lower().endswith(ENDINGS) else f"{given}.yaml")
    if grading is None:
        return GridScenario(name, read_ros_map(path, radius), start, goal)
    read = read_graded_ros_map(path, grading)
    ground = read.on(read.grid.inflated(radius)) if radius else read
    return GridScenario(name, ground.grid, start, goal, ground)


FAMILY = Family(USAGE, (), expand, make, tidy)


def _stamp_of(path: Path, described: RosMapFile) -> tuple[int, int]:
    try:
        return stamp_of(described.image)
    except ScenarioError as error:
        raise ScenarioError(f"{path}: image {error}") from error


@lru_cache(maxsize=8)
def _inflated(path: Path, described: RosMapFile, stamp: tuple[int, int], radius: float) -> GridMap:
    grid = _read(path, described, stamp)
    return grid.inflated(radius) if radius else grid


@lru_cache(maxsize=8)
def _read(path: Path, described: RosMapFile, _stamp: tuple[int, int]) -> GridMap:
    picture = _picture_of(path, described)
    probability = _probabilities(described, picture.white)
    # Unknown cells are blocked like occupied ones, so occupied_thresh decides nothing.
    free_levels = _is_free(described, probability)
    free = free_levels[picture.levels]
    if picture.opaque is not None:
        free &= picture.opaque
    if described.mode not in ARRAY_MODES:
        suspect = free_levels & np.isin(np.rint(255 * probability), UNKNOWN)
        _warn_of_unknown(path, described, probability, picture.levels, suspect, free)
    side, (x, y) = described.resolution, described.origin
    return GridMap(path.stem, ~free, side, (x + side / 2, y + (len(free) - 0.5) * side), y_up=True)


def _picture_of(path: Path, described: RosMapFile) -> Picture:
    picture = read_picture(described.image)
    if described.mode == COSTMAP and picture.white != 255:
        raise ScenarioError(
            f"{path}: mode costmap needs costs from 0 to 255, the image {described.image.name} has colours "
            "or 16 bits; save it as a grey PNG of 8 bits or as an array of uint8"
        )
    return picture


def _published(described: RosMapFile, picture: Picture) -> NDArray[np.int64]:
    """Return the values of the cells, row 0 on top: as map_server publishes them, or costs of Nav2."""
    levels = np.arange(picture.white + 1)
    if described.mode in ARRAY_MODES:
        values = np.rint(255 * levels / picture.white).astype(np.int64)
        unknown = 255 if described.mode == COSTMAP else -1
        if described.mode == "raw":
            values[values > 100] = unknown
    else:
        probability = _probabilities(described, picture.white)
        low, high = described.free_thresh, described.occupied_thresh
        unknown = -1
        values = np.full(len(levels), unknown, dtype=np.int64)
        if described.mode == "scale":
            share = (probability - low) / max(high - low, 1e-9)
            values = np.floor(99.0 * np.clip(share, 0.0, 1.0)).astype(np.int64)
        values[probability > high] = 100
        values[_is_free(described, probability)] = 0
    published = values[picture.levels]
    if picture.opaque is not None:
        published[~picture.opaque] = unknown
    return published


def _is_free(described: RosMapFile, probability: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which probabilities mean free cells."""
    below = np.less_equal if described.mode == "scale" else np.less
    return below(probability, described.free_thresh)


def _probabilities(described: RosMapFile, white: int) -> NDArray[np.float64]:
    """Return the probability of being occupied for each level from black to white; unknown is 1."""
    levels = np.arange(white + 1)
    if described.mode == "raw":
        published = np.rint(255 * levels / white)
        return np.where(published <= 100, published / 100, 1.0)
    if described.mode == COSTMAP:
        return (levels >= SCALES["costmap"].lethal).astype(np.float64)
    return (levels if described.negate else white - levels) / white


def _warn_of_unknown(
    path: Path,
    described: RosMapFile,
    probability: NDArray[np.float64],
    levels: NDArray[Any],
    suspect: NDArray[np.bool_],
    free: NDArray[np.bool_],
) -> None:
    """Warn of cells that are free though their grey value, one of the suspect levels, means unknown."""
    found = levels[suspect[levels] & free] if suspect.any() else levels[:0]
    if found.size:
        greys = sorted({round(255 * level / (len(suspect) - 1)) for level in np.unique(found).tolist()})
        below = math.floor(1000 * probability[found].min()) / 1000
        usual = f"{found.size:,} cells of grey {' and '.join(map(str, greys))}, usual for unknown cells"
        change = f"change free_thresh from {described.free_thresh:g} to {below:g} to block them"
        warnings.warn(
            f"{path}: {usual}, count as free; {change}",
            stacklevel=4,
        )


class _Parts(NamedTuple):
    """The parts of a scenario's name; the grading is None for free and blocked cells alone."""

    map: str
    start: Point
    goal: Point
    radius: float
    grading: Grading | None


def _parse(name: str) -> _Parts:
    """Return the parts of a scenario's name."""
    point = f"({_NUMBER}),({_NUMBER})"
    match = re.fullmatch(
        rf"{NAME}:(.+?)\?start={point}&goal={point}(?:&inflate=([0-9]{{1,9}}(?:\.[0-9]{{1,15}})?))?"
        rf"(?:&unknown=({'|'.join(UNKNOWN_CELLS)}))?(?:&lethal=([0-9]{{1,3}}))?",
        name,
    )
    if not match:
        raise ScenarioError(f"scenario {shown(name)}: expected {USAGE}, with decimal numbers, in metres")
    given, *numbers, unknown, lethal = match.groups()
    if Path(given).is_absolute() and not given.lower().endswith(ENDINGS):
        raise ScenarioError(
            f"scenario {shown(name)}: an absolute path to a map must end with .yaml or .yml, got "
            f"{shown(given)}"
        )
    x, y, goal_x, goal_y, radius = (float(number or 0) for number in numbers)
    is_graded = unknown is not None or lethal is not None
    grading = (
        Grading(unknown or UNKNOWN_CELLS[0], None if lethal is None else int(lethal)) if is_graded else None
    )
    return _Parts(given, (x, y), (goal_x, goal_y), radius, grading)


class _Entries:
    """The entries of a YAML file, checked when they are read."""

    def __init__(self, path: Path, entries: dict[Any, Any]):
        self._path = path
        self._entries = entries

    def refused(self, key: str, expected: str) -> ScenarioError:
        return ScenarioError(f"{self._path}: {key} must be {expected}, got {shown(self._entries[key])}")

    def text(self, key: str, default: str | None = None) -> str:
        if key not in self._entries:
            if default is None:
                raise ScenarioError(
                    f"{self._path}: the key {key!r} is missing; add it as map_server writes it"
                )
            return default
        if not isinstance(self._entries[key], str):
            raise self.refused(key, "a single value")
        return self._entries[key]

    def number(self, key: str, low: float, high: float, default: str | None = None) -> float:
        number = _as_number(self.text(key, default))
        if not low <= number <= high:
            raise self.refused(key, f"a number in [{low:g}, {high:g}]")
        return number

    def origin(self) -> Point:
        if "origin" not in self._entries:
            raise ScenarioError(f"{self._path}: the key 'origin' is missing; add it as map_server writes it")
        values = self._entries["origin"]
        numbers = [_as_number(value) for value in values] if isinstance(values, list) else []
        if len(numbers) != 3 or not all(abs(number) <= MAX_ORIGIN for number in numbers):
            raise self.refused("origin", f"[x, y, yaw], in metres and radians, at most {MAX_ORIGIN:g}")
        x, y, yaw = numbers
        if abs(math.remainder(yaw, math.tau)) > MAX_YAW:
            raise self.refused(
                "origin",
                f"[x, y, 0], since maps that are turned are not supported: turn the picture by "
                f"{math.degrees(yaw):g} degrees counter-clockwise",
            )
        return x, y


def _as_number(value: object) -> float:
    """Return the number that a text stands for, or NaN, which lies in no interval, if it is no number."""
    if not isinstance(value, str) or not re.fullmatch(r"[-+]?[0-9.]{1,40}([eE][-+]?[0-9]{1,3})?", value):
        return math.nan
    try:
        return float(value)
    except ValueError:
        return math.nan


def _load(path: Path) -> dict[Any, Any]:
    try:
        import yaml
    except ImportError as error:
        raise MissingExtraError(f"map {path}", "PyYAML", "maps") from error
    try:
        with open_file(path) as file:
            content = file.read(MAX_YAML + 1)
        if len(content) > MAX_YAML:
            raise ScenarioError(f"{path}: expected at most {MAX_YAML} bytes, the file has more")
        # Every scalar stays a text, because YAML 1.1 has surprising rules: `5e-2` is not a number.
        entries = yaml.load(content, Loader=yaml.BaseLoader)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    except (yaml.YAMLError, UnicodeError, RecursionError) as error:
        raise ScenarioError(f"{path}: expected a YAML file: {' '.join(str(error).split())}") from error
    if not isinstance(entries, dict):
        raise ScenarioError(
            f"{path}: expected keys and values, as map_server writes them, got {shown(entries)}"
        )
    return entries
