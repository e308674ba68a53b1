"""Tasks of planning: maps of any kind with a start and a goal, and the same maps with grown obstacles."""

from dataclasses import dataclass, replace
from pathlib import Path

from swarm_gym.errors import NoPathError, ScenarioError, shown
from swarm_gym.planning.geojson import read_geojson
from swarm_gym.reference import known_robot_path
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

READERS = {".yaml": read_ros_map, ".map": read_map}
GEOJSON = (".geojson", ".json")


@dataclass(frozen=True)
class Task:
    """A task of planning.

    Attributes:
        given: the map as it is, with start and goal.
        grown: map with obstacles that have grown by the margin: a point on it is the whole robot. On grid
            maps, cells at the ends, or along an exact path, may be open though parts of them are too close.
        margin: distance in map units that the path keeps from obstacles: radius of the robot and clearance.
    """

    given: MapScenario
    grown: MapScenario
    margin: float


def read_task(
    where: str | Path | AnyScenario, start: Point | None, goal: Point | None, margin: float
) -> Task:
    """Return the task on a map.

    Args:
        where: a file, here or in the data folder: `.yaml` of ROS's map_server, `.map` of Moving AI, or
            GeoJSON with polygons; or a scenario or its name.
        start: (x, y), in map units; a scenario has its own.
        goal: (x, y), in map units; a scenario has its own.
        margin: distance to keep from obstacles, in map units.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that is outside the map, inside an
            obstacle, or closer to one than the margin.
        NoPathError: if obstacles separate start and goal, also after they have grown; on grid maps, if the
            robot does not fit through by exact geometry.
    """
    given = _given(where, start, goal)
    if margin == 0.0:
        return Task(given, given, margin)
    try:
        return Task(given, grown(given, margin), margin)
    except NoPathError as error:
        if not isinstance(given, GridScenario):
            raise
        return Task(given, _grown_along_exact_path(given, margin, error), margin)


def _grown_along_exact_path(given: GridScenario, margin: float, error: NoPathError) -> MapScenario:
    """Return a grown map that is open along the exact path, where rounding to cells has separated the ends.

    Raises:
        NoPathError: if there is no exact path, or it is unknown: then the error that is given, and a hint.
    """
    exact = known_robot_path(given, margin)
    if exact is None:
        raise NoPathError(
            f"{error}; rounding to small cells closes passages that are hardly wider than the robot, whose "
            f"diameter is {2.0 * margin:g} with the clearance: try a map of finer cells than "
            f"{given.map.resolution:g}, or only the part around start and goal"
        ) from error
    return grown(given, margin, exact[1])


def _given(where: str | Path | AnyScenario, start: Point | None, goal: Point | None) -> MapScenario:
    named = str(where) if isinstance(where, str | Path) else ""
    ending = Path(named).suffix
    if ending in (*READERS, *GEOJSON) and not set("?#") & set(named):
        if start is None or goal is None:
            raise ScenarioError(f"map {named!r}: a file needs a start and a goal, (x, y) in map units")
        path = Path(named) if Path(named).is_file() else find_data_file(named)
        if ending in GEOJSON:
            return read_geojson(path, start, goal)
        return GridScenario(path.stem, READERS[ending](path), start, goal)
    scenario = make_scenario(str(where) if isinstance(where, Path) else where)
    if not isinstance(scenario, Scenario | GridScenario):
        raise ScenarioError(f"scenario {shown(scenario.name)}: planning needs a map that stays as it is")
    ends = (scenario.start if start is None else start), (scenario.target if goal is None else goal)
    return replace(scenario, start=ends[0], target=ends[1])
