"""Maps of any kind with a start and a goal: files of ROS, Moving AI and GeoJSON, and scenarios by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from swarm_gym.errors import ScenarioError, SettingError, shown
from swarm_gym.planning.feature_map import read_feature_map
from swarm_gym.planning.map_names import ending_of, is_map_file
from swarm_gym.planning.shapes import End, thinnest
from swarm_gym.planning.workspace import RobotWorkspace, confined
from swarm_gym.scenarios import (
    AnyScenario,
    GridScenario,
    MapScenario,
    Point,
    Scenario,
    TerrainScenario,
    make_scenario,
)
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC, Projection
from swarm_gym.scenarios.formats.moving_ai import read_map
from swarm_gym.scenarios.formats.ros_map import read_ros_map

READERS = {".yaml": read_ros_map, ".yml": read_ros_map, ".map": read_map}  # endings in any case
GEOJSON = (".geojson", ".json")


def read_any_map(
    where: str | Path | AnyScenario,
    start: Point | None,
    goal: Point | None,
    margin: float,
    workspace: RobotWorkspace | None,
    coordinates: str | None,
) -> tuple[MapScenario, Projection | None]:
    """Return the map with start and goal, and the projection that it comes from.

    Args:
        where: a file, here or in the data folder, or a scenario or its name. A file that exists wins.
        start: (x, y), in the user's coordinates; a scenario has its own.
        goal: (x, y), in the user's coordinates; a scenario has its own.
        margin: distance to keep from obstacles, in map units.
        workspace: polygon that the robot stays in; None for no limit.
        coordinates: kind of the user's coordinates; None takes what the file names.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that cannot be one.
        SettingError: for a workspace or coordinates that the map cannot have.
    """
    named = str(where) if isinstance(where, str | Path) else ""
    scenario: MapScenario
    if named and is_map_file(named, (*READERS, *GEOJSON)):
        ending = ending_of(named)
        if start is None or goal is None:
            raise ScenarioError(f"map {named!r}: a file needs a start and a goal, (x, y) in map units")
        path = Path(named) if Path(named).is_file() else find_data_file(named)
        if ending in GEOJSON:
            return read_feature_map(path, start, goal, margin, workspace, coordinates)
        scenario = GridScenario(path.stem, READERS[ending](path), start, goal)
    else:
        scenario = _of_name(where, start, goal)
    if coordinates == GEOGRAPHIC:
        raise SettingError(
            f"coordinates {coordinates!r}: expected a GeoJSON file, the map is {scenario.name!r}"
        )
    return _within(scenario, workspace, margin), None


def _of_name(where: str | Path | AnyScenario, start: Point | None, goal: Point | None) -> MapScenario:
    """Return a scenario or the one of that name, with other ends where these are given."""
    scenario = make_scenario(str(where) if isinstance(where, Path) else where)
    if isinstance(scenario, TerrainScenario):
        raise ScenarioError(
            f"scenario {shown(scenario.name)}: a flight over terrain has heights; plan it with "
            "swarm_gym.plan_flight"
        )
    if not isinstance(scenario, Scenario | GridScenario):
        raise ScenarioError(f"scenario {shown(scenario.name)}: planning needs a map that stays as it is")
    ends = (scenario.start if start is None else start), (scenario.target if goal is None else goal)
    return replace(scenario, start=ends[0], target=ends[1])


def _within(scenario: MapScenario, workspace: RobotWorkspace | None, margin: float) -> MapScenario:
    """Return the scenario, confined to the workspace if there is one."""
    if workspace is None:
        return scenario
    if isinstance(scenario, GridScenario):
        raise SettingError(
            f"{workspace.shape.name}: map {scenario.name!r} has cells, and the border of such a map is the "
            "workspace; leave the option out, or block cells"
        )
    points = np.array([*workspace.shape.parts[0], scenario.start, scenario.target])
    for role, point in (("start", scenario.start), ("goal", scenario.target)):
        End(role, point, given=point).require_within(workspace.shape, thinnest(points), margin)
    return confined(scenario, workspace.shape)
