"""Robots that drive along the best path so far, while the swarm goes on planning.

After some iterations (`Drive`) the robot of a swarm drives a piece of the best path so far, if the piece is
free of obstacles; otherwise it waits. From then on the swarm plans from the robot's position. The swarm then
has a problem of its own, and the memory of the optimizer is carried over to that problem.
"""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import Namespace
from swarm_gym.errors import ScenarioError, SettingError
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import Swarms
from swarm_gym.problem import MapProblem, WalkProblem
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios import AnyScenario, Point, drive_of
from swarm_gym.settings import Settings
from swarm_gym.worlds import Worlds

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

# Relative excess of a path's length over the distance of a drive up to which the robot reaches the target.
ARRIVAL = 1e-9


class Robots:
    """The robots of B swarms; a robot that does not drive stays at the start.

    Attributes:
        places: (B, 2) positions of the robots, in map coordinates.
        driven: (B,) distances that they have driven in this episode, in map units.
        arrived: (B,) whether they are at the target.
        trajectories: for each robot the points, (x, y), that it has passed, from the start to its position.
    """

    def __init__(self, worlds: Worlds, settings: Settings, optimizer: type[Optimizer], swarms: Swarms):
        self._worlds, self._optimizer, self._swarms = worlds, optimizer, swarms
        num_swarms = len(swarms.size)
        self._world = np.zeros(num_swarms, dtype=np.int64)  # index of the world in force
        # For every world: iteration of the first drive, 0 for never; iterations between drives; distance.
        scenario_of = np.searchsorted(worlds.first, np.arange(worlds.num_worlds), side="right") - 1
        drives = [drive_of(scenario) for scenario in settings.scenarios]
        numbers = [(drive.first, drive.every, drive.distance) if drive else (0, 1, 0.0) for drive in drives]
        self._first, self._every, self._distance = np.array(numbers)[scenario_of].T
        self.places = np.zeros((num_swarms, 2))
        self.driven = np.zeros(num_swarms)
        self.arrived = np.zeros(num_swarms, dtype=np.bool_)
        self._scenario_of = scenario_of
        self._shortest: dict[int, float] = {}  # length of the shortest way by the number of a scenario
        self.trajectories: list[list[Point]] = [[] for _ in range(num_swarms)]

    def begin(self, rows: Integers) -> None:
        """Put the robots of swarms that begin episodes at the starts."""
        self._world[rows] = self._swarms.problem[rows]
        self.driven[rows] = 0.0
        self.arrived[rows] = False
        for row in rows.tolist():
            start = self._problem(row).scenario.start
            self.places[row], self.trajectories[row] = start, [start]

    def enter_next_worlds(self, due: Flags) -> Flags:
        """Move these swarms on to their next worlds; return those that have moved on, (B,).

        A world in which the robot would be inside an obstacle, or cut off, waits until the robot has driven
        on.
        """
        entered = due.copy()
        for row in np.flatnonzero(due).tolist():
            world = int(self._world[row]) + 1
            if self._swarms.problem[row] < self._worlds.num_worlds:
                self._swarms.problem[row] = world
            else:
                try:
                    problem = self._problem(row, world).begun_at(self.trajectories[row][-1])
                except ScenarioError:
                    entered[row] = False
                    continue
                self._give(row, problem, world)
            self._world[row] = world
        return entered

    def drive(self, going: Flags) -> Flags:
        """Drive the robots of these swarms, (B,), where it is time to and nothing is in the way.

        Returns:
            (B,) swarms that have a new problem, since their robots have driven and not reached the target.
        """
        moved, iteration, world = np.zeros_like(going), self._swarms.iteration, self._world
        since = iteration - self._first[world]
        due = going & (self._first[world] > 0) & (since >= 0) & (since % self._every[world] == 0)
        for row in np.flatnonzero(due).tolist():
            problem = self._problem(row)
            found = self._free_piece(row, problem, self._distance[world[row]])
            if found is None:
                continue
            piece, arrives = found
            if arrives:
                # The robot is at the target, so the episode ends.
                self._swarms.budget[row] = self._swarms.evaluations[row]
            else:
                try:
                    there = problem.begun_at(tuple(piece[-1].tolist()))
                except ScenarioError:  # the robot would stop at the edge of a blocked cell
                    continue
                for vectors in self._optimizer.decision_vectors(self._swarms, row, problem.dimension):
                    vectors[...] = there.carried_over(vectors, problem)
                if isinstance(there, WalkProblem):
                    self._cut_walk(row, piece, there)
                self._give(row, there, int(world[row]))
                moved[row] = True
            self.arrived[row] = arrives
            self.places[row] = piece[-1]
            self.driven[row] += length_of(piece)
            self.trajectories[row] += [(x, y) for x, y in piece[1:].tolist()]
        return moved

    def detours(self) -> Floats:
        """Return (B,) how far the robots drove above the shortest way, as a share of it.

        The shortest way leads from the start to the target on the map after all events. Infinity stands for a
        robot that is not at the target.
        """
        found = np.full(len(self.driven), np.inf)
        for row in np.flatnonzero(self.arrived).tolist():
            found[row] = self.driven[row] / self._shortest_way(int(self._world[row])) - 1.0
        return found

    def _shortest_way(self, world: int) -> float:
        """Return the length of the shortest way on the last map of the scenario of a world."""
        scenario = int(self._scenario_of[world])
        if scenario not in self._shortest:
            from swarm_gym.reference import shortest_path  # loads what environments else do without

            last = int(np.flatnonzero(self._scenario_of == scenario)[-1])
            self._shortest[scenario] = shortest_path(self._problem(0, last).scenario)[0]
        return self._shortest[scenario]

    def copy_rows(self, rows: Integers) -> None:
        """Make the robot of swarm i a copy of the robot of swarm rows[i]; the swarms were copied before."""
        problems = list(self._worlds.problems)
        for array in (self._world, self.places, self.driven, self.arrived):
            array[...] = array[rows]
        self.trajectories = [list(self.trajectories[row]) for row in rows]
        for row, number in enumerate(self._swarms.problem.tolist()):
            if number >= self._worlds.num_worlds:
                self._give(row, problems[number], int(self._world[row]))

    def _free_piece(self, row: int, problem: MapProblem, distance: float) -> tuple[Floats, bool] | None:
        """Return the piece of the best path so far to drive, see `piece_of`; None if no such piece is free.

        Best paths have the best fitness and often graze obstacles by less than a map unit. A path that is not
        free is therefore repaired once; if that does not suffice, the best feasible path stands in for it.
        """
        for path in self._paths(row, problem):
            piece, arrives = piece_of(path, distance)
            if problem.is_clear(piece):
                return piece, arrives
        return None

    def _paths(self, row: int, problem: MapProblem) -> Iterator[Floats]:
        if isinstance(problem, WalkProblem):
            yield self._swarms.best_path(row, problem.scenario.target)
            return
        best = self._swarms.best_position[row, : problem.dimension]
        yield problem.points(best)
        yield problem.points(problem.repaired(best, 1.0))
        if self._swarms.feasible_fitness[row] < np.inf:
            yield problem.points(self._swarms.feasible_position[row, : problem.dimension])

    def _cut_walk(self, row: int, driven: Floats, there: WalkProblem) -> None:
        """Let the best walk so far begin at the robot's position; its next point lies in another cell."""
        grid, left = there.scenario.map, self._swarms.best_walk_points(row)[len(driven) - 1 :].copy()
        here = grid.cell_of(there.scenario.start)
        while len(left) and grid.cell_of(left[0]) == here:
            left = left[1:]
        self._swarms.best_walk[row] = 1 + len(left)
        self._swarms.best_walk_points(row)[:] = np.vstack([there.scenario.start, left])

    def _problem(self, row: int, number: int | None = None) -> MapProblem:
        """Return the problem of a swarm or of a world."""
        problem = self._worlds.problems[self._swarms.problem[row] if number is None else number]
        assert isinstance(problem, MapProblem)
        return problem

    def _give(self, row: int, problem: MapProblem, world: int) -> None:
        """Give a swarm a problem of its own, in that world."""
        number = self._worlds.num_worlds + row
        self._worlds.replace(number, problem, world)
        self._swarms.problem[row] = number


