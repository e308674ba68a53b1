"""Elevation models: heights of the ground at evenly spaced posts, as readers of files return them."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC, PLANE, kind_of_system

Floats = NDArray[np.float64]

MAX_POSTS = 100_000_000  # heights of a file
MAX_FILE = 2**30  # bytes
SLACK = 1e-3  # of the distance of posts: ground beyond the edge, along which a line in metres may bend
NAME_SYSTEM = "name it, with a .prj file beside .asc or gdal_edit -a_srs for .tif"  # for messages
FINEST_METRES = 0.05  # distance of posts; those of degrees are smaller


class Elevation(NamedTuple):
    """The content of a file: heights at evenly spaced posts.

    Attributes:
        path: name of the file.
        heights: (rows, columns) heights in metres, rows from south to north; NaN where there are none.
        origin: coordinates of `heights[0, 0]`.
        spacing: distance of neighbouring columns, and of neighbouring rows.
        kind: "longitude-latitude" for degrees, "plane" for metres.
        system: coordinate reference system as text that pyproj reads; None if the file has none.
    """

    path: Path
    heights: Floats
    origin: tuple[float, float]
    spacing: tuple[float, float]
    kind: str = PLANE
    system: str | None = None

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Coordinates of the outermost posts: x_min, y_min, x_max, y_max."""
        rows, columns = self.heights.shape
        (x, y), (dx, dy) = self.origin, self.spacing
        return x, y, x + dx * (columns - 1), y + dy * (rows - 1)

    def at(self, points: Floats) -> Floats:
        """Return heights (n,) at coordinates (n, 2), bilinear; NaN off the map or next to gaps."""
        place = (points - np.array(self.origin)) / np.array(self.spacing)
        rows, columns = self.heights.shape
        last = np.array([columns - 1.0, rows - 1.0])
        inside = ((place >= -SLACK) & (place <= last + SLACK)).all(axis=1)
        place = np.clip(place, 0.0, last)
        i, j = np.minimum(place.astype(np.int64), [columns - 2, rows - 2]).T
        right, up = place[:, 0] - i, place[:, 1] - j
        low = self.heights[j, i] * (1.0 - right) + self.heights[j, i + 1] * right
        high = self.heights[j + 1, i] * (1.0 - right) + self.heights[j + 1, i + 1] * right
        found: Floats = np.where(inside, low * (1.0 - up) + high * up, np.nan)
        return found


def with_kind(elevation: Elevation) -> Elevation:
    """Return an elevation model with the kind of coordinates of its reference system.

    Without one, coordinates are degrees if they can be, and posts are closer than `FINEST_METRES`.

    Raises:
        ScenarioError: if the system has another unit than degrees or metres, or is none.
        MissingExtraError: if the file names a system, and pyproj is missing.
    """
    if elevation.system:
        return elevation._replace(kind=kind_of_system(str(elevation.path), elevation.system))
    x_min, y_min, x_max, y_max = elevation.box
    can_be = max(abs(x_min), abs(x_max)) <= 180.5 and max(abs(y_min), abs(y_max)) <= 90.5
    return elevation._replace(kind=GEOGRAPHIC if can_be and max(elevation.spacing) < FINEST_METRES else PLANE)


def require_posts(path: Path, rows: int, columns: int) -> None:
    """Raise a ScenarioError if a file has no heights, or too many."""
    if rows < 1 or columns < 1 or rows * columns > MAX_POSTS:
        raise ScenarioError(
            f"{path}: expected 1 to {MAX_POSTS:,} heights, got {rows} rows of {columns}; cut a large file "
            "to the area of the flight"
        )
