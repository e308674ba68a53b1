"""Threats of a file at their places on an elevation model, as cylinders in the metres of a task."""

import math
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.elevation import Elevation
from swarm_gym.scenarios.formats.geographic import (
    GEOGRAPHIC,
    PlaneSystem,
    Projection,
    require_same_system,
)
from swarm_gym.scenarios.formats.threat_file import Threat, read_threats
from swarm_gym.scenarios.formats.true_lengths import radius_in_plane
from swarm_gym.scenarios.terrain.task_ground import in_file

Floats = NDArray[np.float64]

FAR = 1e9  # metres


def cylinders_of(
    path: Path, kind: str, elevation: Elevation, system: Projection | PlaneSystem | None
) -> Floats:
    """Return x, y, top above sea level and radius of each threat of a file, (k, 4), in metres of the task.

    A radius in the file is in metres on the ground, from which those of a plane system differ a little.

    A height above ground counts from the ground of the elevation model, or from its edge. Without data there,
    the threat blocks every altitude.

    Args:
        path: GeoJSON file of the threats.
        kind: kind of the coordinates of start and goal, which are those of the threats.
        elevation: the elevation model.
        system: projection between degrees and the metres of the task.

    Raises:
        ScenarioError: if the file is missing or malformed, if its coordinates are in another system, or if
            no threat touches the map.
        MissingExtraError: if pyproj is missing and needed.
    """
    found = read_threats(path)
    given = np.array([one.place for one in found.threats]).reshape(-1, 2)
    require_same_system(str(path), found.system, kind, elevation.system, given)
    if not len(given):
        return np.empty((0, 4))
    places = given
    if kind == GEOGRAPHIC and system is not None:
        _require_degrees(found.threats)
        # Places that the system does not reach are far away.
        places = np.nan_to_num(system.to_metres(given), nan=FAR, posinf=FAR, neginf=-FAR)
    x_min, y_min, x_max, y_max = elevation.box
    nearest = np.clip(in_file(elevation, system, places), (x_min, y_min), (x_max, y_max))
    on_map = nearest
    if elevation.kind == GEOGRAPHIC:
        assert system is not None
        on_map = system.to_metres(nearest)
    distances = np.hypot(*(places - on_map).T)
    _require_near(path, found.threats, distances, elevation)
    ground = elevation.at(nearest)
    cylinders = np.empty((len(given), 4))
    for number, (threat, (x, y)) in enumerate(zip(found.threats, places.tolist(), strict=True)):
        top = threat.top
        if top is None:
            assert threat.height is not None
            top = math.inf if np.isnan(ground[number]) else threat.height + float(ground[number])
        radius = threat.radius
        if isinstance(system, PlaneSystem):
            radius = radius_in_plane(system, places[number], radius)
        cylinders[number] = x, y, top, radius
    return cylinders


def _require_degrees(threats: Sequence[Threat]) -> None:
    for threat in threats:
        x, y = threat.place
        if abs(x) > 180.0 or abs(y) > 90.0:
            raise ScenarioError(
                f"{threat.name}: expected longitude in [-180, 180] and latitude in [-90, 90], as start and "
                f"goal, got {x:g}, {y:g}; is it in another system?"
            )


def _require_near(path: Path, threats: Sequence[Threat], distances: Floats, elevation: Elevation) -> None:
    """Raise a ScenarioError if no threat touches the map, from which they are (k,) metres away, or warn."""
    off = distances > [one.radius for one in threats]
    if off.any() and not off.all():
        warnings.warn(
            f"{path}: {int(off.sum())} of {len(threats)} threats do not touch the map, among them "
            f"{threats[int(np.argmax(off))].name.rpartition(': ')[2]}",
            stacklevel=4,
        )
    if off.all():
        x_min, y_min, x_max, y_max = elevation.box
        raise ScenarioError(
            f"{path}: none of its {len(threats)} threats touches the map {elevation.path}, which reaches "
            f"from {x_min:.10g}, {y_min:.10g} to {x_max:.10g}, {y_max:.10g} ({elevation.kind}); feature 0 is "
            f"at {threats[0].place[0]:.10g}, {threats[0].place[1]:.10g}; is it in another system, or are x "
            "and y swapped?"
        )
