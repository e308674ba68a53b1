"""The exact shortest path on any scenario, whatever its map."""

import math
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import NoPathError, ScenarioError, shown
from swarm_gym.reference import visibility
from swarm_gym.reference.any_angle import AnyAnglePlanner
from swarm_gym.reference.disc_planner import DiscPlanner, TooMuchWorkError, never
from swarm_gym.scenarios import (
    AnyScenario,
    DynamicScenario,
    FunctionScenario,
    GridMap,
    GridScenario,
    Scenario,
    TerrainScenario,
)

Floats = NDArray[np.float64]

MOST_WORK = 5e7  # of a known path of a robot, see `disc_planner`: a few seconds


def shortest_path(scenario: AnyScenario) -> tuple[float, Floats]:
    """Return the shortest path from start to target that does not enter an obstacle or a blocked cell.

    It may touch them. On maps of circles and polygons it may leave the workspace, on grid maps not.

    Returns:
        The length in map units, and the path as a polyline in map coordinates, shape (k, 2).

    Raises:
        ScenarioError: if there is none, or no map.
    """
    if isinstance(scenario, FunctionScenario):
        raise ScenarioError(f"scenario {scenario.name!r} is a test function: there is no path")
    if isinstance(scenario, DynamicScenario):
        raise ScenarioError(f"scenario {scenario.name!r} is dynamic: a shortest path is one of its `worlds`'")
    if isinstance(scenario, TerrainScenario):
        raise ScenarioError(
            f"scenario {scenario.name!r} is a flight over terrain, for which no shortest path is computed; a "
            "swarm searches for a flight of least cost"
        )
    if isinstance(scenario, Scenario):
        return visibility.shortest_path(scenario)
    grid = scenario.map
    start, target = grid.to_cells([scenario.start, scenario.target]).tolist()
    length, points = _planner(grid).shortest_path(start, target)
    return length * grid.resolution, grid.to_map(points)


def shortest_robot_path(
    scenario: GridScenario,
    margin: float,
    most_work: float = math.inf,
    is_stopped: Callable[[], bool] = never,
) -> tuple[float, Floats]:
    """Return the shortest path from start to target that keeps a margin from all blocked cells of a grid map.

    It is the path of the centre of a disc on the map as it is. The disc may touch blocked cells, so that it
    passes gaps that are as wide as itself. It may leave the map, but its centre does not.

    Args:
        scenario: the map, with start and target.
        margin: radius of the disc in map units; 0 is `shortest_path`.
        most_work: work after which the search is given up, in rows of the grid, see `disc_planner`.
        is_stopped: whether the search shall end; asked again and again, unless the margin is 0.

    Returns:
        The length in map units, arcs included. A polyline in map coordinates, (k, 2), that keeps the margin
        too, up to 1e-9 cells: its points lie outside of the arcs. It is longer by a share of 2.5e-7 at most.

    Raises:
        ScenarioError: if an end is closer to a blocked cell than the margin.
        NoPathError: if the disc does not fit through between the ends.
        TooMuchWorkError: if the search takes more work than is allowed.
        StoppedError: if it was ended.
    """
    if margin == 0.0:
        return shortest_path(scenario)
    grid = scenario.map
    planner = _disc_planner(grid, margin / grid.resolution, most_work)
    try:
        start, goal = grid.to_cells([scenario.start, scenario.target]).tolist()
        length, points = planner.shortest_path(start, goal, is_stopped)
    except NoPathError as error:
        raise NoPathError(
            f"scenario {shown(scenario.name)} on map {grid.name!r}: no path leads from start "
            f"{scenario.start} to target {scenario.target} for a disc of diameter {2.0 * margin:g}, twice "
            "the robot's radius and the clearance: blocked cells leave no passage that wide"
        ) from error
    path = grid.to_map(points)
    path[0], path[-1] = scenario.start, scenario.target
    return length * grid.resolution, path


def known_robot_path(
    scenario: GridScenario, margin: float, is_stopped: Callable[[], bool] = never
) -> tuple[float, Floats] | None:
    """Return what `shortest_robot_path` returns; None if that takes more work than `MOST_WORK`.

    Raises:
        StoppedError: if `is_stopped` ended the search.
    """
    try:
        return shortest_robot_path(scenario, margin, MOST_WORK, is_stopped)
    except TooMuchWorkError:
        return None


def prepare(grid: GridMap, margin: float) -> None:
    """Make what `known_robot_path` keeps for a map and a margin, in map units, so that it answers sooner."""
    if margin == 0.0:
        _planner(grid)
        return
    with suppress(TooMuchWorkError):
        _disc_planner(grid, margin / grid.resolution, MOST_WORK)


@lru_cache(maxsize=4)
def _disc_planner(grid: GridMap, radius: float, most_work: float) -> DiscPlanner:
    return DiscPlanner(grid.blocked, radius, most_work)


@lru_cache(maxsize=8)
def _planner(grid: GridMap) -> AnyAnglePlanner:
    return AnyAnglePlanner(grid.blocked)
