"""Curves in given corridors: alternatives of which no two pass alike, and the corridor of a previous path."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.alternatives import MORE
from swarm_gym.planning.corridor_map import CorridorMap
from swarm_gym.planning.corridor_walls import CorridorWalls, walls_around
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.drive_search import FINER, FIRST
from swarm_gym.planning.drive_searches import DriveSearches

Floats = NDArray[np.float64]

FIRSTS = (FIRST, FINER._replace(nodes=200_000))  # fewer nodes than on the whole map
MOST_SHUT = 8  # corridors without a curve, besides those that are asked for, after which looking ends


class Others(NamedTuple):
    """Curves through other corridors than the best one."""

    curves: list[Curve]
    "Curves, that of the least cost first."
    shut: list[Floats]
    "Paths through the corridors in which no curve was found, (k, 2) each, in the frame of the task."


@dataclass(frozen=True, eq=False)
class DriveCorridors:
    """Searches for curves that are confined to one corridor each.

    Attributes:
        searches: searches for curves that obey all limits.
        most: evaluations in a corridor after which improving ends; None for no limit.
    """

    searches: DriveSearches
    most: int | None

    @property
    def drive_map(self) -> DriveMap:
        """Obstacles and costs."""
        return self.searches.drive_map

    @cached_property
    def corridors(self) -> CorridorMap:
        """The corridors of the task."""
        return CorridorMap(self.drive_map.task)

    def path_of(self, curve: Curve) -> Floats:
        """Return the points of a curve in the frame of the task, (k, 2)."""
        return self.drive_map.task.frame.to_frame(self.drive_map.path_of(curve))

    def differ(self, curve: Curve, other: Curve) -> bool:
        """Return whether an obstacle lies between two curves."""
        return self.corridors.differ(self.path_of(curve), self.path_of(other))

    def curve_along(self, path: Floats, is_over: Callable[[], bool]) -> Curve | None:
        """Return a curve of low cost in the corridor of a path; None if none was found.

        Args:
            path: a path in the frame of the task, (k, 2).
            is_over: whether time is up.
        """
        walls = walls_around(self.corridors, path)
        if walls is None or is_over():
            return None
        searches, best = self.searches, None
        most = math.inf if self.most is None else searches.evaluations + self.most

        def is_spent() -> bool:
            return (best is not None and searches.evaluations >= most) or is_over()

        for curve in searches.curves(self._to_obstacles(walls), is_spent, False, FIRSTS):
            best = curve
        # A curve may have slipped through a passage that is narrower than a cell of the corridors.
        return None if best is None or self.corridors.differ(self.path_of(best), path) else best

    def others(self, best: Curve, number: int, is_over: Callable[[], bool]) -> Others:
        """Return curves between any two of which, and the best one, an obstacle lies.

        Args:
            best: the best curve.
            number: number of curves, at most.
            is_over: whether time is up.
        """
        found: list[Curve] = []
        shut: list[Floats] = []
        known = [self.path_of(best)]
        for path in self.corridors.paths(is_over):
            if not all(self.corridors.differ(path, other) for other in known):
                continue
            known.append(path)
            curve = self.curve_along(path, is_over)
            if curve is not None:
                found.append(curve)
            elif not is_over():
                shut.append(path)
            if len(found) >= number + MORE or len(shut) >= number + MOST_SHUT:
                break
        return Others(sorted(found, key=self.searches.cost_of)[:number], shut)

    def kept(
        self, before: Floats, best: Curve, switch_margin: float, is_over: Callable[[], bool]
    ) -> Curve | None:
        """Return the curve in the corridor of a previous path to keep instead of the best one.

        Args:
            before: previous path in the frame, (k, 2), which need not be free now.
            best: the best curve.
            switch_margin: share of its cost by which the best curve must be better than the corridor's.
            is_over: whether time is up.

        Returns:
            The curve; None to take the best one.
        """
        best_path = self.path_of(best)
        if switch_margin == 0.0 or not self.corridors.differ(before, best_path):
            return None
        along = self.corridors.shortest_along(before, best_path)
        curve = None if along is None else self.curve_along(along, is_over)
        if curve is None:
            return None
        most = self.searches.cost_of(best) / (1.0 - switch_margin) if switch_margin < 1.0 else math.inf
        return curve if self.searches.cost_of(curve) <= most else None

    def _to_obstacles(self, walls: CorridorWalls) -> Floats:
        """Return walls in map units, (m, 4), with those that link their ends with the nearest obstacles."""
        to_map, capsules = self.drive_map.task.frame.to_map, self.drive_map.lattice.capsules
        segments = to_map(walls.segments.reshape(-1, 2)).reshape(-1, 4)
        if not len(capsules) or not len(walls.ends):
            return segments
        ends = to_map(walls.ends)
        feet = np.array([_nearest_on(capsules, end) for end in self.drive_map.to_nodes(ends)])
        return np.vstack([segments, np.hstack([ends, self.drive_map.to_map(feet)])])


def _nearest_on(capsules: Floats, point: Floats) -> Floats:
    """Return the nearest point on the middle lines of capsules, (m, 5), by their distance."""
    begins, changes = capsules[:, :2], capsules[:, 2:4] - capsules[:, :2]
    squares = (changes**2).sum(axis=1)
    along = ((point - begins) * changes).sum(axis=1)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    feet = begins + share[:, None] * changes
    nearest: Floats = feet[int(np.argmin(np.hypot(*(feet - point).T) - capsules[:, 4]))]
    return nearest
