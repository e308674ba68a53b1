"""Tasks of planning: maps of any kind with a start and a goal, and the same maps with grown obstacles."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.clearance import clearance_of
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.planning.frame import Frame
from swarm_gym.planning.geojson import read_geojson
from swarm_gym.planning.map_names import ending_of, is_map_file
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import (
    AnyScenario,
    Circle,
    GridScenario,
    MapScenario,
    Obstacle,
    Point,
    Scenario,
    grown,
    make_scenario,
)
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.moving_ai import read_map
from swarm_gym.scenarios.formats.ros_map import read_ros_map

READERS = {".yaml": read_ros_map, ".yml": read_ros_map, ".map": read_map}  # endings in any case
GEOJSON = (".geojson", ".json")
# What the exact planner takes a second for, at most: cells of a grid map, corners and circles of others.
MOST_CELLS, MOST_CORNERS = 2**21, 2000

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """A task of planning.

    Attributes:
        given: the map as it is, with start and goal, in map units.
        margin: distance in map units that the path keeps from obstacles: radius of the robot and clearance.
        frame: the coordinates that the planner works in.
        bare: the map as it is, in the frame.
        grown: map with obstacles that have grown by the margin, in the frame: a point on it is the whole
            robot.
    """

    given: MapScenario
    margin: float
    frame: Frame
    bare: MapScenario
    grown: MapScenario

    @property
    def is_quick(self) -> bool:
        """Whether the exact shortest path is quickly computed, by the size of the map alone."""
        if isinstance(self.grown, GridScenario):
            return self.grown.map.blocked.size <= MOST_CELLS
        return sum(map(_corners, self.grown.solids)) <= MOST_CORNERS

    @cached_property
    def shortest(self) -> tuple[float, Floats]:
        """Length and points, (k, 2), of the exact shortest path of the robot, in the frame.

        Raises:
            NoPathError: if there is none.
        """
        return shortest_path(self.grown)


def read_task(
    where: str | Path | AnyScenario, start: Point | None, goal: Point | None, margin: float
) -> Task:
    """Return the task on a map.

    Args:
        where: a file, here or in the data folder: `.yaml` or `.yml` of ROS's map_server, `.map` of Moving
            AI, or GeoJSON with polygons; or a scenario or its name. A file that exists wins.
        start: (x, y), in map units; a scenario has its own.
        goal: (x, y), in map units; a scenario has its own.
        margin: distance to keep from obstacles, in map units.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that is outside the map, inside an
            obstacle, or closer to one than the margin.
        NoPathError: if obstacles separate start and goal, also after they have grown.
    """
    given = _given(where, start, goal)
    if isinstance(given, GridScenario):
        return Task(given, margin, Frame(), given, given if margin == 0.0 else grown(given, margin))
    frame = Frame.of(given)
    try:
        bare = frame.moved(given)
        return Task(given, margin, frame, bare, bare if margin == 0.0 else grown(bare, frame.factor * margin))
    except ScenarioError as error:
        raise ScenarioError(_refusal(given, margin) or str(error)) from error


def _refusal(given: Scenario, margin: float) -> str | None:
    """Return which end is too close to an obstacle, in the user's units; None if none is."""
    where = f"map {shown(given.name)}"
    for name, end in (("start", given.start), ("goal", given.target)):
        if any(solid.depth(end) > 0.0 for solid in given.solids):
            return f"{where}: {name} {end} lies inside an obstacle"
        apart = clearance_of(given, np.array([end, end]))
        if apart < margin:
            return (
                f"{where}: {name} {end} is {apart:.6g} from an obstacle; obstacles have grown by {margin:g}, "
                "for the robot's radius and the clearance"
            )
    return None


def _given(where: str | Path | AnyScenario, start: Point | None, goal: Point | None) -> MapScenario:
    named = str(where) if isinstance(where, str | Path) else ""
    if named and is_map_file(named, (*READERS, *GEOJSON)):
        ending = ending_of(named)
        if start is None or goal is None:
            raise ScenarioError(f"map {named!r}: a file needs a start and a goal, (x, y) in map units")
        path = Path(named) if Path(named).is_file() else find_data_file(named)
        if ending in GEOJSON:
            return read_geojson(path, start, goal)
        return GridScenario(path.stem, READERS[ending](path), start, goal)
    scenario = make_scenario(str(where) if isinstance(where, Path) else where)
    if not isinstance(scenario, Scenario | GridScenario):
        raise ScenarioError(f"scenario {shown(scenario.name)}: planning needs a map that stays as it is")
    if start is not None:
        scenario = replace(scenario, start=start)
    return scenario if goal is None else replace(scenario, target=goal)


def _corners(obstacle: Obstacle) -> int:
    return 1 if isinstance(obstacle, Circle) else len(obstacle.vertices)
