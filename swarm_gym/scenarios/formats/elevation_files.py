"""Files of elevation models by the ending of their names: ESRI ASCII grid, SRTM and GeoTIFF."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats import esri_grid, geotiff, srtm
from swarm_gym.scenarios.formats.elevation import Elevation
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC

READERS: dict[str, Callable[[Path], Elevation]] = {  # endings in any case
    ".asc": esri_grid.read,
    ".hgt": srtm.read,
    ".tif": geotiff.read,
    ".tiff": geotiff.read,
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
