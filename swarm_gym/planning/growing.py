"""Obstacles grown by a margin: what a disc must not touch, its centre must stay out of."""

import math
from dataclasses import replace

import numpy as np
from scipy.spatial import ConvexHull

from swarm_gym.scenarios import Circle, GridMap, Obstacle, Polygon, Scenario
from swarm_gym.scenarios.grid_map import MAX_SIDE

CORNERS = 32  # of the polygon around a disc, by which polygons grow
FINE = 4.0  # cells of a grown grid map are as small as the margin over this, if the map is not too large then
MOST_CELLS = 2**22


def grown(scenario: Scenario, margin: float) -> Scenario:
    """Return the scenario with obstacles that have grown by a margin, in map units.

    The corners of a grown polygon are round. They are replaced by polygons around them, which are larger by
    0.5 % of the margin at most.
    """
    return replace(scenario, obstacles=tuple(_grown(obstacle, margin) for obstacle in scenario.obstacles))


def grown_grid(grid: GridMap, margin: float) -> GridMap:
    """Return the map, in smaller cells, with all cells blocked of which a point is closer than the margin.

    Passages that are wider than twice the margin by less than 1.5 small cells are closed.
    """
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
    angles = np.arange(CORNERS) * math.tau / CORNERS
    around = margin / math.cos(math.pi / CORNERS) * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    points = (np.array(obstacle.vertices)[:, None] + around).reshape(-1, 2)
    return Polygon(tuple(map(tuple, points[ConvexHull(points).vertices].tolist())))
