"""Tasks of planning: maps of any kind with a start and a goal, and the same maps with grown obstacles."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import ScenarioError, SettingError, shown
from swarm_gym.planning.feature_map import read_feature_map
from swarm_gym.planning.geographic import GEOGRAPHIC, Projection, require_coordinates
from swarm_gym.planning.shapes import thinnest
from swarm_gym.planning.workspace import Workspace, confined, read_workspace, require_within
from swarm_gym.scenarios import (
    AnyScenario,
    GridScenario,
    MapScenario,
    Point,
    Scenario,
    grown,
    make_scenario,
)
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.moving_ai import read_map
from swarm_gym.scenarios.formats.ros_map import read_ros_map

Floats = NDArray[np.float64]

READERS = {".yaml": read_ros_map, ".map": read_map}
GEOJSON = (".geojson", ".json")


@dataclass(frozen=True)
class Task:
    """A task of planning.

    Attributes:
        given: the map as it is, with start and goal.
        grown: map with obstacles that have grown by the margin: a point on it is the whole robot.
        margin: distance in map units that the path keeps from obstacles: radius of the robot and clearance.
        start: start in the user's coordinates.
        goal: goal in the user's coordinates.
        projection: projection from the user's longitudes and latitudes to map units, which are metres then;
            None if the user's coordinates are map units.
    """

    given: MapScenario
    grown: MapScenario
    margin: float
    start: Point
    goal: Point
    projection: Projection | None

    def for_user(self, path: Floats) -> Floats:
        """Return a path from start to goal, (k, 2), in the user's coordinates."""
        if self.projection is None:
            return path
        points = self.projection.to_degrees(path)
        points[0], points[-1] = self.start, self.goal
        return points

    def on_map(self, path: Floats) -> Floats:
        """Return a path in the user's coordinates, (k, 2), in map units."""
        return path if self.projection is None else self.projection.to_metres(path)


def read_task(
    where: str | Path | AnyScenario,
    start: Point | None,
    goal: Point | None,
    margin: float,
    workspace: str | Path | ArrayLike | None = None,
    coordinates: str | None = None,
) -> Task:
    """Return the task on a map.

    Args:
        where: a file, here or in the data folder: `.yaml` of ROS's map_server, `.map` of Moving AI, or
            GeoJSON; or a scenario or its name.
        start: (x, y), in the user's coordinates; a scenario has its own.
        goal: (x, y), in the user's coordinates; a scenario has its own.
        margin: distance to keep from obstacles, in map units.
        workspace: box, polygon or file of what the robot stays in, see `read_workspace`; None for no limit.
        coordinates: kind of the user's coordinates, see `COORDINATES`; None takes what the file names.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that is outside the map or the
            workspace, inside an obstacle, or closer to one than the margin.
        SettingError: for a workspace or kind of coordinates that is invalid, or that the map cannot have.
        NoPathError: if obstacles separate start and goal, also after they have grown.
    """
    require_coordinates(coordinates)
    area = None if workspace is None else read_workspace(workspace)
    given, projection = _given(where, start, goal, margin, area, coordinates)
    larger = given if margin == 0.0 else grown(given, margin)
    if projection is None:
        return Task(given, larger, margin, given.start, given.target, None)
    assert start is not None  # as files need it
    assert goal is not None
    return Task(given, larger, margin, start, goal, projection)


def _given(
    where: str | Path | AnyScenario,
    start: Point | None,
    goal: Point | None,
    margin: float,
    workspace: Workspace | None,
    coordinates: str | None,
) -> tuple[MapScenario, Projection | None]:
    """Return the map with start and goal, and the projection that it comes from."""
    named = str(where) if isinstance(where, str | Path) else ""
    ending = Path(named).suffix
    if ending not in (*READERS, *GEOJSON) or set("?#") & set(named):
        scenario = _of_name(where, start, goal)
    else:
        if start is None or goal is None:
            raise ScenarioError(f"map {named!r}: a file needs a start and a goal, (x, y) in map units")
        path = Path(named) if Path(named).is_file() else find_data_file(named)
        if ending in GEOJSON:
            return read_feature_map(path, start, goal, margin, workspace, coordinates)
        scenario = GridScenario(path.stem, READERS[ending](path), start, goal)
    if coordinates == GEOGRAPHIC:
        raise SettingError(
            f"coordinates {coordinates!r}: expected a GeoJSON file, the map is {scenario.name!r}"
        )
    return _within(scenario, workspace, margin), None


def _of_name(where: str | Path | AnyScenario, start: Point | None, goal: Point | None) -> MapScenario:
    """Return a scenario or the one of that name, with other ends where these are given."""
    scenario = make_scenario(str(where) if isinstance(where, Path) else where)
    if not isinstance(scenario, Scenario | GridScenario):
        raise ScenarioError(f"scenario {shown(scenario.name)}: planning needs a map that stays as it is")
    if start is not None:
        scenario = replace(scenario, start=start)
    return scenario if goal is None else replace(scenario, target=goal)


def _within(scenario: MapScenario, workspace: Workspace | None, margin: float) -> MapScenario:
    """Return the scenario, confined to the workspace if there is one."""
    if workspace is None:
        return scenario
    if isinstance(scenario, GridScenario):
        raise SettingError(
            f"{workspace.shape.name}: map {scenario.name!r} has cells, and the border of such a map is the "
            "workspace; leave the option out, or block cells"
        )
    ends = (("start", scenario.start), ("goal", scenario.target))
    points = np.array([*workspace.shape.parts[0], scenario.start, scenario.target])
    for role, end in ends:
        require_within(role, end, end, workspace.shape, thinnest(points), margin)
    return confined(scenario, workspace.shape)
