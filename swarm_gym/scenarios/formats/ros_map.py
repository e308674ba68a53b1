"""Maps of ROS's map_server, a YAML file and an image: the scenarios `ros:<map>?start=<x>,<y>&goal=<x>,<y>`.

Source: the documentation of map_server (http://wiki.ros.org/map_server) and of its successor in Nav2.

Map coordinates are metres, x to the right and y upwards. A pixel of grey value v is occupied with probability
p = (255 - v) / 255, or v / 255 in a negated map. It is blocked where p > occupied_thresh, free where p <
free_thresh, and unknown between them. Unknown cells count as blocked, because a robot must not plan through
an area that it has not seen.
"""

import io
import math
import os
import re
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.family import Family, spaceless
from swarm_gym.scenarios.formats.data_files import find_data_file, open_file, require_inside, stamp_of
from swarm_gym.scenarios.grid_map import MAX_RESOLUTION, MAX_SIDE, MIN_RESOLUTION, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.obstacles import Point

NAME = "ros"
USAGE = f"{NAME}:<map>?start=<x>,<y>&goal=<x>,<y>[&inflate=<radius>]"

MAX_YAML = 2**16  # bytes
MAX_IMAGE = 2**26  # bytes, enough for all pixels as decimal numbers
MAX_COORDINATE = 1e6  # metres
_NUMBER = r"-?[0-9]{1,9}(?:\.[0-9]{1,15})?"


class RosMapFile(NamedTuple):
    """The content of a YAML file of map_server.

    Attributes:
        image: path of the image.
        resolution: side of a pixel in metres.
        origin: (x, y) of the outer corner of the lower left pixel, in metres.
        negate: whether white means occupied.
        free_thresh: probability of occupation below which a cell is free.
    """

    image: Path
    resolution: float
    origin: Point
    negate: bool
    free_thresh: float


def read_yaml(path: str | Path) -> RosMapFile:
    """Read the YAML file of a map; keys that map_server does not know are skipped.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names file, key and value.
        MissingExtraError: if PyYAML is missing.
    """
    path = Path(path)
    entries = _Entries(path, _load(path))
    mode = entries.text("mode", "trinary")
    if mode != "trinary":
        raise entries.refused("mode", "'trinary'")
    negate = entries.text("negate").lower()
    if negate not in ("0", "1", "false", "true"):
        raise entries.refused("negate", "0 or 1")
    occupied, free = entries.number("occupied_thresh", 0, 1), entries.number("free_thresh", 0, 1)
    if free > occupied:
        raise entries.refused("free_thresh", f"at most occupied_thresh, which is {occupied:g}")
    resolution = entries.number("resolution", MIN_RESOLUTION, MAX_RESOLUTION)
    return RosMapFile(entries.image(), resolution, entries.origin(), negate in ("1", "true"), free)


def read_ros_map(path: str | Path, radius: float = 0.0) -> GridMap:
    """Read the map of a YAML file and inflate it by a radius in metres.

    Raises:
        ScenarioError: if a file cannot be read or is malformed; the message names file and reason.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    path = Path(path)
    described = read_yaml(path)
    return _read(path.stem, described, stamp_of(described.image), radius)


def expand(name: str) -> tuple[str, ...]:
    """Return the name itself; no file is read.

    Raises:
        ScenarioError: if the name has another form.
    """
    _parse(name)
    return (name,)


def tidy(name: str) -> str:
    """Return the name without spaces between its parts, and without `.yaml` in the data folder.

    Raises:
        ScenarioError: if the name has another form.
    """
    name = spaceless(name)
    given, *_ = _parse(name)
    short = given if Path(given).is_absolute() else given.removesuffix(".yaml")
    return name.replace(f":{given}", f":{short}", 1)


def make(name: str) -> GridScenario:
    """Return the scenario of that name; start, goal and radius are in metres.

    The map is the file `<map>.yaml` in the data folder, or in a folder of it as in `ros:house/map`, or an
    absolute path that ends with `.yaml`.

    Raises:
        ScenarioError: if a file is missing or malformed, or there is no path from start to goal.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    given, start, goal, radius = _parse(name)
    path = find_data_file(given if Path(given).is_absolute() else f"{given}.yaml")
    return GridScenario(name, read_ros_map(path, radius), start, goal)


