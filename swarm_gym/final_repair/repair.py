"""Final repair: push a path out of obstacles, plan again what is left, pull it tight, check it exactly."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym import reference  # its planners are imported when they are first used
from swarm_gym.errors import ScenarioError
from swarm_gym.final_repair.obstacles import obstacles_of, push_out
from swarm_gym.final_repair.tightening import CellMap, tighten
from swarm_gym.problem import MapProblem
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios import GridScenario, Scenario

Floats = NDArray[np.float64]

MOST_SWEEPS = 200
MOST_ROUNDS = 100


@dataclass(frozen=True)
class FinalRepair:
    """A path after its final repair.

    Attributes:
        path: (k, 2) free path from start to target, in map units.
        length: length of that path, in map units.
        evaluations: cost of the repair, in evaluations of the path that was given: a comparison of all its
            segments with the map is one. The work of a planner is not in it.
        planned: number of pieces that a planner found, where pushing did not suffice.
    """

    path: Floats
    length: float
    evaluations: int
    planned: int


def final_repair(problem: MapProblem, path: Floats) -> FinalRepair | None:
    """Return a free path near a path, (k, 2) in map units; None if none was found.

    Where the path enters obstacles by little, it is pushed out of them by small shifts. Pieces for which that
    does not suffice are planned again: by an exact planner on maps of circles and polygons, by A* on grid
    maps. At last the path is pulled tight. The result is checked exactly.
    """
    whole = np.asarray(path, dtype=np.float64)
    scenario = problem.scenario
    freed = _on_cells(problem, whole) if isinstance(scenario, GridScenario) else _on_obstacles(problem, whole)
    if freed is None:
        return None
    if isinstance(scenario, GridScenario):
        grid = scenario.map
        points, compared = tighten(CellMap(grid.blocked), grid.to_cells(freed.path), MOST_ROUNDS)
        tight = grid.to_map(points)
    else:
        tight, compared = tighten(obstacles_of(scenario), freed.path, MOST_ROUNDS)
    tight[0], tight[-1] = whole[0], whole[-1]
    best = tight if problem.is_clear(tight) else freed.path
    segments = max(len(whole) - 1, 1)
    # Each exact check compares all segments with the map once.
    return FinalRepair(
        best, length_of(best), freed.sweeps + math.ceil(compared / segments) + 1, freed.planned
    )


class _Freed(NamedTuple):
    """A free path before it is pulled tight: points, sweeps over all segments, and pieces planned again."""

    path: Floats
    sweeps: int
    planned: int


def _on_cells(problem: MapProblem, path: Floats) -> _Freed | None:
    if problem.is_clear(path):
        return _Freed(path, 1, 0)
    whole, planned = _replanned(problem, path)
    return _Freed(whole, 2, planned) if problem.is_clear(whole) else None


def _on_obstacles(problem: MapProblem, path: Floats) -> _Freed | None:
    assert isinstance(problem.scenario, Scenario)
    obstacles, pushed = obstacles_of(problem.scenario), path.copy()
    sweeps = push_out(obstacles, pushed, MOST_SWEEPS)
    if problem.is_clear(pushed):
        return _Freed(pushed, sweeps, 0)
    whole, planned = _replanned(problem, path)
    # The planner's arcs are polylines that cut the corners of circles by a hair.
    sweeps += push_out(obstacles, whole, MOST_SWEEPS)
    return _Freed(whole, sweeps, planned) if problem.is_clear(whole) else None


def _replanned(problem: MapProblem, path: Floats) -> tuple[Floats, int]:
    """Return the path, (k, 2), with a new plan for each piece that is not clear, and the number of these.

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
