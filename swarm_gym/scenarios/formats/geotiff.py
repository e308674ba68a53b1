"""GeoTIFF files with heights, which rasterio reads; the first band counts."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file
from swarm_gym.scenarios.formats.elevation import Elevation, require_posts
from swarm_gym.scenarios.formats.geographic import PLANE, kind_of_system

METRES = (None, "", "m", "metre", "metres", "meter", "meters")


def read(path: Path) -> Elevation:
    """Return the content of a file; heights are at the centres of pixels.

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
            warnings.simplefilter("ignore")  # a file without a place is refused below
            with rasterio.open(path, driver="GTiff") as file:
                return _content(path, file)
    except (OSError, rasterio.errors.RasterioError) as error:
        raise ScenarioError(f"{path}: cannot be read as GeoTIFF: {' '.join(str(error).split())}") from error


def _content(path: Path, file: Any) -> Elevation:
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
    kind = PLANE if system is None else kind_of_system(str(path), system)
    west, north = place.c + place.a / 2.0, place.f + place.e / 2.0
    south = north + place.e * (file.height - 1)
    return Elevation(path, values[::-1], (west, south), (place.a, -place.e), kind, system)
