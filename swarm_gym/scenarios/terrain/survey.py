"""Flights over real ground: an elevation model, threats, a start and a goal as a task in metres.

An elevation model in metres keeps its posts, if they are as far apart to the east as to the north. Any other
is sampled on a grid of metres around start and goal. This grid is twice as fine as the posts where that is
not too much. Swarms look for routes over it, and `Survey.ground` has the ground of the file.
"""

import math
from collections.abc import Iterable, Sequence
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
    require_true_lengths,
)
from swarm_gym.scenarios.terrain.placed_threats import cylinders_of
from swarm_gym.scenarios.terrain.scenario import EndError, Point3, TerrainScenario

Floats = NDArray[np.float64]

REACH = 0.5  # of the straight line, around start and goal: ground that the task has
LEAST_REACH = 500.0  # in metres
FINER = 2  # nodes between posts that are in degrees
MANY = 4096  # nodes of a side, beyond which they are as far apart as posts
LOWEST, HIGHEST = -500.0, 9000.0  # of land, in metres; files have values such as -9999 for no data


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

    @property
    def is_resampled(self) -> bool:
        """True if the heights of the scenario were sampled from those of the file between its posts."""
        return self.elevation is not None and _as_posts(self.elevation) is None

    def ground(self, points: Floats) -> Floats:
        """Return the heights of the ground, (n,), at points (n, 2) of the scenario: those of the file.

        They are NaN off the file, or next to its gaps. Without a file the scenario has them.
        """
        if self.elevation is None or not self.is_resampled:
            return self.scenario.ground(points)
        return self.elevation.at(self._in_file(points))

    def places_in_file(self, points: Floats) -> Floats:
        """Return points (n, 2) of the scenario as columns and rows of the file's posts, (n, 2)."""
        assert self.elevation is not None
        return (self._in_file(points) - self.elevation.origin) / self.elevation.spacing

    def _in_file(self, points: Floats) -> Floats:
        """Return points (n, 2) of the scenario in the coordinates of the file."""
        assert self.elevation is not None
        if self.elevation.kind == PLANE:
            return points
        assert self.system is not None
        return self.system.to_degrees(points)


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
            f"{path}: start and goal must be different points of the map, got {_words(start)} and "
            f"{_words(goal)}"
        )
    ends = np.array([start[:2], goal[:2]])
    system = _system_for(path, elevation, kind, ends)
    where = ends if kind == PLANE or system is None else system.to_metres(ends)
    heights, origin, cell = _ground(path, elevation, system, where, (start, goal), kind)
    if isinstance(system, PlaneSystem):
        require_true_lengths(str(path), system, where)
    cylinders = np.empty((0, 4)) if threats is None else cylinders_of(threats, kind, elevation, system)
    (x, y), (goal_x, goal_y) = where.tolist()
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
        raise ScenarioError(f"{file}: {error.role} {_words(end)} {error.fault}") from error
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
    user: str,
) -> tuple[Floats, tuple[float, float], float]:
    """Return heights around start and goal, the coordinates of the first one, and their distance.

    Messages name places in the kind of coordinates that the user gives.
    """
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
    _require_heights(path, heights, start, spacing, system if user == GEOGRAPHIC else None)
    x, y = start.tolist()
    return heights, (x, y), float(spacing)


def _require_heights(
    path: Path, heights: Floats, first: Floats, spacing: float, system: Projection | PlaneSystem | None
) -> None:
    """Raise a ScenarioError for gaps and for heights of no land; it names a place, in degrees by a system."""
    gaps, odd = np.isnan(heights), (heights < LOWEST) | (heights > HIGHEST)
    wrong = gaps if gaps.any() else odd
    if not wrong.any():
        return
    row, column = np.argwhere(wrong)[0].tolist()
    place = first + spacing * np.array([[column, row]])
    place = place if system is None else system.to_degrees(place)
    where = f"{path}: {int(wrong.sum())} of {wrong.size} cells around start and goal"
    if gaps.any():
        raise ScenarioError(
            f"{where} have no data, one at {_words(place[0])}; fill the gaps, for example with "
            "gdal_fillnodata"
        )
    raise ScenarioError(
        f"{where} have heights that no land has, {heights[row, column]:g} metres at {_words(place[0])}, "
        f"expected {LOWEST:g} to {HIGHEST:g}; if it stands for no data, say so in the file, for example with "
        "gdal_edit -a_nodata"
    )


def _words(point: Iterable[float]) -> str:
    """Return numbers of a point as they may be given: 7.404, 46.525, 150."""
    return ", ".join(f"{number:.10g}" for number in point)


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
