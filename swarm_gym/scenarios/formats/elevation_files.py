"""Files of elevation models by the ending of their names: ESRI ASCII grid, SRTM and GeoTIFF.

`.hgt` are files of the Shuttle Radar Topography Mission: one degree, whose south-west corner is in the name.
Source: "SRTM data format" of the NASA Land Processes DAAC. Heights are big-endian integers in metres, 1201 or
3601 in a row and as many rows, from north to south. The outermost ones lie on whole degrees. -32768 is a gap.

rasterio reads GeoTIFF files; the first band counts.
"""

import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.formats import esri_grid
from swarm_gym.scenarios.formats.data_files import open_file
from swarm_gym.scenarios.formats.elevation import Elevation, require_posts, with_kind
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC

SIDES = (1201, 3601)  # of 3 and 1 seconds of arc
GAP = -32768
METRES = (None, "", "m", "metre", "metres", "meter", "meters")


def read_srtm(path: Path) -> Elevation:
    """Return the content of a file of SRTM.

    Raises:
        ScenarioError: if the file cannot be read, or its name or size is another one.
    """
    match = re.match(r"([NS])(\d{2})([EW])(\d{3})", path.name, re.IGNORECASE)
    if not match or int(match[2]) > 90 or int(match[4]) > 180:
        raise ScenarioError(
            f"{path}: expected a name that begins with the south-west corner, such as N46E007.hgt, got "
            f"{shown(path.name)}"
        )
    latitude = int(match[2]) * (-1 if match[1] in "sS" else 1)
    longitude = int(match[4]) * (-1 if match[3] in "wW" else 1)
    try:
        with open_file(path) as file:
            content = file.read(2 * SIDES[-1] ** 2 + 1)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    sides = {2 * side * side: side for side in SIDES}
    if len(content) not in sides:
        raise ScenarioError(
            f"{path}: expected {' or '.join(map(str, sides))} bytes, for {' or '.join(map(str, SIDES))} "
            f"heights in a row, got {len(content)}{' or more' if len(content) > max(sides) else ''}; is the "
            "file whole?"
        )
    side = sides[len(content)]
    heights = np.frombuffer(content, dtype=">i2").reshape(side, side)[::-1].astype(np.float64)
    heights[heights == GAP] = np.nan
    step = 1.0 / (side - 1)
    return Elevation(
        path, heights, (float(longitude), float(latitude)), (step, step), GEOGRAPHIC, "EPSG:4326"
    )


def read_geotiff(path: Path) -> Elevation:
    """Return the content of a GeoTIFF; heights are at the centres of pixels.

    Raises:
        ScenarioError: if the file cannot be read, has no place on the earth, is turned, or is not in metres.
        MissingExtraError: if rasterio is missing.
    """
    try:
        import rasterio
    except ImportError as error:
        raise MissingExtraError(f"map {path}", "rasterio", "terrain") from error
    try:
        with open_file(path), warnings.catch_warnings():
            # A file without a place is refused below.
            warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
            with rasterio.open(path, driver="GTiff") as file:
                return _content_of_geotiff(path, file)
    except (OSError, rasterio.errors.RasterioError) as error:
        reason = " ".join(str(error.__cause__ or error).split())  # rasterio names the cause in another one
        whole = "; is the file whole?" if error.__cause__ else ""
        raise ScenarioError(f"{path}: cannot be read as GeoTIFF: {reason}{whole}") from error


def _content_of_geotiff(path: Path, file: Any) -> Elevation:
    require_posts(path, file.height, file.width)
    dtype = np.dtype(file.dtypes[0])
    if dtype.kind not in "iuf":
        raise ScenarioError(f"{path}: expected real numbers as heights, got {dtype}")
    if file.count > 1:
        warnings.warn(f"{path}: {file.count} bands, of which the first is read as heights", stacklevel=4)
    place = file.transform
    if place.is_identity:
        raise ScenarioError(
            f"{path}: the file has no place on the earth; expected a GeoTIFF with a geotransform"
        )
    if place.b or place.d or not (place.a > 0.0 and place.e < 0.0):
        raise ScenarioError(
            f"{path}: expected rows from north to south and columns from west to east, the picture is "
            f"turned: {shown(tuple(place)[:6])}; warp it first, for example with gdalwarp"
        )
    unit = file.units[0]
    if unit is not None and unit.strip().lower() not in METRES:
        raise ScenarioError(
            f"{path}: expected heights in metres, got the unit {shown(unit)}; convert the file first"
        )
    heights = file.read(1, masked=True).astype(np.float64) * file.scales[0] + file.offsets[0]
    values = heights.filled(np.nan)
    values[~np.isfinite(values)] = np.nan
    system = None if file.crs is None else file.crs.to_wkt()
    west, north = place.c + place.a / 2.0, place.f + place.e / 2.0
    south = north + place.e * (file.height - 1)
    return with_kind(Elevation(path, values[::-1], (west, south), (place.a, -place.e), system=system))


READERS: dict[str, Callable[[Path], Elevation]] = {  # endings in any case
    ".asc": esri_grid.read,
    ".hgt": read_srtm,
    ".tif": read_geotiff,
    ".tiff": read_geotiff,
}


def read_elevation(path: Path) -> Elevation:
    """Return the content of an elevation model; the ending of the name says which kind of file it is.

    Raises:
        ScenarioError: if the ending is another one, or the file cannot be read, is malformed or has no
            height.
        MissingExtraError: for a GeoTIFF, if rasterio is missing.
    """
    ending = path.suffix.lower()
    if ending not in READERS:
        raise ScenarioError(
            f"map {shown(str(path))}: expected an elevation model: {', '.join(READERS)}, got "
            f"{ending or 'no ending'}"
        )
    found = READERS[ending](path)
    rows, columns = found.heights.shape
    if min(rows, columns) < 2:
        raise ScenarioError(
            f"{path}: expected at least 2 rows and columns of heights, got {rows} x {columns}"
        )
    if not np.isfinite(found.heights).any():
        raise ScenarioError(f"{path}: no heights; all {rows * columns} cells have no data")
    if found.kind == GEOGRAPHIC:
        x_min, y_min, x_max, y_max = found.box
        if x_min < -180.5 or x_max > 180.5 or y_min < -90.5 or y_max > 90.5:
            raise ScenarioError(
                f"{path}: expected longitudes in [-180, 180] and latitudes in [-90, 90], got {found.box}"
            )
    return found
