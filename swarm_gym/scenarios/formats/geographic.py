"""Longitude and latitude: a local projection to metres, and which files have such coordinates."""

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import MissingExtraError, ScenarioError, SettingError, shown

Floats = NDArray[np.float64]

PLANE, GEOGRAPHIC = "plane", "longitude-latitude"
COORDINATES = (PLANE, GEOGRAPHIC)

# Widest map in metres, to the east and to the north. Up to its corners, 71 km from the centre, the projection
# changes lengths by at most 2.1e-5 of them.
WIDEST = 100_000.0
FINEST = 3  # decimals that coordinates in metres seldom exceed
SAME_METRES, SAME_DEGREES = 5.0, 5e-5  # between places that count as the same: ETRS89 is near WGS 84
DEGREES = "EPSG:4326"

# Codes of EPSG for longitude and latitude: WGS 84 and its three-dimensional form, ETRS89, and the systems of
# North America, Canada, Australia (two), New Zealand, Japan, China and South America. Their ellipsoids differ
# by less than a millimetre on 10 km.
GEOGRAPHIC_CODES = {"4326", "4979", "4258", "4269", "4617", "4283", "7844", "4167", "6668", "4490", "4674"}
WEB_MERCATOR = {"3857", "3785", "900913"}
_EPSG = re.compile(r"EPSG(?:/[\d.]+/|:[\d.]*:|:|\.xml#)(\d+)$", re.IGNORECASE)
_CRS84 = re.compile(r"(?:OGC.*[:/]|^)CRS:?84h?$", re.IGNORECASE)


@dataclass(frozen=True)
class Projection:
    """An azimuthal equidistant projection of the ellipsoid WGS 84: distances from its centre are exact.

    Attributes:
        longitude: longitude of the centre, in degrees.
        latitude: latitude of the centre, in degrees.
    """

    longitude: float
    latitude: float

    def to_metres(self, points: ArrayLike) -> Floats:
        """Return points (k, 2), longitude and latitude, as x to the east and y to the north, in metres."""
        longitudes, latitudes = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
        return np.stack(_proj(self)(longitudes, latitudes), axis=-1)

    def to_degrees(self, points: ArrayLike) -> Floats:
        """Return points (k, 2) in metres as longitude and latitude."""
        x, y = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
        return np.stack(_proj(self)(x, y, inverse=True), axis=-1)


@dataclass(frozen=True)
class PlaneSystem:
    """A coordinate reference system in metres, such as UTM, in which the map has its coordinates.

    Attributes:
        system: text that pyproj reads.
    """

    system: str

    def to_metres(self, points: ArrayLike) -> Floats:
        """Return points (k, 2), longitude and latitude of WGS 84, in the coordinates of the system."""
        longitudes, latitudes = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
        return np.stack(_transformer(self.system).transform(longitudes, latitudes), axis=-1)

    def to_degrees(self, points: ArrayLike) -> Floats:
        """Return points (k, 2) of the system as longitude and latitude of WGS 84."""
        x, y = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
        return np.stack(_transformer(self.system).transform(x, y, direction="INVERSE"), axis=-1)


def kind_of_system(where: str, system: str) -> str:
    """Return the kind of the coordinates of a reference system: degrees, or metres in a plane.

    Args:
        where: name of the file, for messages.
        system: text that pyproj reads.

    Raises:
        ScenarioError: if the text is no such system, or a unit is another one.
        MissingExtraError: if pyproj is missing.
    """
    try:
        import pyproj
    except ImportError as error:
        raise MissingExtraError(f"{where}: a coordinate reference system", "pyproj", "terrain") from error
    try:
        found = pyproj.CRS.from_user_input(system)
    except pyproj.exceptions.CRSError as error:
        raise ScenarioError(f"{where}: unknown coordinate reference system {shown(system)}") from error
    for axis in found.axis_info[2:]:
        if axis.unit_conversion_factor != 1.0:
            raise ScenarioError(
                f"{where}: expected heights in metres, the reference system {shown(found.name)} has "
                f"{axis.unit_name}; convert the heights first"
            )
        if axis.name == "Ellipsoidal height":
            warnings.warn(
                f"{where}: heights of the reference system {shown(found.name)} are above the ellipsoid, and "
                "count as heights above sea level, from which they may be 100 metres off; convert them first",
                stacklevel=2,
            )
    if found.is_geographic:
        return GEOGRAPHIC
    units = {axis.unit_name for axis in found.axis_info[:2]}
    if not found.is_projected or any(axis.unit_conversion_factor != 1.0 for axis in found.axis_info[:2]):
        raise ScenarioError(
            f"{where}: expected coordinates in degrees or metres, the reference system {shown(found.name)} "
            f"has {', '.join(sorted(units)) or 'none'}; warp the file first, for example to UTM"
        )
    return PLANE


