"""The exact shortest path on any scenario, whatever its map."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.reference import visibility
from swarm_gym.reference.any_angle import AnyAnglePlanner
from swarm_gym.scenarios import AnyScenario, DynamicScenario, FunctionScenario, GridMap, Scenario


def shortest_path(scenario: AnyScenario) -> tuple[float, NDArray[np.float64]]:
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
    if isinstance(scenario, Scenario):
        return visibility.shortest_path(scenario)
    grid = scenario.map
    start, target = grid.to_cells([scenario.start, scenario.target]).tolist()
    length, points = _planner(grid).shortest_path(start, target)
    return length * grid.resolution, grid.to_map(points)


@lru_cache(maxsize=8)
def _planner(grid: GridMap) -> AnyAnglePlanner:
    return AnyAnglePlanner(grid.blocked)
