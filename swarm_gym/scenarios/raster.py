"""Analytic maps as grid maps."""

import math

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.grid_map import MAX_SIDE, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.obstacle_cells import cells_of
from swarm_gym.scenarios.scenario import Scenario


def rasterised(scenario: Scenario, cell_size: float) -> GridScenario:
    """An analytic map as one of cells: a path in free cells enters no obstacle.

    The map covers the workspace, and a little more at its right and upper end where that is no whole number
    of cells.

    Args:
        scenario: of the name that is kept.
        cell_size: side of a cell, in map units.

    Raises:
        ScenarioError: if there would be too many cells, if start or target lies in a blocked one, or if they
            are not connected any more.
    """
    x_min, y_min, x_max, y_max = scenario.workspace
    width, height = (max(math.ceil(length / cell_size), 1) for length in (x_max - x_min, y_max - y_min))
    if max(width, height) > MAX_SIDE:
        raise ScenarioError(
            f"scenario {shown(scenario.name)}: cells of {cell_size:g} make a map of {width} x {height}; "
            f"at most {MAX_SIDE} x {MAX_SIDE} are possible"
        )
    origin = (x_min + cell_size / 2.0, y_min + (height - 0.5) * cell_size)
    empty = GridMap(scenario.name, np.zeros((height, width), np.bool_), cell_size, origin, y_up=True)
    blocked = np.zeros((height, width), np.bool_)
    for obstacle in scenario.obstacles:
        blocked |= cells_of(obstacle, empty)
    grid = GridMap(scenario.name, blocked, cell_size, origin, y_up=True)
    return GridScenario(scenario.name, grid, scenario.start, scenario.target)
