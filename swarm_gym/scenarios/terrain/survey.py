"""Flights over real ground: an elevation model, threats, a start and a goal as a task in metres.

An elevation model in metres keeps its posts, if they are as far apart to the east as to the north. One in
degrees is sampled on a grid of metres around start and goal. This grid is twice as fine as its posts where
that is not too much.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.elevation import Elevation
from swarm_gym.scenarios.formats.elevation_files import read_elevation
from swarm_gym.scenarios.formats.geographic import (
    GEOGRAPHIC,
    PLANE,
    PlaneSystem,
    Projection,
    projection_for,
    require_coordinates,
)
from swarm_gym.scenarios.formats.threat_file import Threat, Threats, read_threats
from swarm_gym.scenarios.terrain.scenario import Point3, TerrainScenario

Floats = NDArray[np.float64]

REACH = 0.5  # of the straight line, around start and goal: ground that the task has
LEAST_REACH = 500.0  # in metres
FINER = 2  # nodes between posts that are in degrees
MANY = 4096  # nodes of a side, beyond which they are as far apart as posts


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

    def file_ground(self, points: Floats) -> Floats:
        """Return the heights of the file, (n,), at points (n, 2); without a file, the heights of the task."""
        if self.elevation is None:
            return self.scenario.ground(points)
        degrees = self.elevation.kind == GEOGRAPHIC and self.system is not None
        return self.elevation.at(self.system.to_degrees(points) if degrees and self.system else points)


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
    found = Threats((), None) if threats is None else read_threats(threats)
    if found.kind not in (None, kind):
        raise ScenarioError(
            f"{threats}: the file names coordinates {found.kind!r}, and start and goal are in {kind!r}; "
            "expected "
            "the same"
        )
    ends = np.array([start[:2], goal[:2]])
    system = _system_for(path, elevation, kind, ends)
    where = ends if kind == PLANE or system is None else system.to_metres(ends)
    heights, origin, cell = _ground(path, elevation, system, where, (start, goal))
    places = np.array([one.place for one in found.threats]).reshape(-1, 2)
    if kind == GEOGRAPHIC and system is not None and len(places):
        _require_degrees(found.threats)
        places = system.to_metres(places)
    (x, y), (goal_x, goal_y) = where.tolist()
    bare = TerrainScenario(
        name or path.stem,
        heights,
        (x, y, start[2]),
        (goal_x, goal_y, goal[2]),
        cell,
        origin,
        _cylinders(found.threats, places, heights, origin, cell),
        altitude,
        largest_turn,
        largest_climb,
        drone_size,
        danger_distance,
    )
    return Survey(bare, elevation, system, kind)


def _system_for(path: Path, elevation: Elevation, kind: str, ends: Floats) -> Projection | PlaneSystem | None:
    """Return the projection between degrees and the metres of the task."""
    if elevation.kind == GEOGRAPHIC:
        return projection_for(str(path), ends)
    if elevation.system is not None:
        return PlaneSystem(elevation.system)
    if kind == GEOGRAPHIC:
        raise ScenarioError(
            f"{path}: the file names no coordinate reference system, so longitude and latitude have no "
            "place on it; give start and goal in its own metres, or add a .prj file"
        )
    return None


def _ground(
    path: Path,
    elevation: Elevation,
    system: Projection | PlaneSystem | None,
    ends: Floats,
    given: Sequence[Point3],
) -> tuple[Floats, tuple[float, float], float]:
    """Return heights around start and goal, the coordinates of the first one, and their distance."""
    reach = max(REACH * math.dist(*ends.tolist()), LEAST_REACH)
    low, high = ends.min(axis=0) - reach, ends.max(axis=0) + reach
    posts = _as_posts(elevation)
    if posts is not None:
        spacing = posts.spacing[0]
        _require_inside(path, elevation, np.array(posts.box), ends, given)
        rows, columns = posts.heights.shape
        first = np.clip(np.floor((low - posts.origin) / spacing), 0, [columns - 2, rows - 2]).astype(int)
        last = np.clip(np.ceil((high - posts.origin) / spacing), first + 1, [columns - 1, rows - 1]).astype(
            int
        )
        heights = posts.heights[first[1] : last[1] + 1, first[0] : last[0] + 1]
        start = np.array(posts.origin) + first * spacing
    else:
        inner, spacing = _inner_box(elevation, system)
        _require_inside(path, elevation, inner, ends, given)
        low, high = np.maximum(low, inner[:2]), np.minimum(high, inner[2:])
        if (high - low).max() / spacing * FINER <= MANY:
            spacing /= FINER
        counts = np.maximum(np.floor((high - low) / spacing).astype(int) + 1, 2)
        columns_x = low[0] + spacing * np.arange(counts[0])
        rows_y = low[1] + spacing * np.arange(counts[1])
        nodes = np.stack(np.meshgrid(columns_x, rows_y), axis=-1).reshape(-1, 2)
        degrees = nodes if elevation.kind == PLANE or system is None else system.to_degrees(nodes)
        heights = elevation.at(degrees).reshape(counts[1], counts[0])
        start = low
    gaps = np.isnan(heights)
    if gaps.any():
        row, column = np.argwhere(gaps)[0].tolist()
        place = start + spacing * np.array([column, row])
        raise ScenarioError(
            f"{path}: {int(gaps.sum())} of {gaps.size} cells around start and goal have no data, one at x "
            f"= {place[0]:g}, y = {place[1]:g}; fill the gaps, for example with gdal_fillnodata"
        )
    x, y = start.tolist()
    return heights, (x, y), float(spacing)


def _as_posts(elevation: Elevation) -> Elevation | None:
    """Return the elevation model if its posts suit a task: in metres, evenly spaced both ways."""
    dx, dy = elevation.spacing
    return elevation if elevation.kind == PLANE and abs(dx - dy) <= 1e-9 * dx else None


def _inner_box(elevation: Elevation, system: Projection | PlaneSystem | None) -> tuple[Floats, float]:
    """Return a box in metres that lies on the map, and the distance of posts there."""
    x_min, y_min, x_max, y_max = elevation.box
    if elevation.kind == PLANE:
        return np.array(elevation.box), min(elevation.spacing)
    assert system is not None
    share = np.linspace(0.0, 1.0, 101)
    across, along = x_min + share * (x_max - x_min), y_min + share * (y_max - y_min)

    def metres(x: Floats, y: Floats) -> Floats:
        return system.to_metres(np.stack(np.broadcast_arrays(x, y), axis=-1))

    west, east = metres(np.array(x_min), along)[:, 0], metres(np.array(x_max), along)[:, 0]
    south, north = metres(across, np.array(y_min))[:, 1], metres(across, np.array(y_max))[:, 1]
    assert isinstance(system, Projection)
    dx, dy = elevation.spacing
    middle = np.array([[system.longitude, system.latitude]])
    step = np.abs(system.to_metres(middle + np.array([[dx, dy]])) - system.to_metres(middle))[0]
    return np.array([west.max(), south.max(), east.min(), north.min()]), float(step.min())


def _require_inside(
    path: Path, elevation: Elevation, box: Floats, ends: Floats, given: Sequence[Point3]
) -> None:
    """Raise a ScenarioError if start or goal is off the map."""
    for role, end, user in zip(("start", "goal"), ends, given, strict=True):
        if not ((end >= box[:2]) & (end <= box[2:])).all():
            x_min, y_min, x_max, y_max = elevation.box
            hint = "is it in another system?"
            if elevation.kind == PLANE and abs(user[0]) <= 180.0 and abs(user[1]) <= 90.0:
                hint = f"for degrees choose coordinates {GEOGRAPHIC!r}"
            raise ScenarioError(
                f"{path}: {role} {user[0]:.10g}, {user[1]:.10g} lies outside the map, which reaches from "
                f"{x_min:.10g}, {y_min:.10g} to {x_max:.10g}, {y_max:.10g} ({elevation.kind}); {hint}"
            )


def _require_degrees(threats: Sequence[Threat]) -> None:
    for threat in threats:
        x, y = threat.place
        if abs(x) > 180.0 or abs(y) > 90.0:
            raise ScenarioError(
                f"{threat.name}: expected longitude in [-180, 180] and latitude in [-90, 90], as start and "
                f"goal, got {x:g}, {y:g}; is it in another system?"
            )


def _cylinders(
    threats: Sequence[Threat], places: Floats, heights: Floats, origin: tuple[float, float], cell: float
) -> Floats:
    """Return x, y, top above sea level and radius of each threat."""
    model = Elevation(Path(), heights, origin, (cell, cell))
    x_min, y_min, x_max, y_max = model.box
    cylinders = np.empty((len(threats), 4))
    for number, (threat, (x, y)) in enumerate(zip(threats, places.tolist(), strict=True)):
        top = threat.top
        if top is None:
            assert threat.height is not None
            nearest = np.array([[min(max(x, x_min), x_max), min(max(y, y_min), y_max)]])
            top = threat.height + float(model.at(nearest)[0])
        cylinders[number] = x, y, top, threat.radius
    return cylinders
