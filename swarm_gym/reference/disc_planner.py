"""The exact shortest path of a disc on an occupancy grid.

The centre moves along segments, and along arcs around corners of blocked cells, which have the disc's radius
(T. Lozano-Perez, M. A. Wesley, Commun. ACM 22, 1979): A* over the common tangents of the circles around
corners. A corner looks for its tangents when a path first reaches it.
"""

import heapq
import math
from array import array
from bisect import bisect_left
from collections.abc import Callable, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.problem.geometry.clearance import clearance
from swarm_gym.reference.disc_arcs import SLACK, disc_is_free, find_free_arcs
from swarm_gym.reference.disc_path import Arc, as_polyline, place
from swarm_gym.reference.disc_tangents import strip_is_free, tangents_from_corner, tangents_from_point
from swarm_gym.reference.grid_input import as_grid, as_point
from swarm_gym.reference.grid_sight import SHIFT, make_sight, make_sight_grid

Point = tuple[float, float]
Queue = list[tuple[float, int]]  # least length of a whole path, and number of an arrival

# Work is counted in rows of the grid that are compared with a tangent. Other steps count as so many rows: a
# row near a corner when its arcs are found, a corner that the search reaches, a tangent that it follows.
PER_ROW, PER_CORNER, PER_STEP = 10, 5_000, 100
BACK = 1e-9  # angle by which a tangent may leave a circle before another one reaches it: rounding errors
GOAL = -1  # in place of a lane
AT_A_TIME = 5_000  # entries of a queue that are freed at a time: other threads run only in between


class TooMuchWorkError(Exception):
    """The search for a path was given up, since it takes more work than was allowed."""


class StoppedError(Exception):
    """The search for a path was ended by its caller."""


def never() -> bool:
    """Return False: a calculation is not stopped."""
    return False


class _Lane:
    """Tangents that leave a lane, in the order in which a path along it comes to them.

    Attributes:
        keys: angles, or -angles where the path turns to smaller ones.
        to_lanes: lane that each tangent enters.
        to_angles: angle at which it enters that lane.
        lengths: length of the tangent.
    """

    __slots__ = ("keys", "lengths", "to_angles", "to_lanes")

    def __init__(self) -> None:
        self.keys, self.to_angles, self.lengths = array("d"), array("d"), array("d")
        self.to_lanes = array("q")

    def add(self, key: float, to_lane: int, to_angle: float, length: float) -> None:
        """Add a tangent that leaves the lane behind all others."""
        self.keys.append(key)
        self.to_lanes.append(to_lane)
        self.to_angles.append(to_angle)
        self.lengths.append(length)


class _Arrivals:
    """Places where paths from the start enter a lane, after they left the lane of the arrival before.

    A search has hundreds of thousands. They are arrays and no objects: Python's collector of garbage would
    look at objects again and again, and no other thread would run meanwhile.

    Attributes:
        lanes: lane that is entered, or `GOAL`.
        angles: angle at which it is entered.
        before: number of the arrival before; -1 at the start.
        left_at: angle at which the lane of the arrival before was left.
        lengths: length of the path so far.
    """

    def __init__(self) -> None:
        self.lanes, self.before = array("q"), array("q")
        self.angles, self.left_at, self.lengths = array("d"), array("d"), array("d")

    def add(self, lane: int, angle: float, before: int, left_at: float, length: float) -> int:
        """Add an arrival, and return its number."""
        self.lanes.append(lane)
        self.angles.append(angle)
        self.before.append(before)
        self.left_at.append(left_at)
        self.lengths.append(length)
        return len(self.lanes) - 1


