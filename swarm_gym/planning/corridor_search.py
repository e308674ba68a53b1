"""The shortest paths through different corridors of a grid map, in the order of their lengths.

A search over rows of rooms, see `cell_runs`. What is known of a row is the funnel of shortest paths through
it, and a lower bound of the rest. The bound follows from the steps over cells that are left to the goal.
Paths that meet themselves, as those that wind around an obstacle and come back, are left out.
"""

import heapq
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count, pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.cell_runs import Runs
from swarm_gym.planning.funnel import Funnel, Point
from swarm_gym.reference import a_star
from swarm_gym.reference.priority_queue import make_queue
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]

LONGEST = 3.0  # paths longer than so many times the shortest one are no alternatives
MOST_ROWS = 5_000  # rows of rooms that are looked at
TIGHTEST = math.cos(
    math.pi / 8.0
)  # of the distance over steps to eight neighbours, what is left at any angle

Chain = list[int]  # rooms from one junction to the next, both included


def shortest_by_corridor(scenario: GridScenario, is_over: Callable[[], bool]) -> Iterator[Floats]:
    """Yield the shortest path of each corridor, (k, 2) in map units, the shortest first.

    They are exact shortest paths of their corridors through free cells, also where a path touches blocked
    ones. The order holds up to roundings to cells.

    Args:
        scenario: the map and the task.
        is_over: whether time is up; no further path follows then.
    """
    grid = scenario.map
    start, goal = (tuple(point) for point in grid.to_cells([scenario.start, scenario.target]).tolist())
    if is_over():
        return
    runs = Runs.of(grid.blocked)
    ends = [int(runs.number[cell[::-1]]) for cell in map(grid.cell_of, (scenario.start, scenario.target))]
    if is_over():
        return
    left = _steps_left(grid.blocked, grid.cell_of(scenario.target))
    if is_over():
        return
    for points in _Search(runs, _chains(runs, ends), left, start, goal, ends).run(is_over):
        path = grid.to_map(points)
        path[0], path[-1] = scenario.start, scenario.target
        yield path


@dataclass(frozen=True, eq=False)
class _Search:
    runs: Runs
    chains: dict[int, list[Chain]]  # by the junction where they begin
    left: Floats
    start: Point
    goal: Point
    ends: list[int]

    def run(self, is_over: Callable[[], bool]) -> Iterator[Floats]:
        """Yield the points of paths, (k, 2) cells (column, row)."""
        numbers = count()
        queue: list[tuple[float, int, Funnel | None, int, Chain | None, Floats | None]] = []

        def enter(funnel: Funnel, room: int, chain: Chain | None) -> None:
            if room == self.ends[1]:
                found = np.array(funnel.to(self.goal).points())
                length = float(np.hypot(*np.diff(found, axis=0).T).sum())
                heapq.heappush(queue, (length, next(numbers), None, room, None, found))
            heapq.heappush(
                queue, (self._bound(funnel, room, chain), next(numbers), funnel, room, chain, None)
            )

        enter(Funnel(self.start), self.ends[0], None)
        shortest, rows = math.inf, 0
        while queue and rows < MOST_ROWS and not is_over():
            bound, _, funnel, room, chain, found = heapq.heappop(queue)
            if bound > LONGEST * shortest:
                return
            if found is not None:
                if meets_itself(found):
                    continue
                shortest = min(shortest, bound)
                yield found
                continue
            assert funnel is not None
            rows += 1
            for onward in self.chains.get(room, []):
                if chain is not None and onward == chain[::-1]:
                    continue
                reached = funnel
                for here, there in pairwise(onward):
                    reached = reached.through(*self.runs.door(here, there))
                if reached.shared is funnel.shared or not meets_itself(np.array(reached.points())):
                    enter(reached, onward[-1], onward)

    def _bound(self, funnel: Funnel, room: int, chain: Chain | None) -> float:
        """Return a lower bound of the lengths of paths through a row of rooms, in cells."""
        first, last = int(self.runs.first[room]), int(self.runs.last[room])
        if chain is not None:
            before = chain[-2]
            first, last = max(first, int(self.runs.first[before])), min(last, int(self.runs.last[before]))
        row = int(self.runs.row[room])
        columns = np.arange(first, last + 1)
        # A point of the door is half a cell from the middle of a cell behind it, at most.
        apart = np.hypot(columns - funnel.apex[0], row - funnel.apex[1]) - math.sqrt(0.5)
        return funnel.length + float((np.maximum(apart, 0.0) + self.left[row, first : last + 1]).min())


def meets_itself(path: Floats) -> bool:
    """Return whether two pieces of a polyline, (k, 2), that are not neighbours cross or touch."""
    begins, ends = path[:-1], path[1:]
    first, second = np.triu_indices(len(begins), 2)
    if not len(first):
        return False
    a, b, c, d = begins[first], ends[first], begins[second], ends[second]
    near = (
        np.maximum(np.minimum(a, b), np.minimum(c, d)) <= np.minimum(np.maximum(a, b), np.maximum(c, d))
    ).all(axis=1)
    across = _turns(a, b, c) * _turns(a, b, d) <= 0.0
    along = _turns(c, d, a) * _turns(c, d, b) <= 0.0
    return bool((near & across & along).any())


def _turns(a: Floats, b: Floats, c: Floats) -> Floats:
    """Return the signs of the turns of ways over three points, (m, 2) each."""
    areas = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    signs: Floats = np.sign(areas)
    return signs


def _steps_left(blocked: NDArray[np.bool_], goal: tuple[int, int]) -> Floats:
    """Return a lower bound of the length to the goal from the middle of each cell, (height, width)."""
    height, width = blocked.shape
    queue = make_queue(blocked.size)
    straight, diagonal = np.zeros(blocked.size, np.int64), np.zeros(blocked.size, np.int64)
    arrival = np.full(blocked.size, -1, np.int64)
    walls = np.flatnonzero(blocked)
    begin = goal[1] * width + goal[0]
    # A search for a cell that cannot be reached comes to all others.
    end = int(walls[0]) if len(walls) else begin
    a_star.search(blocked, begin, end, queue, straight, diagonal, arrival)
    found: Floats = queue.length.reshape(height, width) * TIGHTEST
    return found


def _chains(runs: Runs, ends: list[int]) -> dict[int, list[Chain]]:
    """Return the rows of rooms between junctions, by the junction where they begin; both ways count.

    Junctions are the rooms of the ends, and rooms with three doors and more that lead on. Dead ends are left
    out: a shortest path does not enter them.
    """
    others, first = runs.neighbours
    degrees = [first[room + 1] - first[room] for room in range(len(runs.row))]
    waiting = [room for room, degree in enumerate(degrees) if degree == 1 and room not in ends]
    while waiting:
        room = waiting.pop()
        degrees[room] = 0
        for onward in others[first[room] : first[room + 1]]:
            if degrees[onward] > 0:
                degrees[onward] -= 1
                if degrees[onward] == 1 and onward not in ends:
                    waiting.append(onward)
    junctions = {room for room, degree in enumerate(degrees) if degree > 2} | set(ends)

    def leading_on(room: int) -> list[int]:
        return [onward for onward in others[first[room] : first[room + 1]] if degrees[onward] > 0]

    chains: dict[int, list[Chain]] = {}
    for junction in sorted(junctions):
        for onward in leading_on(junction):
            chain = [junction, onward]
            while chain[-1] not in junctions:
                one, *more = leading_on(chain[-1])
                chain.append(more[0] if one == chain[-2] else one)
            chains.setdefault(junction, []).append(chain)
    return chains
