"""Walls around a corridor: where they stand, a robot can pass all obstacles only on the sides of one path.

Free cells are reached from a path in all directions at a time. Each cell knows on which sides of all
obstacles the way to it passes. Where two neighbours disagree, ways around an obstacle have met, and a wall
stands between them. So walls are as far from the path as they can be, and link obstacles with each other or
with the border of the map. What they leave has no obstacle to go around.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.cell_runs import Runs
from swarm_gym.planning.corridor_map import CorridorMap, steps_along
from swarm_gym.scenarios import GridMap, GridScenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class CorridorWalls(NamedTuple):
    """Walls without width, in the frame of a task."""

    segments: Floats
    "Ends of each wall, (m, 4)."
    ends: Floats
    "Points at blocked cells where walls end; an obstacle is near, (n, 2)."


def walls_around(corridors: CorridorMap, path: Floats) -> CorridorWalls | None:
    """Return the walls around the corridor of a path.

    Args:
        corridors: corridors of the task.
        path: a path in the frame of the task, (k, 2), which need not be free.

    Returns:
        The walls; None if the path winds around an obstacle, or no free cells lead along it.
    """
    for cells in (corridors.coarse_cells, corridors.cells):
        if cells is not None:
            steps = steps_along(cells.map.blocked, cells.map.to_cells(path))
            if steps is not None:
                return _walls(cells, steps, cells.map.to_cells(corridors.posts))
    return None


def _walls(cells: GridScenario, steps: Integers, posts: Floats) -> CorridorWalls | None:
    grid = cells.map
    passed = _passed(grid, posts)
    labels = _labels(grid.blocked, steps, passed)
    if labels is None:
        return None
    sides, is_reached = labels
    flat = is_reached[:-1] & is_reached[1:] & (sides[1:] != sides[:-1] + passed[:-1])
    upright = is_reached[:, :-1] & is_reached[:, 1:] & (sides[:, 1:] != sides[:, :-1])
    across, along = Runs.of(~flat), Runs.of(~upright.T)
    lines = [
        np.stack([across.first - 0.5, across.row + 0.5, across.last + 0.5, across.row + 0.5], axis=-1),
        np.stack([along.row + 0.5, along.first - 0.5, along.row + 0.5, along.last + 0.5], axis=-1),
    ]
    # Corner (column, row) is where the cells (column - 1, row - 1) and (column, row) meet.
    is_corner = np.zeros((grid.height + 1, grid.width + 1), dtype=np.bool_)
    is_corner[1:-1, :-1] |= flat
    is_corner[1:-1, 1:] |= flat
    is_corner[:-1, 1:-1] |= upright
    is_corner[1:, 1:-1] |= upright
    around = np.pad(is_reached, 1, constant_values=True)
    is_inner = around[1:, 1:] & around[1:, :-1] & around[:-1, 1:] & around[:-1, :-1]
    at_blocks = np.argwhere(is_corner & ~is_inner)[:, ::-1] - 0.5
    at_border = np.argwhere(is_corner)[:, ::-1]
    far = float(grid.width + grid.height)
    for axis, last in ((0, grid.width), (1, grid.height)):
        for place, way in ((0, -far), (last, far)):
            corners = at_border[at_border[:, axis] == place] - 0.5
            lines.append(np.hstack([corners, corners + (way * np.eye(2))[axis]]))
    segments = np.vstack(lines).reshape(-1, 2)
    return CorridorWalls(grid.to_map(segments).reshape(-1, 4), grid.to_map(at_blocks))


def _passed(grid: GridMap, posts: Floats) -> Integers:
    """Return the sum of the numbers of obstacles that a step from each cell to the row behind passes.

    Each obstacle has a large number, and a ray from its post along the columns. A step across the ray passes
    the obstacle. Sums of different obstacles differ.
    """
    passed = np.zeros((grid.height, grid.width + 1), dtype=np.int64)
    numbers = np.random.default_rng(0).integers(-(2**62), 2**62, len(posts))
    columns = np.clip(np.floor(posts[:, 0]).astype(np.int64) + 1, 0, grid.width)
    rows = np.ceil(posts[:, 1]).astype(np.int64) - 1
    is_on_map = (rows >= 0) & (rows < grid.height - 1)
    np.add.at(passed, (rows[is_on_map], columns[is_on_map]), numbers[is_on_map])
    found: Integers = np.cumsum(passed, axis=1)[:, :-1]
    return found


def _labels(blocked: Flags, steps: Integers, passed: Integers) -> tuple[Integers, Flags] | None:
    """Return what ways from the first step to each cell pass, and which cells are reached, (height, width).

    Ways lead along the steps, and then the shortest way to the cell; None if the steps wind around something.
    """
    columns, rows = steps.T
    moves = np.diff(rows)
    changes = moves * passed[np.minimum(rows[:-1], rows[1:]), columns[1:]]
    height, width = (side + 2 for side in blocked.shape)
    is_open = np.pad(~blocked, 1).ravel()
    across = np.pad(passed, 1).ravel()
    sides = np.zeros(height * width, dtype=np.int64)
    front = (rows + 1) * width + columns + 1
    along = np.append(0, np.cumsum(changes))
    sides[front] = along
    if (sides[front] != along).any():
        return None
    front = np.unique(front)
    is_open[front] = False
    is_reached = ~is_open & np.pad(~blocked, 1).ravel()
    while len(front):
        fresh = []
        for move, change in (
            (1, np.zeros_like(front)),
            (-1, np.zeros_like(front)),
            (width, across[front]),
            (-width, -across[front - width]),
        ):
            near = front + move
            is_new = is_open[near]
            near = near[is_new]
            sides[near] = sides[front[is_new]] + change[is_new]
            is_open[near] = False
            fresh.append(near)
        front = np.concatenate(fresh)
        is_reached[front] = True
    inner = (slice(1, -1), slice(1, -1))
    return sides.reshape(height, width)[inner], is_reached.reshape(height, width)[inner]