def require_usual_degrees(where: str, system: str, points: Floats) -> None:
    """Raise an error unless the degrees of a system are longitudes and latitudes as WGS 84 has them.

    Args:
        where: name of the map, for messages.
        system: the system, as text that pyproj reads.
        points: (k, 2) longitudes and latitudes in it.

    Raises:
        ScenarioError: if the same numbers are other places in WGS 84, as with another datum.
    """
    if not _are_same_places(system, DEGREES, points, SAME_DEGREES):
        import pyproj

        raise ScenarioError(
            f"{where}: its reference system, {pyproj.CRS.from_user_input(system).name}, has other longitudes "
            "and latitudes than WGS 84; warp the file first, for example with gdalwarp -t_srs EPSG:4326"
        )


def require_same_system(
    where: str, named: str | None, kind: str, map_system: str | None, places: Floats
) -> None:
    """Raise an error unless a file has the coordinates of start and goal.

    Args:
        where: name of the file, for messages.
        named: the reference system that the file names, see `system_named`; None if it names none.
        kind: kind of the coordinates of start and goal.
        map_system: reference system of a map in metres, as text that pyproj reads; None without one.
        places: (k, 2) coordinates in the file.

    Raises:
        ScenarioError: if the file names another system, in which the same numbers are other places.
        MissingExtraError: if pyproj is missing.
    """
    if named is None or not len(places):
        return
    expected = GEOGRAPHIC if kind == GEOGRAPHIC else "metres of the map"
    try:
        import pyproj

        if kind == GEOGRAPHIC:
            same = _are_same_places(named, DEGREES, places, SAME_DEGREES)
        elif map_system is None:
            same = not pyproj.CRS.from_user_input(named).is_geographic
        else:
            same = _are_same_places(named, map_system, places, SAME_METRES)
            expected = pyproj.CRS.from_user_input(map_system).name
    except ImportError as error:
        raise MissingExtraError(f"{where}: a coordinate reference system", "pyproj", "terrain") from error
    except pyproj.exceptions.ProjError as error:
        raise ScenarioError(f"{where}: unknown coordinate reference system {shown(named)}") from error
    if not same:
        raise ScenarioError(
            f"{where}: the file names the coordinate reference system {shown(named)}, expected that of start "
            f"and goal, {expected}; convert the file first, for example with ogr2ogr"
        )


def _are_same_places(system: str, other: str, points: Floats, near: float) -> bool:
    """Return whether numbers are the same places in two systems, up to a difference in their unit."""
    import pyproj

    moved = pyproj.Transformer.from_crs(system, other, always_xy=True).transform(*points.T)
    return bool((np.abs(np.stack(moved, axis=-1) - points) <= near).all())  # infinity is another place


