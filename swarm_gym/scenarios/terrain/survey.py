"""Flights over real ground: an elevation model, threats, a start and a goal as a task in metres.

Swarms look for routes over the heights of the task, which may have been sampled from those of the file.
`Survey.ground` has the ground of the file.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.elevation import NAME_SYSTEM, Elevation
from swarm_gym.scenarios.formats.elevation_files import read_elevation
from swarm_gym.scenarios.formats.geographic import (
    GEOGRAPHIC,
    PLANE,
    PlaneSystem,
    Projection,
    projection_for,
    require_coordinates,
    require_usual_degrees,
)
from swarm_gym.scenarios.formats.true_lengths import radius_on_ground, require_true_lengths
from swarm_gym.scenarios.terrain.placed_threats import cylinders_of
from swarm_gym.scenarios.terrain.scenario import RADIUS, EndError, Point3, TerrainScenario
from swarm_gym.scenarios.terrain.task_ground import in_file, is_square, task_ground, words

Floats = NDArray[np.float64]

MILLIMETRES = 3  # decimals of a radius in metres


class Limits(TypedDict, total=False):
    """Limits of a flight, as arguments of `survey`; one that is left out has its default."""

    altitude: tuple[float, float]
    largest_turn: float
    largest_climb: float
    drone_size: float
    danger_distance: float


@dataclass(frozen=True)
class Survey:
    """A task over real ground, and how to get back to its coordinates.

    Attributes:
        scenario: the task, in metres.
        elevation: the elevation model as it is in the file; None for a task that comes from no file.
        system: projection between degrees and metres; None where the map has no place on the earth.
        coordinates: kind of the coordinates that the user gives and gets.
    """

    scenario: TerrainScenario
    elevation: Elevation | None = None
    system: Projection | PlaneSystem | None = None
    coordinates: str = PLANE

    def for_user(self, points: Floats) -> Floats:
        """Return points (n, 2) of the scenario in the user's coordinates."""
        if self.coordinates == PLANE:
            return points
        assert self.system is not None
        return self.system.to_degrees(points)

    def in_degrees(self, points: Floats) -> Floats | None:
        """Return points (n, 2) of the scenario as longitude and latitude; None without a place on earth."""
        return None if self.system is None else self.system.to_degrees(points)

    def true_radius(self, threat: Floats) -> float:
        """Return the radius of a threat, (4,), in metres on the ground; those of the map differ a little."""
        radius = float(threat[RADIUS])
        if not isinstance(self.system, PlaneSystem):
            return radius
        return round(radius_on_ground(self.system, threat[:2], radius), MILLIMETRES)

    @property
    def is_resampled(self) -> bool:
        """True if the heights of the scenario were sampled from those of the file between its posts."""
        return self.elevation is not None and not is_square(self.elevation)

    def ground(self, points: Floats) -> Floats:
        """Return the heights of the ground, (n,), at points (n, 2) of the scenario: those of the file.

        They are NaN off the file, or next to its gaps. Without a file the scenario has them.
        """
        if self.elevation is None or not self.is_resampled:
            return self.scenario.ground(points)
        return self.elevation.at(in_file(self.elevation, self.system, points))

    def places_in_file(self, points: Floats) -> Floats:
        """Return points (n, 2) of the scenario as columns and rows of the file's posts, (n, 2)."""
        assert self.elevation is not None
        places = in_file(self.elevation, self.system, points)
        return (places - self.elevation.origin) / self.elevation.spacing


def survey(
    path: Path,
    start: Point3,
    goal: Point3,
    *,
    name: str | None = None,
    threats: Path | None = None,
    altitude: tuple[float, float] = (100.0, 200.0),
    largest_turn: float = 45.0,
    largest_climb: float = 45.0,
    drone_size: float = 1.0,
    danger_distance: float = 10.0,
    coordinates: str | None = None,
) -> Survey:
    """Return the task on an elevation model.

    Args:
        path: file of the elevation model.
        start: x, y or longitude, latitude, and height above ground.
        goal: x, y or longitude, latitude, and height above ground.
        name: name of the task; by default the name of the file.
        threats: GeoJSON file with threats, in the same coordinates as start and goal; None for none.
        altitude: least and greatest height above ground.
        largest_turn: largest turn at a waypoint, in degrees.
        largest_climb: largest angle of climb or descent, in degrees.
        drone_size: distance from a threat that counts as contact.
        danger_distance: width of the zone around threats that is better avoided.
        coordinates: kind of the coordinates of start, goal and threats; None takes the kind of the file.

    Raises:
        ScenarioError: for files that are missing or malformed, cells without data, or ends that cannot be.
        SettingError: for another kind of coordinates.
        MissingExtraError: if rasterio or pyproj is missing and needed.
    """
    require_coordinates(coordinates)
    elevation = read_elevation(path)
    kind = coordinates or elevation.kind
    if kind == PLANE and elevation.kind == GEOGRAPHIC:
        raise ScenarioError(
            f"{path}: the map is in longitude and latitude; expected start and goal in them, too"
        )
    for role, end in (("start", start), ("goal", goal)):
        if len(end) != 3 or not all(map(math.isfinite, end)):
            raise ScenarioError(f"{path}: {role} must be x, y and height above ground, got {shown(end)}")
    if tuple(start[:2]) == tuple(goal[:2]):
        raise ScenarioError(
            f"{path}: start and goal must be different points of the map, got {words(start)} and "
            f"{words(goal)}"
        )
    ends = np.array([start[:2], goal[:2]])
    system = _system_for(path, elevation, kind, ends)
    where = ends if kind == PLANE or system is None else system.to_metres(ends)
    heights, origin, cell = task_ground(path, elevation, system, where, (start, goal), kind)
    if isinstance(system, PlaneSystem):
        require_true_lengths(str(path), system, where)
    cylinders = np.empty((0, 4)) if threats is None else cylinders_of(threats, kind, elevation, system)
    last = np.array(origin) + cell * (np.array(heights.shape[::-1]) - 1)
    (x, y), (goal_x, goal_y) = np.clip(where, origin, last).tolist()  # an end on the edge, after roundings
    try:
        bare = TerrainScenario(
            name or path.stem,
            heights,
            (x, y, start[2]),
            (goal_x, goal_y, goal[2]),
            cell,
            origin,
            cylinders,
            altitude,
            largest_turn,
            largest_climb,
            drone_size,
            danger_distance,
        )
    except EndError as error:  # in the coordinates that the user gave
        end = {"start": start, "goal": goal}[error.role]
        file = threats if error.in_threat else path  # that has what is in the way
        raise ScenarioError(f"{file}: {error.role} {words(end)} {error.fault}") from error
    return Survey(bare, elevation, system, kind)


def _system_for(path: Path, elevation: Elevation, kind: str, ends: Floats) -> Projection | PlaneSystem | None:
    """Return the projection between degrees and the metres of the task."""
    if elevation.kind == GEOGRAPHIC:
        found = projection_for(str(path), ends, "give start and goal in degrees, or warp the map to UTM")
        if elevation.system is not None:
            require_usual_degrees(str(path), elevation.system, ends)
        return found
    if elevation.system is not None:
        return PlaneSystem(elevation.system)
    if kind == GEOGRAPHIC:
        raise ScenarioError(
            f"{path}: the file names no coordinate reference system, so longitude and latitude have no "
            f"place on it; give start and goal in its own metres, or {NAME_SYSTEM}"
        )
    return None
