"""Lengths on the ground beside those of a plane reference system, which differ by up to `MOST_STRETCH`.

Lengths on the ground are those of geodesics on the ellipsoid WGS 84.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.geographic import PlaneSystem

Floats = NDArray[np.float64]

MOST_STRETCH = 0.02  # of a length: more than UTM or national systems have
BEARINGS = 128  # in which a circle is looked at


def require_true_lengths(where: str, system: PlaneSystem, ends: Floats) -> None:
    """Raise an error unless metres of a system are metres on the ground, around start and goal.

    Args:
        where: name of the map, for messages.
        system: the system.
        ends: (2, 2) start and goal in it.

    Raises:
        ScenarioError: if a length differs by more than `MOST_STRETCH` of it, as in EPSG:3857.
    """
    reach = math.dist(*ends.tolist())
    for begin in ends:
        for bearing in np.arange(4) * math.pi / 4.0:  # a system may shear, so that diagonals differ
            step = reach * np.array([math.cos(bearing), math.sin(bearing)])
            (x, y), (to_x, to_y) = system.to_degrees(np.array([begin, begin + step])).tolist()
            true = _globe().inv(x, y, to_x, to_y)[2]
            if not abs(reach - true) <= MOST_STRETCH * true:  # also for NaN and infinity
                raise ScenarioError(
                    f"{where}: {reach:.0f} metres of its reference system are {true:.0f} metres on the "
                    f"ground near {x:.5f}, {y:.5f}, expected the same; warp the file first, for example to "
                    "UTM"
                )


def radius_in_plane(system: PlaneSystem, centre: Floats, radius: float) -> float:
    """Return the radius in metres of the system of a circle with a disc of the ground in it.

    Far from where the system is for, it is the radius itself.

    Args:
        system: the system.
        centre: (2,) centre in it.
        radius: radius of the disc on the ground, in metres.
    """
    (longitude, latitude) = system.to_degrees(centre)[0].tolist()
    if not (math.isfinite(longitude) and math.isfinite(latitude)):
        return radius
    bearings = np.arange(BEARINGS) * 360.0 / BEARINGS
    same = np.ones(BEARINGS)
    *rim, _ = _globe().fwd(longitude * same, latitude * same, bearings, radius * same)
    found = float(np.hypot(*(system.to_metres(np.stack(rim, axis=-1)) - centre).T).max())
    return found if abs(found - radius) <= MOST_STRETCH * radius else radius


def radius_on_ground(system: PlaneSystem, centre: Floats, radius: float) -> float:
    """Return the radius in metres on the ground of a disc that lies in a circle of the system.

    It is the inverse of `radius_in_plane`.

    Args:
        system: the system.
        centre: (2,) centre in it.
        radius: radius of the circle, in metres of the system.
    """
    bearings = np.arange(BEARINGS) * 2.0 * math.pi / BEARINGS
    rim = centre + radius * np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
    degrees, middle = system.to_degrees(rim), system.to_degrees(centre)[0]
    same = np.ones(BEARINGS)
    found = float(_globe().inv(middle[0] * same, middle[1] * same, *degrees.T)[2].min())
    return found if abs(found - radius) <= MOST_STRETCH * radius else radius


@lru_cache(maxsize=1)
def _globe() -> Any:
    import pyproj

    return pyproj.Geod(ellps="WGS84")
