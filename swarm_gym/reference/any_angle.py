"""The exact shortest path between two points of an occupancy grid, at any angle.

A shortest path turns at corners of blocked cells only, and only around them (T. Lozano-Perez, M. A. Wesley,
Commun. ACM 22, 1979): A* over the corners, each of which looks for its neighbours when it is expanded.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.problem.geometry.traversal import segment_is_free
from swarm_gym.reference.grid_input import as_grid, as_point
from swarm_gym.reference.grid_sight import (
    SHIFT,
    CornerSight,
    SightGrid,
    make_sight,
    make_sight_grid,
    see_from_corner,
    see_from_point,
)
from swarm_gym.reference.priority_queue import PriorityQueue, enter, make_queue, take_first


class AnyAnglePlanner:
    """Exact shortest paths on one grid; what does not depend on start and goal is kept.

    A path may touch blocked cells, run along them and along the border. Where two blocked cells touch at a
    corner only, the gap is closed: no path passes between them.
    """

    def __init__(self, blocked: NDArray[np.bool_]):
        """Take a grid, (height, width), row 0 on top; it is copied.

        Raises:
            ScenarioError: if it is no array of booleans with two axes.
        """
        self._blocked = as_grid(blocked)
        self._grid = make_sight_grid(self._blocked)

    def shortest_path(
        self, start: Sequence[float], goal: Sequence[float]
    ) -> tuple[float, NDArray[np.float64]]:
        """Return a shortest path between two points (column, row) in free cells or at their sides.

        Returns:
            Its length in cells, and the points where it begins, turns and ends, (k, 2).

        Raises:
            ScenarioError: if an end is in no free cell, or blocked cells separate the ends.
        """
        ends = self._free_point(start, "start"), self._free_point(goal, "goal")
        if segment_is_free(self._blocked, *ends[0], *ends[1]):
            return math.dist(*ends), np.array(ends)
        num_corners = self._grid.corner_columns.size
        arrival = np.full(num_corners + 1, -1, np.int64)
        queue, sight = make_queue(num_corners + 1), make_sight(self._grid)
        shifted = [(x + SHIFT, y + SHIFT) for x, y in ends]
        search(self._grid, *shifted[0], *shifted[1], queue, sight, arrival)
        if math.isinf(queue.length[num_corners]):
            raise NoPathError(f"blocked cells separate start {ends[0]} and goal {ends[1]}")
        corners, node = [], arrival[num_corners]
        while node >= 0:
            corners.append((self._grid.corner_columns[node] - SHIFT, self._grid.corner_rows[node] - SHIFT))
            node = arrival[node]
        points = self._turns([ends[0], *corners[::-1], ends[1]])
        return math.fsum(math.dist(*ends) for ends in pairwise(points)), np.array(points)

    def _free_point(self, point: Sequence[float], name: str) -> tuple[float, float]:
        x, y = as_point(point, name)
        if not segment_is_free(self._blocked, x, y, x, y):
            raise ScenarioError(f"{name} ({x:g}, {y:g}) is not in a free cell of the grid")
        return x, y

    @staticmethod
    def _turns(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Return the points without those that the path passes straight on."""
        kept = points[:1]
        for here, following in pairwise(points[1:]):
            to_here, onward = np.subtract(here, kept[-1]), np.subtract(following, here)
            if to_here[0] * onward[1] != to_here[1] * onward[0]:
                kept.append(here)
        return [*kept, points[-1]]


@entry
def search(
    grid: SightGrid,
    start_x: float,
    start_y: float,
    goal_x: float,
    goal_y: float,
    queue: PriorityQueue,
    sight: CornerSight,
    arrival: NDArray[np.int64],
) -> None:
    """Search over the n corners of a grid, and the goal as number n, which the start does not see.

    Args:
        grid: the grid with its corners.
        start_x: shifted column of the start.
        start_y: shifted row of the start.
        goal_x: shifted column of the goal.
        goal_y: shifted row of the goal.
        queue: an empty queue of n + 1 nodes; afterwards it has the lengths of paths from the start,
            infinite if there is none.
        sight: scratch arrays.
        arrival: (n + 1,) corner before a node, or -1 for the start; changed in place.
    """
    goal = grid.corner_columns.shape[0]
    to_goal = np.full(goal, np.inf)
    for k in range(see_from_point(grid, goal_x, goal_y, sight)):
        corner = sight.corners[k]
        to_goal[corner] = math.hypot(goal_x - grid.corner_columns[corner], goal_y - grid.corner_rows[corner])
    size = 0
    node, x, y, length = -1, start_x, start_y, 0.0
    found = see_from_point(grid, x, y, sight)
    while node != goal:
        for k in range(found):
            corner = sight.corners[k]
            corner_x, corner_y = grid.corner_columns[corner], grid.corner_rows[corner]
            longer = length + math.hypot(corner_x - x, corner_y - y)
            if longer < queue.length[corner]:
                arrival[corner] = node
                queue.length[corner] = longer
                queue.cost[corner] = longer + math.hypot(goal_x - corner_x, goal_y - corner_y)
                size = enter(queue, size, corner)
        if node >= 0 and length + to_goal[node] < queue.length[goal]:
            arrival[goal] = node
            queue.length[goal] = queue.cost[goal] = length + to_goal[node]
            size = enter(queue, size, goal)
        if size == 0:
            break
        node = take_first(queue, size)
        size -= 1
        if node != goal:
            x, y, length = float(grid.corner_columns[node]), float(grid.corner_rows[node]), queue.length[node]
            found = see_from_corner(grid, node, sight)
