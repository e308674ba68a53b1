"""Obstacles grown by a margin: what a disc must not touch, its centre must stay out of."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import cos, sin
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.scenarios.dynamic.scenario import MapScenario
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.growing_grids import grown_on_cells
from swarm_gym.scenarios.scenario import Circle, Obstacle, Polygon

CORNERS = 32  # of the polygon around a disc, by which polygons grow


def grown(scenario: MapScenario, margin: float, way: NDArray[np.float64] | None = None) -> MapScenario:
    """Return the scenario with obstacles that have grown by a margin, in map units.

    The corners of a grown polygon are round. They are replaced by polygons around them, which are larger by
    0.5 % of the margin at most. A grid map is cut into smaller cells, and a small cell is blocked exactly if
    a point of it is closer to a blocked cell than the margin. `grown_on_cells` says which passages stay open.

    Args:
        scenario: the map, with start and target.
        margin: distance by which obstacles grow, in map units.
        way: (k, 2) points of a path that is known to keep the margin; on a grid map, small cells along it are
            open.

    Raises:
        ScenarioError: if an end is inside a grown obstacle, or closer to a blocked cell than the margin.
        NoPathError: if grown obstacles separate the ends.
    """
    try:
        if isinstance(scenario, GridScenario):
            return grown_on_cells(scenario, margin, way)
        return replace(scenario, obstacles=tuple(_grown(obstacle, margin) for obstacle in scenario.obstacles))
    except ScenarioError as error:
        kind = NoPathError if isinstance(error, NoPathError) else ScenarioError
        raise kind(
            f"{error}; obstacles have grown by {margin:g}, for the robot's radius and the clearance"
        ) from error


def _grown(obstacle: Obstacle, margin: float) -> Obstacle:
    if isinstance(obstacle, Circle):
        return Circle(obstacle.x, obstacle.y, obstacle.radius + margin)
    from scipy.spatial import ConvexHull

    angles = np.arange(CORNERS) * math.tau / CORNERS
    around = margin / cos(math.pi / CORNERS) * np.stack([cos(angles), sin(angles)], axis=-1)
    points = (np.array(obstacle.vertices)[:, None] + around).reshape(-1, 2)
    return Polygon(tuple(map(tuple, points[ConvexHull(points).vertices].tolist())))
