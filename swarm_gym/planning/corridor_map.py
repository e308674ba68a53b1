"""The corridors of a task: the cells on which they are looked for, and the sides of obstacles."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.corridors import obstacle_posts
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.final_repair import final_repair
from swarm_gym.planning.cell_runs import Runs
from swarm_gym.planning.certificate import certified
from swarm_gym.planning.corridor_search import shortest_by_corridor
from swarm_gym.planning.tasks import Task
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridScenario, Scenario, rasterised
from swarm_gym.scenarios.growing_grids import grown_on_cells

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

CELLS = 400  # on the longer side of a map of circles and polygons
AROUND = 0.1  # how far paths may leave the workspace of such a map, as a share of its longer side
SAMPLES = 4  # points per cell of a path that is laid over cells
BESIDE = 1e-6  # how far from a border between cells a point may lie in either of them
MOST_POSTS = 1000  # that are compared with a path at a time
NEAR = 16  # cells around a gap in which a way between its ends is looked for first


@dataclass(frozen=True, eq=False)
class CorridorMap:
    """The corridors of a task; paths are in the frame of the task, (k, 2).

    Attributes:
        task: the task.
    """

    task: Task

    @cached_property
    def cells(self) -> GridScenario | None:
        """The map on which a point is the whole robot, as cells; None if no path leads through free cells."""
        grown = self.task.grown
        if isinstance(grown, GridScenario):
            return grown
        x_min, y_min, x_max, y_max = grown.workspace
        side = max(x_max - x_min, y_max - y_min)
        more = AROUND * side
        wider = (x_min - more, y_min - more, x_max + more, y_max + more)
        try:
            return rasterised(replace(grown, workspace=wider), side / CELLS)
        except ScenarioError:
            return None

    @cached_property
    def coarse_cells(self) -> GridScenario | None:
        """The map of `cells` with fewer and larger cells, where that is possible."""
        bare = self.task.bare
        if isinstance(bare, GridScenario) and self.task.margin > 0.0:
            try:
                return grown_on_cells(bare, self.task.margin, fine=0.0)
            except ScenarioError:
                pass
        return self.cells

    @cached_property
    def posts(self) -> Floats:
        """A point deep inside each obstacle of the map as it is given, (m, 2); on cells, off the border."""
        bare = self.task.bare
        if isinstance(bare, GridScenario):
            return _deep_cells(bare)
        return np.array(obstacle_posts(bare.obstacles, bare.tolerance)).reshape(-1, 2)

    def differ(self, path: Floats, other: Floats) -> bool:
        """Return whether an obstacle lies between two paths."""
        loop = np.concatenate([path, other[-2::-1]])
        inside = ((self.posts >= loop.min(axis=0)) & (self.posts <= loop.max(axis=0))).all(axis=1)
        near = self.posts[inside]
        return any(
            _winds_around(loop, near[first : first + MOST_POSTS]) for first in range(0, len(near), MOST_POSTS)
        )

    def paths(self, is_over: Callable[[], bool]) -> Iterator[Floats]:
        """Yield free paths that keep the margin, of which most lie in other corridors than those before."""
        if self.cells is not None:
            for path in shortest_by_corridor(self.cells, is_over):
                if (kept := self.checked(path)) is not None:
                    yield kept

    def checked(self, path: Floats) -> Floats | None:
        """Return a path over free cells as one that keeps the margin, pulled tight; None without one."""
        if isinstance(self.task.given, GridScenario):
            return certified(self.task, path)
        grown = self.task.grown
        assert isinstance(grown, Scenario)
        ends = np.vstack([grown.start, path[1:-1], grown.target])
        found = final_repair(AnalyticProblem(grown), ends)
        return None if found is None or self.differ(found.path, path) else found.path

    def shortest_along(self, path: Floats, other: Floats) -> Floats | None:
        """Return the shortest path of the corridor of a path that need not be free; None if it has none.

        Where the path is not free, the shortest way from cells before to cells behind replaces the piece. If
        that leads into the corridor of another path, there is none.

        Args:
            path: a path.
            other: path in the corridor to stay out of.
        """
        coarse = self._along(self.coarse_cells, path, other)
        return coarse if coarse is not None else self._along(self.cells, path, other)

    def _along(self, cells: GridScenario | None, path: Floats, other: Floats) -> Floats | None:
        tight = None if cells is None else _tight_along(cells, path)
        kept = None if tight is None else self.checked(tight)
        return kept if kept is not None and self.differ(kept, other) else None


def _winds_around(loop: Floats, posts: Floats) -> bool:
    """Return whether a closed polyline, (k, 2), winds around one of some points, (m, 2)."""
    (x0, y0), (x1, y1) = loop[:-1, :, None].transpose(1, 0, 2), loop[1:, :, None].transpose(1, 0, 2)
    x, y = posts.T
    # Crossings of the ray from a post to the right, upwards minus downwards.
    left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
    upwards = ((y0 <= y) & (y1 > y) & (left > 0.0)).sum(axis=0)
    downwards = ((y0 > y) & (y1 <= y) & (left < 0.0)).sum(axis=0)
    return bool((upwards != downwards).any())


def _deep_cells(scenario: GridScenario) -> Floats:
    """Return the middle of the deepest cell of each obstacle that does not touch the border, (m, 2)."""
    from scipy import ndimage

    blocked = scenario.map.blocked
    labels, number = ndimage.label(blocked, np.ones((3, 3), dtype=np.bool_))
    on_border = np.unique(np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]]))
    inner = np.setdiff1d(np.arange(1, number + 1), on_border)
    if not inner.size:
        return np.empty((0, 2))
    depth = ndimage.distance_transform_cdt(blocked, "taxicab")
    cells = np.array(ndimage.maximum_position(depth, labels, inner))
    return scenario.map.to_map(cells.reshape(-1, 2)[:, ::-1])


def _tight_along(cells: GridScenario, path: Floats) -> Floats | None:
    """Return the shortest path over cells in the corridor of a path, both in map units, (k, 2)."""
    grid = cells.map
    steps = steps_along(grid.blocked, grid.to_cells(path))
    if steps is None:
        return None
    runs = Runs.of(grid.blocked)
    start, goal = (tuple(end) for end in grid.to_cells([cells.start, cells.target]).tolist())
    tight = grid.to_map(runs.tightened(start, runs.rooms_of(steps), goal))
    tight[0], tight[-1] = cells.start, cells.target
    return tight


def steps_along(blocked: NDArray[np.bool_], path: Floats) -> Integers | None:
    """Return steps over free cells along a path in cells, (k, 2); None if there are none."""
    near = _free_cells_along(blocked, path)
    parts = [near[:1]]
    for here, there in pairwise(near):
        way = _way_between(blocked, here, there)
        if way is None:
            return None
        parts.append(way[1:])
    return np.concatenate(parts)


def _free_cells_along(blocked: NDArray[np.bool_], path: Floats) -> Integers:
    """Return the free cells (column, row) that a path passes, in order, each once in a row."""
    height, width = blocked.shape
    found: list[tuple[int, int]] = []
    for begin, end in pairwise(path):
        number = max(math.ceil(SAMPLES * float(np.abs(end - begin).max())), 1)
        for x, y in np.linspace(begin, end, number + 1).tolist():
            options = {
                (math.floor(x + 0.5 + dx), math.floor(y + 0.5 + dy))
                for dx in (-BESIDE, BESIDE)
                for dy in (-BESIDE, BESIDE)
            }
            free = [
                (column, row)
                for column, row in sorted(options)
                if 0 <= column < width and 0 <= row < height and not blocked[row, column]
            ]
            if free and (not found or found[-1] not in free):
                found.append(free[0])
    return np.array(found, dtype=np.int64)


def _is_step(blocked: NDArray[np.bool_], here: Integers, there: Integers) -> bool:
    """Return whether a step leads from one free cell to another."""
    (x, y), (next_x, next_y) = here, there
    return max(abs(next_x - x), abs(next_y - y)) == 1 and not (blocked[y, next_x] or blocked[next_y, x])


def _way_between(blocked: NDArray[np.bool_], here: Integers, there: Integers) -> Integers | None:
    """Return steps over free cells from one to another, (k, 2); None if there are none."""
    if _is_step(blocked, here, there):
        return np.stack([here, there])
    height, width = blocked.shape
    for reach in (NEAR, max(height, width)):
        low = np.maximum(np.minimum(here, there) - reach, 0)
        high = np.maximum(here, there) + reach + 1
        part = blocked[low[1] : high[1], low[0] : high[0]]
        try:
            return shortest_grid_path(part, (here - low).tolist(), (there - low).tolist()).cells + low
        except NoPathError:
            continue
    return None