def projection_for(where: str, points: Floats, hint: str = "") -> Projection:
    """Return a projection around the middle of points.

    Args:
        where: name of the map, for messages.
        points: longitude and latitude of everything on the map, (k, 2).
        hint: words on what to do about other numbers, for messages; by default to choose metres.

    Raises:
        ScenarioError: if these are no longitudes and latitudes, or too far apart for one plane.
        MissingExtraError: if pyproj is missing.
    """
    for point in points[(np.abs(points) > (180.0, 90.0)).any(axis=1)][:1]:
        raise ScenarioError(
            f"{where}: expected longitude in [-180, 180] and latitude in [-90, 90], "
            f"got {tuple(point.tolist())}; {hint or f'for x and y in one unit choose coordinates {PLANE!r}'}"
        )
    low, high = points.min(axis=0), points.max(axis=0)
    if high[0] - low[0] > 180.0:
        raise ScenarioError(
            f"{where}: longitudes from {low[0]:g} to {high[0]:g} cross the antimeridian; "
            + (hint or f"project the map to metres first, and choose coordinates {PLANE!r}")
        )
    try:
        import pyproj  # noqa: F401
    except ImportError as error:
        raise MissingExtraError(f"{where}: longitude and latitude", "pyproj", "maps") from error
    longitude, latitude = ((low + high) / 2.0).tolist()
    projection = Projection(longitude, latitude)
    metres = projection.to_metres(points)
    span = np.ptp(metres, axis=0).max()
    if not span <= WIDEST:  # also for NaN and infinity, far from the centre
        raise ScenarioError(
            f"{where}: start, goal and map span {span / 1000.0:,.0f} km, expected at most "
            f"{WIDEST / 1000.0:g} km, where the earth is nearly flat; leave out what is far away"
        )
    return projection


def require_coordinates(name: object) -> None:
    """Raise an error if a value is not in `COORDINATES`, nor None for a choice by the file.

    Raises:
        SettingError: for another value.
    """
    if name is not None and (not isinstance(name, str) or name not in COORDINATES):
        raise SettingError(f"coordinates must be one of {', '.join(COORDINATES)}, got {shown(name)}")


def system_named(where: str, reference: object) -> str | None:
    """Return the reference system that the member "crs" of a file names, such as EPSG:4326; None without one.

    Its form follows the GeoJSON specification of 2008. RFC 7946 has removed it, but programs write it.

    Raises:
        ScenarioError: if the member is malformed.
    """
    if reference is None:
        return None
    properties = reference.get("properties") if isinstance(reference, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if not isinstance(name, str):
        raise ScenarioError(
            f"{where}: expected a member 'crs' with properties that have a name, such as EPSG:4326, "
            f"got {shown(reference)}"
        )
    if (found := _EPSG.search(name)) and "," not in name:  # a compound name has several
        return f"EPSG:{found[1]}"
    return "OGC:CRS84" if _CRS84.search(name) else name


def named_by(where: str, reference: object) -> str | None:
    """Return the kind of coordinates that the member "crs" of a file names; None if it names none.

    Raises:
        ScenarioError: if the member is malformed.
    """
    system = system_named(where, reference)
    if system is not None and system.removeprefix("EPSG:") in WEB_MERCATOR:
        warnings.warn(
            f"{where}: lengths in {system} are no metres, but longer by 1 / cos(latitude), so radius and "
            "clearance must be, too; convert the file to longitude and latitude or to UTM",
            stacklevel=2,
        )
    return None if system is None else _kind_of(system)


def _kind_of(named: str) -> str:
    """Return the kind of the coordinates of a system that `system_named` returns."""
    degrees = named == "OGC:CRS84" or named.removeprefix("EPSG:") in GEOGRAPHIC_CODES
    return GEOGRAPHIC if degrees else PLANE


def look_geographic(points: Floats) -> bool:
    """Return whether points, (k, 2), may well be longitudes and latitudes: fine numbers in under a degree."""
    inside = bool((np.abs(points) <= (180.0, 90.0)).all())
    return inside and float(np.ptp(points, axis=0).max()) < 1.0 and _are_fine(points.ravel().tolist())


@lru_cache(maxsize=16)
def _proj(projection: Projection) -> Any:
    import pyproj

    return pyproj.Proj(proj="aeqd", lon_0=projection.longitude, lat_0=projection.latitude, ellps="WGS84")


@lru_cache(maxsize=16)
def _transformer(system: str) -> Any:
    import pyproj

    return pyproj.Transformer.from_crs("EPSG:4326", system, always_xy=True)


def _are_fine(numbers: Sequence[float]) -> bool:
    """Return whether most numbers have more than `FINEST` decimals."""
    return 2 * sum(number != round(number, FINEST) for number in numbers) > len(numbers)
