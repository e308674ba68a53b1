"""Pieces of a path that enter something blocked, planned anew between points before and behind them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swarm_gym import reference  # its planners are imported when they are first used
from swarm_gym.errors import ScenarioError
from swarm_gym.problem import MapProblem
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]


def replanned(problem: MapProblem, path: Floats) -> tuple[Floats, int]:
    """Return the path, (k, 2), with pieces that are not clear planned anew, and the number of these.

    A piece goes from the last point before it that is free to the first free one behind it. A piece between
    which and its ends there is no way stays as it is.
    """
    free = np.array([problem.is_clear(np.stack([point, point])) for point in path])
    clear = np.array([problem.is_clear(path[k : k + 2]) for k in range(len(path) - 1)])
    parts, pieces, here = [path[:1]], 0, 0
    while here < len(path) - 1:
        if clear[here]:
            parts.append(path[here + 1 : here + 2])
            here += 1
            continue
        there = here + 1
        while there < len(path) - 1 and not free[there]:
            there += 1
        way = _way(problem, path[here], path[there])
        parts.append(path[here + 1 : there + 1] if way is None else way[1:])
        pieces += way is not None
        here = there
    return np.concatenate(parts), pieces


def _way(problem: MapProblem, start: Floats, target: Floats) -> Floats | None:
    """Return a free way between two points, (k, 2), with them; None if there is none."""
    scenario = problem.scenario
    try:
        if isinstance(scenario, GridScenario):
            grid = scenario.map
            ends = grid.cell_of(tuple(start)), grid.cell_of(tuple(target))
            found = reference.shortest_grid_path(grid.blocked, *ends)
            return np.vstack([start, grid.to_map(reference.smooth(grid.blocked, found.cells)), target])
        between = replace(scenario, start=tuple(start.tolist()), target=tuple(target.tolist()))
        return reference.shortest_path(between)[1]
    except ScenarioError:
        return None
