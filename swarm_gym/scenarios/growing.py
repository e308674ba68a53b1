"""Obstacles grown by a margin: what a disc must not touch, its centre must stay out of."""

import math
from dataclasses import replace

import numpy as np

from swarm_gym.compiler.elementary import cos, sin
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.scenarios.dynamic.scenario import MapScenario
from swarm_gym.scenarios.grid_map import MAX_SIDE, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Polygon

CORNERS = 32  # of the polygon around a disc, by which polygons grow
FINE = 4.0  # cells of a grown grid map are as small as the margin over this, if the map is not too large then
MOST_CELLS = 2**22


def grown(scenario: MapScenario, margin: float) -> MapScenario:
    """Return the scenario with obstacles that have grown by a margin, in map units.

    The corners of a grown polygon are round. They are replaced by polygons around them, which are larger by
    0.5 % of the margin at most. A grid map is cut into smaller cells, and a cell is blocked if a point of it
    is closer to a blocked cell than the margin; passages that are wider than twice the margin by less than
    1.5 small cells are closed.

    Raises:
        ScenarioError: if an end is inside a grown obstacle.
        NoPathError: if grown obstacles separate the ends.
    """
    try:
        if isinstance(scenario, GridScenario):
            return replace(scenario, map=_grown_grid(scenario.map, margin))
        return replace(scenario, obstacles=tuple(_grown(obstacle, margin) for obstacle in scenario.obstacles))
    except ScenarioError as error:
        kind = NoPathError if isinstance(error, NoPathError) else ScenarioError
        raise kind(
            f"{error}; obstacles have grown by {margin:g}, for the robot's radius and the clearance"
        ) from error


def _grown_grid(grid: GridMap, margin: float) -> GridMap:
    most = min(MAX_SIDE // max(grid.width, grid.height), math.isqrt(MOST_CELLS // grid.blocked.size))
    parts = max(1, min(math.ceil(FINE * grid.resolution / margin), most))
    side = grid.resolution / parts
    first = 0.5 / parts - 0.5
    x, y = grid.to_map((first, first)).tolist()
    blocked = np.repeat(np.repeat(grid.blocked, parts, axis=0), parts, axis=1)
    small = GridMap(grid.name, blocked, side, (x, y), grid.y_up)
    return small.inflated(margin + side * math.sqrt(0.5))


def _grown(obstacle: Obstacle, margin: float) -> Obstacle:
    if isinstance(obstacle, Circle):
        return Circle(obstacle.x, obstacle.y, obstacle.radius + margin)
    from scipy.spatial import ConvexHull

    angles = np.arange(CORNERS) * math.tau / CORNERS
    around = margin / cos(math.pi / CORNERS) * np.stack([cos(angles), sin(angles)], axis=-1)
    points = (np.array(obstacle.vertices)[:, None] + around).reshape(-1, 2)
    return Polygon(tuple(map(tuple, points[ConvexHull(points).vertices].tolist())))