FAMILY = Family(USAGE, (), expand, make, tidy)


@lru_cache(maxsize=8)
def _read(name: str, described: RosMapFile, _stamp: tuple[int, int], radius: float) -> GridMap:
    grey = np.arange(256)
    probability = (grey if described.negate else 255 - grey) / 255
    # Unknown cells are blocked like occupied ones, so occupied_thresh decides nothing.
    blocked = (probability >= described.free_thresh)[_read_grey(described.image)]
    side, (x, y) = described.resolution, described.origin
    grid = GridMap(name, blocked, side, (x + side / 2, y + (len(blocked) - 0.5) * side), y_up=True)
    return grid.inflated(radius) if radius else grid


def _parse(name: str) -> tuple[str, Point, Point, float]:
    """Return map, start, goal and radius."""
    point = f"({_NUMBER}),({_NUMBER})"
    match = re.fullmatch(
        rf"{NAME}:(.+?)\?start={point}&goal={point}(?:&inflate=([0-9]{{1,9}}(?:\.[0-9]{{1,15}})?))?", name
    )
    if not match:
        raise ScenarioError(f"scenario {shown(name)}: expected {USAGE}, with decimal numbers, in metres")
    given, *numbers = match.groups()
    if Path(given).is_absolute() and not given.endswith(".yaml"):
        raise ScenarioError(
            f"scenario {shown(name)}: an absolute path to a map must end with .yaml, got {shown(given)}"
        )
    x, y, goal_x, goal_y, radius = (float(number or 0) for number in numbers)
    return given, (x, y), (goal_x, goal_y), radius


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

    def number(self, key: str, low: float, high: float) -> float:
        number = _as_number(self.text(key))
        if not low <= number <= high:
            raise self.refused(key, f"a number in [{low:g}, {high:g}]")
        return number

    def origin(self) -> Point:
        if "origin" not in self._entries:
            raise ScenarioError(f"{self._path}: the key 'origin' is missing; add it as map_server writes it")
        values = self._entries["origin"]
        numbers = [_as_number(value) for value in values] if isinstance(values, list) else []
        if len(numbers) != 3 or not all(abs(number) <= MAX_COORDINATE for number in numbers):
            raise self.refused("origin", f"[x, y, yaw], in metres and radians, at most {MAX_COORDINATE:g}")
        if numbers[2] != 0:
            raise self.refused("origin", "[x, y, 0], since maps that are turned by a yaw are not supported")
        return numbers[0], numbers[1]

    def image(self) -> Path:
        given = self.text("image")
        path = Path(given)
        if not given.isprintable() or not path.name:
            raise self.refused("image", "a file name")
        if not path.is_absolute() and (".." in path.parts or path.drive or path.root):
            raise self.refused("image", "a file in the folder of the YAML file")
        # A YAML file must not choose which files are opened. ROS writes absolute paths into its own folder.
        require_inside(self._path.parent, self._path.parent / path)
        return self._path.parent / path


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


def _read_grey(path: Path) -> NDArray[np.uint8]:
    """Return the grey values of an image, shape (height, width), first row on top."""
    try:
        from PIL import Image
    except ImportError as error:
        raise MissingExtraError(f"image {path}", "Pillow", "maps") from error
    try:
        with open_file(path) as file:
            size = os.fstat(file.fileno()).st_size
            if size > MAX_IMAGE:
                raise ScenarioError(f"{path}: expected at most {MAX_IMAGE} bytes, got {size}")
            # Decoding from memory, since a decoder asks a file for as many bytes as its header claims.
            content = io.BytesIO(file.read())
        with warnings.catch_warnings():
            # The check below is stricter than Pillow's warning.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(content, formats=("PPM", "PNG"))
            width, height = image.size
            # Checked before any pixel is decoded.
            if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
                raise ScenarioError(
                    f"{path}: expected at most {MAX_SIDE} cells along a side, got {width} x {height}"
                )
            if image.mode not in ("1", "L"):
                raise ScenarioError(
                    f"{path}: expected a grey image of at most 8 bits, without transparency, got mode "
                    f"{image.mode!r}"
                )
            return np.array(image.convert("L"))
    except ScenarioError:
        raise
    except Exception as error:  # a decoder may raise anything on malformed bytes
        raise ScenarioError(f"{path}: cannot be read as a PGM or PNG image: {error}") from error
