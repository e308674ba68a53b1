"""Random occupancy grids for planners and for the oracle, which sees the cells as squares.

Cells that touch at a corner leave no gap, and a path stays on the map. The oracle works in cell coordinates.
"""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from helpers.trouble_plans import EPISODE, Outcome
from oracles.entered_depth import Blocked, entered_depth
from oracles.shapely_paths import shortest_length
from swarm_gym.errors import NoPathError, SwarmGymError
from swarm_gym.planning import plan
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridMap, GridScenario

GEOMETRIES = (
    {},
    {"resolution": 0.05, "origin": (-1.0, 2.0), "y_up": True},
    {"resolution": 0.25, "origin": (4e5, 5e6), "y_up": True},
    {"resolution": 128.0, "origin": (-3.0, 0.0)},
)
# Roundings may close gaps that are exactly as wide as the robot.
WIDER = 1.0 + 1e-9


@dataclass(frozen=True, eq=False)
class GridScene:
    """A task on a grid.

    Attributes:
        seed: seed that the scene was drawn from.
        scenario: the map with start and goal.
        radius: radius of the robot in cells.
        ends: start and goal, (2, 2) in cell coordinates.
    """

    seed: int
    scenario: GridScenario
    radius: float
    ends: np.ndarray

    def blocked(self, factor=1.0):
        """Return what is blocked in cell coordinates, for a robot with its radius times a factor."""
        return blocked_of(self.scenario.map.blocked, factor * self.radius)


def blocked_of(cells, radius):
    """Return what blocked cells, (height, width), block, in cell coordinates."""
    height, width = cells.shape
    area = shapely.union_all(_squares(cells))
    x0, y0, x1, y1 = -0.5, -0.5, width - 0.5, height - 0.5
    if radius > 0.0:
        return Blocked(area, radius=radius, box=(x0, y0, x1, y1))
    frame = shapely.box(x0 - 1, y0 - 1, x1 + 1, y1 + 1).difference(shapely.box(x0, y0, x1, y1))
    return Blocked(shapely.union_all([area, frame]), pinches=_pinches(cells))


def make_grid_scene(seed):
    """Draw a small map of noise, rectangles or walls, with ends in cells that are connected."""
    rng = np.random.default_rng([seed, 5])
    while True:
        cells = _cells(rng)
        radius = float(rng.uniform(0.3, 1.6)) if rng.random() < 0.5 else 0.0
        geometry = GEOMETRIES[rng.integers(len(GEOMETRIES))]
        grid = GridMap(f"trouble {seed}", cells, **geometry)
        if not cells.any():
            continue
        rows, columns = np.nonzero(~cells)
        for _ in range(20):
            a, b = rng.integers(len(rows), size=2)
            if grid.components[rows[a], columns[a]] != grid.components[rows[b], columns[b]]:
                continue
            centres = np.array([[columns[a], rows[a]], [columns[b], rows[b]]])
            placed = grid.to_map(centres + rng.integers(-28, 29, (2, 2)) / 64)
            ends = grid.to_cells(placed)
            if math.dist(*ends) < 5.0 or _distance(cells, ends) < 2.0 * radius:
                continue
            scenario = GridScenario(f"trouble:{seed}", grid, *map(tuple, placed.tolist()))
            return GridScene(seed, scenario, radius, ends)


def hold_grid(seed):
    """Return how the package fares on the grid of a seed; a robot with a radius is planned for."""
    scene = make_grid_scene(seed)
    outcome = Outcome(seed, "grid, radius" if scene.radius > 0.0 else "grid")
    outcome.length = shortest_length(scene.blocked(), *scene.ends)
    try:
        if scene.radius > 0.0:
            _hold_plan(outcome, scene)
        else:
            length, path = shortest_path(scene.scenario)
            outcome.error = abs(length / scene.scenario.map.resolution / outcome.length - 1.0)
            outcome.depth = _depth(scene, path)
    except SwarmGymError as error:
        outcome.refused = f"{type(error).__name__}: {error}"[:300]
    return outcome


def _hold_plan(outcome, scene):
    most = shortest_length(scene.blocked(WIDER), *scene.ends)
    resolution = scene.scenario.map.resolution
    try:
        found = plan(
            scene.scenario, robot_radius=scene.radius * resolution, max_evaluations=EPISODE, seed=scene.seed
        )
    except NoPathError as error:
        # Today a search without success is told from a map without a path by the text alone.
        outcome.unfound = math.isfinite(outcome.length) and str(error).startswith("no free path found")
        outcome.error = math.inf if math.isfinite(most) and not outcome.unfound else 0.0
        return
    outcome.depth = _depth(scene, found.path)
    exact = found.length / (1.0 + found.gap) / resolution
    outcome.error = max(outcome.length / exact - 1.0, 0.0 if math.isinf(most) else exact / most - 1.0, 0.0)
    outcome.gap = found.gap


def _depth(scene, path):
    cells = scene.scenario.map.to_cells(path)
    return entered_depth(scene.blocked(), cells) / max(scene.scenario.map.blocked.shape)


def _cells(rng):
    height, width = rng.integers(6, 22, 2)
    cells = np.zeros((height, width), dtype=np.bool_)
    kind = rng.integers(3)
    if kind == 0:
        return rng.random((height, width)) < rng.uniform(0.05, 0.35)
    for _ in range(rng.integers(2, 9)):
        row, column = rng.integers(height), rng.integers(width)
        tall, wide = rng.integers(1, 6, 2) if kind == 1 else rng.permutation([1, rng.integers(2, 16)])
        cells[row : row + tall, column : column + wide] = True
    return cells


def _squares(cells):
    rows, columns = np.nonzero(cells)
    return shapely.box(columns - 0.5, rows - 0.5, columns + 0.5, rows + 0.5)


def _pinches(cells):
    """Return the corners where exactly two cells touch diagonally, with the signs of each free quarter."""
    a, b, c, d = cells[:-1, :-1], cells[:-1, 1:], cells[1:, :-1], cells[1:, 1:]
    found = []
    for one, signs in ((a & d & ~b & ~c, [(1, -1), (-1, 1)]), (b & c & ~a & ~d, [(-1, -1), (1, 1)])):
        for row, column in zip(*np.nonzero(one), strict=True):
            found += [(column + 0.5, row + 0.5, *sign) for sign in signs]
    return np.array(found, dtype=float).reshape(-1, 4)


def _distance(cells, points):
    return float(
        shapely.distance(shapely.union_all(_squares(cells)), shapely.points(points)).min(initial=math.inf)
    )
