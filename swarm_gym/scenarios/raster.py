"""Circles and polygons as cells: which ones an obstacle blocks, and analytic maps as grid maps."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.grid_map import MAX_SIDE, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.scenario import Circle, Obstacle, Polygon, Scenario

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def covered_cells(grid: GridMap, obstacle: Obstacle) -> Flags:
    """Which cells of a grid, (height, width), an obstacle reaches into: both are open sets.

    Args:
        grid: whose cells.
        obstacle: in map coordinates; it may reach beyond the grid.
    """
    centres = grid.to_map(np.stack(np.meshgrid(np.arange(grid.width), np.arange(grid.height)), axis=-1))
    half = grid.resolution / 2.0
    if isinstance(obstacle, Circle):
        beyond = np.maximum(np.abs(centres - (obstacle.x, obstacle.y)) - half, 0.0)
        return np.hypot(beyond[..., 0], beyond[..., 1]) < obstacle.radius
    return _covered_by_polygon(centres, half, obstacle)


def _covered_by_polygon(centres: Floats, half: float, polygon: Polygon) -> Flags:
    """Convex sets that do not meet are apart along an axis, or across an edge of the polygon."""
    vertices = np.array(polygon.vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    covered = np.all((centres + half > low) & (centres - half < high), axis=-1)
    for (x, y), (to_x, to_y) in polygon.edges():
        length = math.hypot(to_x - x, to_y - y)
        across = np.array([(y - to_y) / length, (to_x - x) / length])  # to the inside, which is on the left
        covered &= (centres - (x, y)) @ across + half * np.abs(across).sum() > 0.0
    return covered


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
            f"scenario {scenario.name!r}: cells of {cell_size:g} make a map of {width} x {height}; at most "
            f"{MAX_SIDE} x {MAX_SIDE} are possible"
        )
    origin = (x_min + cell_size / 2.0, y_min + (height - 0.5) * cell_size)
    empty = GridMap(scenario.name, np.zeros((height, width), np.bool_), cell_size, origin, y_up=True)
    blocked = np.zeros((height, width), np.bool_)
    for obstacle in scenario.obstacles:
        blocked |= covered_cells(empty, obstacle)
    grid = GridMap(scenario.name, blocked, cell_size, origin, y_up=True)
    return GridScenario(scenario.name, grid, scenario.start, scenario.target)
