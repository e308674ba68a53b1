"""Maps of any kind with a start and a goal: files of ROS, Moving AI and GeoJSON, and scenarios by name."""

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from swarm_gym.errors import ScenarioError, SettingError, shown
from swarm_gym.outputs import files_named
from swarm_gym.planning.feature_map import read_feature_map
from swarm_gym.planning.map_names import ending_of, is_map_file
from swarm_gym.planning.shapes import End, thinnest
from swarm_gym.planning.workspace import RobotWorkspace, confined
from swarm_gym.scenarios import (
    AnyScenario,
    GridMap,
    GridScenario,
    MapScenario,
    Point,
    Scenario,
    TerrainScenario,
    make_scenario,
)
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC, Projection
from swarm_gym.scenarios.formats.moving_ai import read_graded_map, read_map
from swarm_gym.scenarios.formats.ros_map import (
    ENDINGS,
    read_graded_ros_map,
    read_ros_map,
    read_yaml,
)
from swarm_gym.scenarios.graded_map import GradedMap, Grading

READERS = {".yaml": read_ros_map, ".yml": read_ros_map, ".map": read_map}  # endings in any case
GRADED_READERS = {
    ".yaml": read_graded_ros_map,
    ".yml": read_graded_ros_map,
    ".map": read_graded_map,
}
AnyMap = str | Path | AnyScenario | GridMap | GradedMap
GEOJSON = (".geojson", ".json")


class ReadMap(NamedTuple):
    """A map with start and goal.

    Attributes:
        scenario: the map as it is.
        projection: projection that it comes from; None for coordinates in a plane.
        reference: member "crs" of a GeoJSON file, which names its coordinates; None without one.
    """

    scenario: MapScenario
    projection: Projection | None = None
    reference: object = None


def read_any_map(
    where: AnyMap,
    start: Point | None,
    goal: Point | None,
    margin: float,
    workspace: RobotWorkspace | None,
    coordinates: str | None,
    grading: Grading,
) -> ReadMap:
    """Return the map with start and goal, and the projection that it comes from.

    Args:
        where: a file, here or in the data folder, a scenario or its name, or a map of cells. A file that
            exists wins.
        start: (x, y), in the user's coordinates; a scenario has its own.
        goal: (x, y), in the user's coordinates; a scenario has its own.
        margin: distance to keep from obstacles, in map units.
        workspace: polygon that the robot stays in; None for no limit.
        coordinates: kind of the user's coordinates; None takes what the file names.
        grading: meaning of the grades of a file.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that cannot be one.
        SettingError: for a workspace or coordinates that the map cannot have.
    """
    scenario: MapScenario
    if not isinstance(where, GridMap | GradedMap) and _is_file(where):
        if start is None or goal is None:
            raise ScenarioError(f"map {str(where)!r}: a file needs a start and a goal, (x, y) in map units")
        if ending_of(str(where)) in GEOJSON:
            _refuse_grading(grading, str(where))
            path = _path_of(where)
            return ReadMap(*read_feature_map(path, start, goal, margin, workspace, coordinates))
        where, grading = read_cells(where, grading), Grading()
    if isinstance(where, GridMap | GradedMap):
        grid, ground = (where, None) if isinstance(where, GridMap) else (where.grid, where)
        if start is None or goal is None:
            raise ScenarioError(f"map {shown(grid.name)}: expected a start and a goal, (x, y) in map units")
        _refuse_grading(grading, grid.name)
        scenario = GridScenario(grid.name, grid, start, goal, ground)
    else:
        scenario = _of_name(where, start, goal)
        _refuse_grading(grading, scenario.name)
    if coordinates == GEOGRAPHIC:
        raise SettingError(
            f"coordinates {coordinates!r}: expected a GeoJSON file, the map is {scenario.name!r}"
        )
    return ReadMap(_within(scenario, workspace, margin))


def read_cells(where: AnyMap, grading: Grading) -> AnyMap:
    """Return the map of cells in a file; what is no such file is returned as it is.

    Args:
        where: a file, here or in the data folder, or any other map.
        grading: meaning of the grades of a file.

    Raises:
        ScenarioError: for a file that is missing or malformed.
        SettingError: for grades that the map cannot have.
    """
    if isinstance(where, GridMap | GradedMap) or not _is_file(where) or ending_of(str(where)) in GEOJSON:
        return where
    ending, path = ending_of(str(where)), _path_of(where)
    return READERS[ending](path) if grading.is_usual else GRADED_READERS[ending](path, grading)


def files_of(where: str) -> list[Path]:
    """Return the files that hold the map of a name: its file and the picture that it names, or none.

    Args:
        where: name of a file, here or in the data folder, or of a scenario, which may contain that of a file.

    Raises:
        ScenarioError: for a file that is missing or malformed.
        MissingExtraError: if PyYAML is missing.
    """
    paths = [_path_of(where)] if _is_file(where) else files_named(where)
    images = [read_yaml(path).image for path in paths if ending_of(path) in ENDINGS]
    return [*paths, *images]


def _is_file(where: str | Path | AnyScenario) -> bool:
    """Return whether a map is named by a file that is read here."""
    return isinstance(where, str | Path) and is_map_file(str(where), (*READERS, *GEOJSON))


def _path_of(where: str | Path | AnyScenario) -> Path:
    return Path(str(where)) if Path(str(where)).is_file() else find_data_file(str(where))


def _refuse_grading(grading: Grading, name: str) -> None:
    """Raise an error if grades are chosen for a map that no file with grades describes."""
    if not grading.is_usual:
        raise SettingError(
            f"unknown, lethal, terrain: expected a file of ROS or of Moving AI, map {shown(name)} "
            "has no grades that could be chosen; leave these options out"
        )


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