class DiscPlanner:
    """Exact shortest paths of discs of one radius on one grid; what does not depend on the ends is kept.

    The disc may touch blocked cells. Everything outside the grid is free, but the centre stays on the grid.
    A passage as wide as the disc is open.
    """

    def __init__(self, blocked: NDArray[np.bool_], radius: float, most_work: float = math.inf):
        """Find the free arcs around all corners of a grid.

        Args:
            blocked: (height, width) the grid, row 0 on top; it is copied.
            radius: radius of the disc in cells.
            most_work: work that finding the arcs, and then each search, may take, in rows of the grid.

        Raises:
            ScenarioError: if the grid is no array of booleans with two axes, or the radius is not positive.
            TooMuchWorkError: if finding the arcs takes more work than is allowed.
        """
        if not 0.0 < radius < math.inf:
            raise ScenarioError(f"radius is {radius!r}; expected a positive number of cells")
        self._blocked = as_grid(blocked)
        self._radius = float(radius)
        self._grid = make_sight_grid(self._blocked)
        self._most_work = most_work
        if PER_ROW * len(self._grid.corner_rows) * (4.0 * radius + 2.0) > most_work:
            raise TooMuchWorkError
        self._arcs = find_free_arcs(self._grid, self._radius)
        self._lanes: dict[int, _Lane] = {}
        self._work_at: dict[int, int] = {}  # by corner

    def shortest_path(
        self, start: Sequence[float], goal: Sequence[float], is_stopped: Callable[[], bool] = never
    ) -> tuple[float, NDArray[np.float64]]:
        """Return the shortest path of the centre between two points (column, row).

        Args:
            start: (column, row) of its first point.
            goal: (column, row) of its last point.
            is_stopped: whether the search shall end; asked whenever it follows a path further.

        Returns:
            Its length in cells, and a polyline, (k, 2), which is not closer to blocked cells than the disc's
            radius and longer than the path by 2.5e-7 of it at most, see `disc_path`.

        Raises:
            ScenarioError: if the disc does not fit at an end.
            NoPathError: if the disc does not fit through between the ends.
            TooMuchWorkError: if the search takes more work than is allowed. What earlier searches found
                counts again, so that this does not depend on the order of calls.
            StoppedError: if the search was ended.
        """
        ends = [self._free_point(start, "start"), self._free_point(goal, "goal")]
        shifted = [(x + SHIFT, y + SHIFT) for x, y in ends]
        if strip_is_free(self._grid, *shifted[0], *shifted[1], self._radius - SLACK):
            return math.dist(*ends), np.array(ends)
        queue: Queue = []
        try:
            found = self._search(shifted[0], shifted[1], queue, is_stopped)
        finally:
            while queue:
                del queue[-AT_A_TIME:]
        if found is None:
            raise NoPathError(
                f"blocked cells leave no passage {2.0 * self._radius:g} cells wide between start {ends[0]} "
                f"and goal {ends[1]}"
            )
        length, arcs = found
        points = as_polyline(self._grid, self._radius, shifted[0], arcs, shifted[1], length) - SHIFT
        points[[0, -1]] = ends
        return length, points

    def _free_point(self, point: Sequence[float], name: str) -> Point:
        x, y = as_point(point, name)
        height, width = self._blocked.shape
        if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
            raise ScenarioError(f"{name} ({x:g}, {y:g}) is outside the grid of {width} x {height} cells")
        if not disc_is_free(self._grid, x + SHIFT, y + SHIFT, self._radius - SLACK):
            distance = clearance(self._blocked, np.array([(x, y)]))
            raise ScenarioError(
                f"{name} ({x:g}, {y:g}) is {distance:g} cells from a blocked cell; expected at least "
                f"{self._radius:g}, the radius of the disc"
            )
        return x, y

    def _search(
        self, start: Point, goal: Point, queue: Queue, is_stopped: Callable[[], bool]
    ) -> tuple[float, list[Arc]] | None:
        """Return length and arcs of the shortest path that is not straight; None if there is none.

        The queue is empty at first, and afterwards has what was not taken from it.
        """
        sight = make_sight(self._grid)
        first = tangents_from_point(self._grid, self._arcs, *start, self._radius, sight)
        last = tangents_from_point(self._grid, self._arcs, *goal, self._radius, sight)
        # A path that leaves a lane for the goal would enter the lane of the other direction from there.
        to_goal: dict[int, list[tuple[float, float]]] = {}
        for lane, angle, length in zip(last.to_lanes ^ 1, last.to_angles, last.lengths, strict=True):
            to_goal.setdefault(int(lane), []).append((float(angle), float(length)))
        arrivals = _Arrivals()

        def enter(length: float, lane: int, angle: float, before: int, left_at: float) -> None:
            rest = 0.0
            if lane != GOAL:
                rest = math.dist(place(self._grid, self._arcs.corners[lane // 2], angle, self._radius), goal)
            heapq.heappush(queue, (length + rest, arrivals.add(lane, angle, before, left_at, length)))

        for lane, angle, length in zip(
            first.to_lanes.tolist(), first.to_angles.tolist(), first.lengths.tolist(), strict=True
        ):
            enter(length, lane, angle, -1, 0.0)
        shortest: dict[int, array[float]] = {}  # lengths of paths to where tangents leave a lane
        reached_corners: set[int] = set()
        work = first.work + last.work
        for taken in count():
            if not queue:
                return None
            if work + PER_STEP * (len(arrivals.lanes) + taken) > self._most_work:
                raise TooMuchWorkError
            if is_stopped():
                raise StoppedError
            _, arrival = heapq.heappop(queue)
            length, entered = arrivals.lengths[arrival], arrivals.lanes[arrival]
            if entered == GOAL:
                return length, self._arcs_of(arrivals, arrival)
            sign = 1.0 if entered % 2 else -1.0
            key = sign * arrivals.angles[arrival]
            lane = self._lane(entered)
            corner = int(self._arcs.corners[entered // 2])
            if corner not in reached_corners:
                reached_corners.add(corner)
                work += self._work_at[corner]
            lengths = shortest.setdefault(entered, array("d", [math.inf]) * len(lane.keys))
            for k in range(bisect_left(lane.keys, key - BACK), len(lane.keys)):
                reached = length + self._radius * max(lane.keys[k] - key, 0.0)
                if lengths[k] <= reached:
                    break  # another path comes here as soon, and so to all that follows on this lane
                lengths[k] = reached
                reached += lane.lengths[k]
                enter(reached, lane.to_lanes[k], lane.to_angles[k], arrival, sign * lane.keys[k])
            for angle, rest in to_goal.get(entered, ()):
                if sign * angle >= key - BACK:
                    reached = length + self._radius * max(sign * angle - key, 0.0)
                    enter(reached + rest, GOAL, 0.0, arrival, angle)
        return None

    def _lane(self, lane: int) -> _Lane:
        """Return the tangents that leave a lane; tangents of all lanes of a corner are found together."""
        if lane not in self._lanes:
            corner = int(self._arcs.corners[lane // 2])
            made: dict[int, _Lane] = {}
            for arc in range(self._arcs.first[corner], self._arcs.first[corner + 1]):
                made[2 * arc], made[2 * arc + 1] = _Lane(), _Lane()
            sight = make_sight(self._grid)
            found = tangents_from_corner(self._grid, self._arcs, corner, self._radius, sight)
            keys = np.where(found.from_lanes % 2 == 1, found.from_angles, -found.from_angles)
            order = np.argsort(keys, kind="stable")
            columns = (found.from_lanes, keys, found.to_lanes, found.to_angles, found.lengths)
            for one, *values in zip(*(column[order].tolist() for column in columns), strict=True):
                made[one].add(*values)
            # Complete lanes only, since several threads may search at a time.
            self._work_at[corner] = PER_CORNER + found.work
            self._lanes.update(made)
        return self._lanes[lane]

    def _arcs_of(self, arrivals: _Arrivals, last: int) -> list[Arc]:
        """Return the arcs of a path that ends with an arrival at the goal."""
        arcs = []
        while (before := arrivals.before[last]) >= 0:
            corner = int(self._arcs.corners[arrivals.lanes[before] // 2])
            arcs.append(Arc(corner, arrivals.angles[before], arrivals.left_at[last]))
            last = before
        return arcs[::-1]
