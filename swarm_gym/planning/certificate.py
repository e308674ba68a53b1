"""Paths of robots on grid maps, checked on the map as given: cells of grown maps are not exact everywhere."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.planning.tasks import Task
from swarm_gym.problem.geometry.clearance import keeps_distance
from swarm_gym.problem.geometry.polylines import is_clear, length_of
from swarm_gym.problem.geometry.traversal import path_is_free
from swarm_gym.reference import shortest_robot_path
from swarm_gym.scenarios import GridScenario, Scenario

Floats = NDArray[np.float64]

TOUCHING = 1e-9  # how much closer than the margin a path may come, in cells
# Lengths of beginnings of a path, in small cells, of which one is planned anew if it is too close to blocks.
ANEW = (2, 4, 8, 16, 32, 64)


def certified(task: Task, path: Floats) -> Floats | None:
    """Return a path on the grown map, (k, 2), that keeps the margin on the map as given, or None.

    On grid maps, small cells that were opened at the ends may let a path come too close there. Then its end
    is planned again by the exact planner, on a part of the map.
    """
    if task.margin == 0.0 or not isinstance(task.given, GridScenario) or _keeps_margin(task, path):
        return path
    mended = _begun_anew(task, path)
    if not _keeps_margin(task, mended):
        mended = _begun_anew(task, mended[::-1])[::-1]
    return mended if _keeps_margin(task, mended) else None


def is_free(task: Task, path: Floats) -> bool:
    """Return whether a path in the frame, (k, 2), keeps the margin, or enters nothing blocked without one."""
    if isinstance(task.given, GridScenario):
        grid = task.given.map
        cells = grid.to_cells(path)
        if task.margin == 0.0:
            return bool(path_is_free(grid.blocked, cells))
        edge = (grid.width - 0.5, grid.height - 0.5)
        on_map = (cells >= -0.5 - TOUCHING).all() and (cells <= np.add(edge, TOUCHING)).all()
        return bool(on_map) and _keeps_margin(task, path)
    assert isinstance(task.grown, Scenario)
    return is_clear(path, task.grown.solids, task.grown.tolerance)


def _keeps_margin(task: Task, path: Floats) -> bool:
    assert isinstance(task.given, GridScenario)
    grid = task.given.map
    return keeps_distance(grid.blocked, grid.to_cells(path), task.margin / grid.resolution - TOUCHING)


def _begun_anew(task: Task, path: Floats) -> Floats:
    """Return a path, (k, 2), with its beginning planned again, or as it is if that was no use."""
    assert isinstance(task.grown, GridScenario)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
    for cells in ANEW:
        reached = cells * task.grown.map.resolution
        if reached >= along[-1]:
            break
        behind = np.searchsorted(along, reached, side="right")
        point = np.array([np.interp(reached, along, path[:, k]) for k in range(2)])
        before = np.vstack([path[:behind], point])
        if _keeps_margin(task, before):
            break  # it is the other end that is too close
        way = _on_part(task, before)
        if way is not None and _keeps_margin(task, way):
            return np.vstack([way, path[behind:]])
    return path


def _on_part(task: Task, path: Floats) -> Floats | None:
    """Return the exact path between the ends of a path, (k, 2), on the part of the map around it, or None."""
    assert isinstance(task.given, GridScenario)
    grid = task.given.map
    cells = grid.to_cells(path)
    reach = (2.0 * task.margin + length_of(path)) / grid.resolution
    low = np.maximum(np.floor(cells.min(axis=0) - reach), 0.0).astype(np.int64)
    high = np.ceil(cells.max(axis=0) + reach + 1.0).astype(np.int64)
    part = grid.cut(slice(low[1], high[1]), slice(low[0], high[0]))
    try:
        between = GridScenario(task.given.name, part, tuple(path[0].tolist()), tuple(path[-1].tolist()))
        return shortest_robot_path(between, task.margin)[1]
    except ScenarioError:
        return None