def make_robots(
    worlds: Worlds, settings: Settings, optimizer: type[Optimizer], swarms: Swarms, xp: Namespace
) -> Robots | None:
    """Return the robots of a simulation, or None if no scenario lets them drive.

    Raises:
        SettingError: if the optimizer moves the robot itself and so plans no path to drive along, or if the
            arrays of the simulation, of the namespace `xp`, are no NumPy arrays.
    """
    if not any(map(drive_of, settings.scenarios)):
        return None
    if xp is not np:
        raise SettingError(
            f"scenario {settings.scenarios[0].name!r} has a robot that drives, which needs a simulation on "
            "NumPy arrays, got one on tensors; choose a scenario without a drive"
        )
    if optimizer.begins_with_robot:
        raise SettingError(
            f"scenario {settings.scenarios[0].name!r}: optimizer {optimizer.name} moves the robot itself, so "
            "that it cannot drive; choose another optimizer or a scenario without a drive"
        )
    return Robots(worlds, settings, optimizer, swarms)


def require_drives(scenarios: Iterable[AnyScenario], purpose: str) -> None:
    """Raise an error if there is a scenario in which no robot drives.

    Raises:
        SettingError: naming the first of these scenarios.
    """
    for scenario in scenarios:
        if drive_of(scenario) is None:
            raise SettingError(
                f"{purpose} needs robots that drive, but in scenario {scenario.name!r} none does; choose one "
                "with a drive, as in dynamic:case1-gate@70-drive@40,every=5,distance=60"
            )


def piece_of(path: Floats, distance: float) -> tuple[Floats, bool]:
    """Return the first piece, (j, 2), of a polyline, (k, 2), of that length, and whether it is all."""
    ends = np.cumsum(np.hypot(*np.diff(path, axis=0).T))
    if ends[-1] <= distance * (1.0 + ARRIVAL):
        return path, True
    segment = int(np.searchsorted(ends, distance))
    begin = ends[segment - 1] if segment > 0 else 0.0
    share = (distance - begin) / (ends[segment] - begin)
    last = path[segment] + share * (path[segment + 1] - path[segment])
    return np.vstack([path[: segment + 1], last]), False
