"""Small maps for ants, and readers of their swarms."""

import numpy as np

from helpers.builders import METRES, walk_problem
from helpers.compiled import compiled
from swarm_gym.optimizers.ant_colony import trails
from swarm_gym.problem import WalkProblem
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridMap, GridScenario

NAME = "ant-colony"
MAPS = {"open": walk_problem("random", 4), "metres": walk_problem("random", 5, **METRES)}


def problem_of(picture, resolution=1.0):
    """Return the problem of a map of characters: # is blocked, S the start, T the target."""
    rows = [list(row) for row in picture.split()]
    cells = {c: (line.index(c), row) for row, line in enumerate(rows) for c in line if c in "ST"}
    grid = GridMap("picture", np.array([[c == "#" for c in line] for line in rows]), resolution)
    start, target = (tuple(grid.to_map(cells[role]).tolist()) for role in "ST")
    return WalkProblem(GridScenario("picture", grid, start, target))


def path_of(swarms, problem, b=0):
    """Return the best path so far, (k, 2)."""
    return np.array([*swarms.walk[b, : swarms.best_walk[b]], problem.scenario.target])


def cells_of(path, problem):
    return [problem.scenario.map.cell_of(point) for point in path.tolist()]


def optimum_of(problem):
    grid = problem.scenario.map
    ends = grid.cell_of(problem.scenario.start), grid.cell_of(problem.scenario.target)
    return shortest_grid_path(grid.blocked, *ends).length * grid.resolution


def length_of(path):
    return np.hypot(*np.diff(path, axis=0).T).sum()


def trails_of(swarms, problem):
    """Return tau of all moves, (H, W, 8), of the only swarm, which has this problem."""
    grid = problem.scenario.map
    array = swarms.field[0].copy()
    tau = np.empty((grid.height * grid.width, 8))
    for cell in range(len(tau)):
        place = compiled(trails.current_trails)(array, cell)
        tau[cell] = array[place : place + 8]
    return tau.reshape(grid.height, grid.width, 8)
