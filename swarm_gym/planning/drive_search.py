"""An anytime planner of drivable curves: searches and local improvements by turns, until time is up."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.curves.field import Field
from swarm_gym.planning.curves.guide import guide_to
from swarm_gym.planning.curves.search import (
    BEST_NODE,
    EXPANDED,
    FARTHEST,
    NODES,
    WAITING,
    Limits,
    Search,
    begin,
    expand,
    found,
    make_search,
)
from swarm_gym.planning.curves.shortening import COST, MOST_PIECES, PIECES, Chain, chain_of, shorten
from swarm_gym.planning.drive_costs import CHANGE
from swarm_gym.planning.drive_map import DriveMap

Floats = NDArray[np.float64]

SLICE, TRIALS = 500, 500  # nodes or trials between two looks at the clock
ROUNDS = 16  # slices of trials after the first curve, and after a better one
LAST_ROUNDS = 60  # slices of trials after each further search
STILL = 20  # slices of trials that gain nothing, after which improving ends
GAINED = 1e-5  # share of the cost that counts as a gain
FREE_HEADINGS = 24  # headings at a start whose heading is free
SMALLEST_CELL, LARGEST_CELL = 0.25, 1.0  # sides of cells of positions, in steps of the lattice


class Effort(NamedTuple):
    """The size of one search.

    Attributes:
        weight: factor of the estimate of the rest.
        patience: nodes that are expanded after the first curve.
        finer: divisor of the cells of positions.
        headings: number of cells of headings.
        nodes: largest number of nodes.
        beyond: how far the guide reaches, as a factor of the cost from the start.
    """

    weight: float
    patience: int
    finer: float
    headings: int
    nodes: int
    beyond: float


FIRST = Effort(1.5, 0, 1.0, 48, 150_000, 1.5)
SECOND = Effort(1.1, 20_000, 1.0, 72, 400_000, 1.5)
THIRD = Effort(1.0, 100_000, 1.0, 72, 600_000, 1.5)  # where there is a limit of time
FINER = Effort(1.5, 0, 2.0, 96, 600_000, math.inf)
FIRSTS = (FIRST, FINER)  # until there is a curve
QUICK = Effort(2.0, 0, 1.0, 48, 60_000, math.inf)  # for what would be possible with other limits


@dataclass(frozen=True)
class Driving:
    """Limits of a robot, and its headings at start and goal.

    Attributes:
        radius: least turning radius, in map units.
        reverses: whether it may drive backwards.
        start_heading: heading at the start in radians; None for any.
        goal_heading: heading at the goal in radians; None for any.
    """

    radius: float
    reverses: bool = False
    start_heading: float | None = None
    goal_heading: float | None = None


class DriveSearch:
    """A search for a curve of low cost on a drive map.

    Attributes:
        evaluations: nodes that were expanded and parts that were tried, so far.
    """

    def __init__(
        self,
        drive_map: DriveMap,
        driving: Driving,
        bending: float,
        seed: int = 0,
        field: Field | None = None,
    ):
        """Take what is planned.

        Args:
            drive_map: obstacles and costs.
            driving: limits of the robot.
            bending: weight of curvature.
            seed: seed of the draws of local improvements.
            field: obstacles and costs that count instead of the map's, such as with walls.
        """
        self._map, self._driving = drive_map, driving
        self._field = drive_map.field if field is None else field
        radius = driving.radius / drive_map.unit
        self._limits = Limits(radius, driving.reverses, bending, CHANGE * radius)
        self._stream = seed_stream(np.random.SeedSequence(seed))
        self._ends = drive_map.to_nodes([drive_map.task.given.start, drive_map.task.given.target])
        self.evaluations = 0
        self._guides: dict[float, Floats] = {}

    def curves(
        self, is_over: Callable[[], bool], is_timed: bool, firsts: tuple[Effort, ...] = FIRSTS
    ) -> Iterator[Curve]:
        """Yield curves, each of which costs less than those before; none if no curve was found.

        Args:
            is_over: whether planning shall end.
            is_timed: whether there is a limit of time; then one more search follows.
            firsts: sizes of searches by turns, until one finds a curve.
        """
        best = self._first(firsts, is_over)
        if best is None:
            return
        yield self._curve(best)
        yield from self._improved(best, ROUNDS, is_over)
        for effort in (SECOND, THIRD) if is_timed else (SECOND,):
            if is_over():
                return
            other = self._chain(self.search(effort, is_over))
            if other is not None:
                self._shorten(other, ROUNDS, is_over)
                if other.numbers[COST] < best.numbers[COST]:
                    best = other
                    yield self._curve(best)
            yield from self._improved(best, LAST_ROUNDS, is_over)

    def search(self, effort: Effort, is_over: Callable[[], bool]) -> Search:
        """Return a search after it has ended."""
        field, driving = self._field, self._driving
        radius = self._limits.radius
        cell = min(max(radius / 4.0, SMALLEST_CELL), max(LARGEST_CELL, radius / 16.0)) / effort.finer
        search = make_search(effort.nodes, cell, effort.headings, 1.5 * cell, effort.weight, driving.reverses)
        if is_over():
            return search  # without a curve
        guide = self._guide(effort.beyond)
        is_free = driving.goal_heading is None
        goals = np.array([[*self._ends[1], driving.goal_heading or 0.0]])
        common = guide, self._limits, goals, is_free, search
        begin(*common, self._starts())
        while not expand(field, *common, SLICE, effort.patience) and not is_over():
            pass
        self.evaluations += int(search.counts[EXPANDED])
        return search

    def reach(self, is_over: Callable[[], bool]) -> float:
        """Return how far a robot gets from the start, in map units; infinite if it may get farther."""
        search = self.search(FINER._replace(nodes=60_000), is_over)
        is_shut = search.counts[WAITING] == 0 and search.counts[NODES] < 60_000 and not is_over()
        return float(search.numbers[FARTHEST]) * self._map.unit if is_shut else math.inf

    def _first(self, firsts: tuple[Effort, ...], is_over: Callable[[], bool]) -> Chain | None:
        for effort in firsts:
            chain = self._chain(self.search(effort, is_over))
            if chain is not None or is_over():
                return chain
        return None

    def _improved(self, chain: Chain, rounds: int, is_over: Callable[[], bool]) -> Iterator[Curve]:
        """Improve a chain; yield the curve each time after it has become clearly better, and at the end."""
        still, told = 0, chain.numbers[COST]
        for _ in range(rounds):
            if is_over() or still >= STILL:
                break
            before = chain.numbers[COST]
            self._shorten(chain, 1, is_over)
            still = still + 1 if chain.numbers[COST] > before * (1.0 - GAINED) else 0
            if chain.numbers[COST] < told * (1.0 - 1e-3):
                told = chain.numbers[COST]
                yield self._curve(chain)
        if chain.numbers[COST] < told:
            yield self._curve(chain)

    def _shorten(self, chain: Chain, rounds: int, is_over: Callable[[], bool]) -> None:
        driving = self._driving
        ends = driving.start_heading is None, driving.goal_heading is None
        for _ in range(rounds):
            if is_over():
                break
            shorten(self._field, self._limits, chain, *ends, self._stream, TRIALS)
            self.evaluations += TRIALS

    def _guide(self, beyond: float) -> Floats:
        if beyond not in self._guides:
            self._guides[beyond] = guide_to(self._field, self._ends[1], self._ends[0], beyond)
        return self._guides[beyond]

    def _starts(self) -> Floats:
        """Return the poses that a curve may begin with, (k, 3)."""
        heading = self._driving.start_heading
        if heading is not None:
            return np.array([[*self._ends[0], heading]])
        (x, y), (to_x, to_y) = self._ends.tolist()
        towards = math.atan2(to_y - y, to_x - x)
        angles = towards + math.tau / FREE_HEADINGS * np.arange(FREE_HEADINGS)
        return np.column_stack([np.tile([x, y], (FREE_HEADINGS, 1)), angles])

    def _chain(self, search: Search) -> Chain | None:
        """Return the curve of a search as a chain; None without one, or with too many pieces."""
        if search.counts[BEST_NODE] < 0:
            return None
        pose, pieces = found(search)
        return None if len(pieces) >= MOST_PIECES else chain_of(self._field, self._limits, pose, pieces)

    def _curve(self, chain: Chain) -> Curve:
        """Return the curve of a chain, in map units."""
        unit = self._map.unit
        pieces = chain.pieces[: int(chain.numbers[PIECES])] * [1.0 / unit, unit]
        x, y = self._map.task.given.start
        return Curve(np.array([x, y, math.degrees(chain.poses[0, 2])]), pieces, self._driving.radius)
