"""Obstacles grown by a margin: what a disc must not touch, its centre must stay out of."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.scenarios.dynamic.scenario import MapScenario
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.growing_grids import grown_on_cells
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Point, Polygon

STRAIGHT = 1e-14  # how far a corner may lie from the line between its neighbours, in edges, to be left out


def grown(scenario: MapScenario, margin: float, way: NDArray[np.float64] | None = None) -> MapScenario:
    """Return the scenario with obstacles that have grown by a margin, in map units.

    Circles and polygons grow exactly. The corners of a grown polygon are round. So it becomes a polygon with
    edges that are moved outwards, and a circle around each corner of the given one. A grid map is cut into
    smaller cells. A small cell is blocked exactly if a point of it is closer to a blocked cell than the
    margin. `grown_on_cells` says which passages stay open.

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
        return replace(scenario, obstacles=_all_grown(scenario.obstacles, margin))
    except ScenarioError as error:
        kind = NoPathError if isinstance(error, NoPathError) else ScenarioError
        raise kind(
            f"{error}; obstacles have grown by {margin:g}, for the robot's radius and the clearance"
        ) from error


def _all_grown(obstacles: Sequence[Obstacle], margin: float) -> tuple[Obstacle, ...]:
    """Return obstacles grown by a margin. Polygons that share a corner share the circle around it."""
    return tuple(dict.fromkeys(chain.from_iterable(_grown(obstacle, margin) for obstacle in obstacles)))


def _grown(obstacle: Obstacle, margin: float) -> list[Obstacle]:
    """Return obstacles whose union is an obstacle grown by a margin.

    A grown polygon is the hull of its edges, moved outwards by the margin, and a circle around each corner.
    """
    if isinstance(obstacle, Circle):
        return [Circle(obstacle.x, obstacle.y, obstacle.radius + margin)]
    corners: list[Point] = []
    for (x0, y0), (x1, y1) in obstacle.edges():
        length = math.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        out_x, out_y = margin * (y1 - y0) / length, margin * (x0 - x1) / length
        corners += [(x0 + out_x, y0 + out_y), (x1 + out_x, y1 + out_y)]
    outline = Polygon(_strictly_convex(corners))
    return [outline, *(Circle(x, y, margin) for x, y in obstacle.vertices)]


def _strictly_convex(corners: list[Point]) -> tuple[Point, ...]:
    """Return corners of a convex outline without those where it hardly turns.

    Where two edges are nearly parallel, their moved ends are so close that rounding decides how the outline
    turns. The line between the neighbours of a corner that is left out passes it within `STRAIGHT` edges.
    """
    kept = list(dict.fromkeys(corners))
    k, looked_at = 0, 0
    while looked_at < len(kept) and len(kept) > 3:
        before, here, after = kept[k - 1], kept[k], kept[(k + 1) % len(kept)]
        x, y = here[0] - before[0], here[1] - before[1]
        over_x, over_y = after[0] - before[0], after[1] - before[1]
        product = math.sqrt((x * x + y * y) * (over_x * over_x + over_y * over_y))
        if x * over_y - y * over_x <= STRAIGHT * product:
            del kept[k]
            k, looked_at = k - 1, -1  # its neighbours turn otherwise now
        k, looked_at = (k + 1) % len(kept), looked_at + 1
    return tuple(kept)
