"""ESRI ASCII grids: a head with the place of the cells, then heights row by row from north to south.

Source: "Esri ASCII raster format" in the documentation of ArcGIS. Heights are at the centres of cells. The
file `.prj` of the same name has the coordinate reference system.
"""

import codecs
import re
import warnings
from pathlib import Path

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file
from swarm_gym.scenarios.formats.elevation import MAX_FILE, Elevation, Floats, require_posts, with_kind

KEYS = (
    "ncols",
    "nrows",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
)
NO_DATA = -9999.0  # where the head does not say it
MAX_PRJ = 2**16  # bytes


def read(path: Path) -> Elevation:
    """Return the content of a file.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names the key or the value.
    """
    try:
        with open_file(path) as file:
            content = file.read(MAX_FILE + 1)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    if len(content) > MAX_FILE:
        raise ScenarioError(f"{path}: expected at most {MAX_FILE} bytes, the file has more")
    head, body = _split(path, content)
    columns, rows = _count(path, head, "ncols"), _count(path, head, "nrows")
    require_posts(path, rows, columns)
    dx = head["dx"] if "dx" in head else _needed(path, head, "cellsize")
    dy = head["dy"] if "dy" in head else _needed(path, head, "cellsize")
    if not (0.0 < dx < np.inf and 0.0 < dy < np.inf):
        raise ScenarioError(f"{path}: expected a positive cellsize, got {dx:g} x {dy:g}")
    x, y = _first(path, head, "x", dx), _first(path, head, "y", dy)
    heights = _numbers(path, body)
    if len(heights) != rows * columns:
        raise ScenarioError(
            f"{path}: expected {rows} x {columns} = {rows * columns} heights, got {len(heights)}; is the "
            "file whole?"
        )
    heights[heights == head.get("nodata_value", NO_DATA)] = np.nan
    heights[~np.isfinite(heights)] = np.nan
    heights = heights.reshape(rows, columns)[::-1]
    return with_kind(Elevation(path, heights, (x, y), (dx, dy), system=_system(path)))


def _split(path: Path, content: bytes) -> tuple[dict[str, float], bytes]:
    """Return the entries of the head, with names in small letters, and the bytes behind it."""
    content = content.removeprefix(codecs.BOM_UTF8)
    head: dict[str, float] = {}
    place = 0
    for match in re.finditer(
        rb"[ \t\r\n]*([A-Za-z_]{2,20})[ \t]+(\S{1,40})[ \t]*(?:\r\n?|\n|$)", content[:2000]
    ):
        name = match[1].decode().lower()
        if match.start() != place or name not in KEYS:
            break
        try:
            head[name] = float(match[2])
        except ValueError as error:
            raise ScenarioError(
                f"{path}: {name} must be a number, got {shown(match[2].decode('latin-1'))}"
            ) from error
        place = match.end()
    return head, content[place:]


def _needed(path: Path, head: dict[str, float], *names: str) -> float:
    for name in names:
        if name in head:
            return head[name]
    raise ScenarioError(
        f"{path}: the key {' or '.join(names)} is missing; expected the head of an ESRI ASCII grid: ncols, "
        "nrows, xllcorner, yllcorner, cellsize"
    )


def _count(path: Path, head: dict[str, float], name: str) -> int:
    number = _needed(path, head, name)
    if not number.is_integer():
        raise ScenarioError(f"{path}: {name} must be a whole number, got {number:g}")
    return int(number)


def _first(path: Path, head: dict[str, float], axis: str, step: float) -> float:
    """Return the coordinate of the centre of the first column, or of the southernmost row."""
    centre = f"{axis}llcenter"
    value = head[centre] if centre in head else _needed(path, head, f"{axis}llcorner", centre) + step / 2.0
    if not abs(value) <= 1e9:
        raise ScenarioError(f"{path}: {axis}llcorner must be finite and at most 1e9 in size, got {value:g}")
    return value


def _numbers(path: Path, body: bytes) -> Floats:
    """Return all numbers of a text.

    Raises:
        ScenarioError: naming the first word that is no number.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            found: Floats = np.fromstring(body.decode("latin-1"), dtype=np.float64, sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise ScenarioError(f"{path}: expected numbers as heights, got {_odd_word(body)}") from error
    return found


def _odd_word(body: bytes) -> str:
    for word in body.split():
        try:
            float(word)
        except ValueError:
            return shown(word.decode("latin-1"))
    return "something else"


def _system(path: Path) -> str | None:
    """Return the text of the file `.prj` or `.PRJ` next to a grid; None without one."""
    for ending in (".prj", ".PRJ"):
        try:
            with open_file(path.with_suffix(ending)) as file:
                return file.read(MAX_PRJ).decode("utf-8", "replace").strip() or None
        except OSError:
            continue
    return None
