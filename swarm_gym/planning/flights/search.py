"""Episodes of a swarm over terrain: routes seen from above, and the shortest flight over any of them."""

import math
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers import Controller, make_controller_for
from swarm_gym.env import SwarmEnv
from swarm_gym.planning.flights.measures import length_of
from swarm_gym.planning.flights.profile import flown, least_climb
from swarm_gym.planning.flights.result import FlightImprovement
from swarm_gym.problem import TerrainProblem
from swarm_gym.scenarios.terrain.survey import Survey
from swarm_gym.sources import GUIDED

Floats = NDArray[np.float64]

OPTIMIZER, CONTROLLER = "differential-evolution", "fixed:60"
ITERATIONS = 200  # of an episode
WAYPOINTS = (10, 16, 24)  # between start and goal, in turn
EPISODES = 6  # without a budget


class FlightSearch:
    """Episodes on a task, and the shortest flight that they have found.

    Attributes:
        improvements: the flights that were the shortest one in turn.
        evaluations: evaluations so far.
    """

    def __init__(
        self,
        task: Survey,
        optimizer: str | None,
        controller: str | None,
        seed: int,
        began: float,
    ):
        self._task, self._optimizer = task, optimizer or OPTIMIZER
        self._controller: Controller = make_controller_for(self._optimizer, controller or CONTROLLER)
        self._options: dict[str, Any] = self._controller.options_with({"source": GUIDED})
        self._seed, self._began, self._episodes = seed, began, 0
        self._environments: dict[int, SwarmEnv] = {}
        self._refused: list[Floats] = []  # routes that cannot be flown
        self.improvements: list[FlightImprovement] = []
        self.evaluations = 0

    def begin(self) -> None:
        """Keep the straight line if it can be flown."""
        self._keep(np.array([self._task.scenario.start[:2], self._task.scenario.target]), "straight line")

    def run_until(self, most_evaluations: float, limit: float, most_episodes: float) -> bool:
        """Run episodes until a budget is spent; return whether Ctrl-C ended them.

        Args:
            most_evaluations: evaluations after which no further episode begins.
            limit: time of the monotonic clock at which the last episode ends.
            most_episodes: number of episodes.
        """
        try:
            while True:
                if self._is_over(limit):
                    return False
                self._run(limit)
                if (
                    time.monotonic() >= limit
                    or self.evaluations >= most_evaluations
                    or self._episodes >= most_episodes
                ):
                    return False
        except KeyboardInterrupt:
            return True

    def _run(self, limit: float) -> None:
        """Run an episode; its best flight is kept after 1, 2, 4, 8, ... iterations and at its end."""
        count = WAYPOINTS[self._episodes % len(WAYPOINTS)]
        if count not in self._environments:
            self._environments[count] = SwarmEnv(
                self._optimizer,
                scenario=self._task.scenario,
                num_waypoints=count,
                iterations=ITERATIONS,
                **self._options,
            )
            self._keep_ways(self._environments[count], limit)
        if self._is_over(limit):
            return  # the time was spent on planning ways
        env = self._environments[count]
        self._controller.reset(1, self._seed)
        observation, info = env.reset(seed=self._seed)
        self._seed += 1
        self._episodes += 1
        ended, iteration, counted = False, 0, int(info["evaluations"])
        self.evaluations += counted
        while not ended and time.monotonic() < limit:
            observation, _, ended, _, info = env.step(self._controller.act(observation[None])[0])
            iteration += 1
            self.evaluations += int(info["evaluations"]) - counted
            counted = int(info["evaluations"])
            if ended or iteration & (iteration - 1) == 0:
                self._keep_best(env)
        self._keep_best(env)

    def _is_over(self, limit: float) -> bool:
        """Return whether there is a flight, and the time of the clock has come."""
        return bool(self.improvements) and time.monotonic() >= limit

    def least_climb(self) -> float:
        """Return the smallest angle of climb in degrees that a route so far needs, or infinity."""
        return min((least_climb(self._task, route) for route in self._refused), default=math.inf)

    def _keep_ways(self, env: SwarmEnv, limit: float) -> None:
        """Keep flights over a coarse graph, around which members begin, until a time of the clock."""
        problem = env.simulation.problems[0]
        assert isinstance(problem, TerrainProblem)
        assert problem.ways is not None
        for way in problem.points(problem.ways):
            if self._is_over(limit):
                return
            self._keep(way, "coarse graph")

    def _keep_best(self, env: SwarmEnv) -> None:
        problem = env.simulation.problems[0]
        assert isinstance(problem, TerrainProblem)
        vector = env.simulation.best_position(0)[: problem.dimension]
        self._keep(problem.points(vector), "swarm")

    def _keep(self, route: Floats, found_by: str) -> None:
        """Keep the flight over a route, without needless waypoints, if it is the shortest one."""
        route = _straightened(self._task, route)
        flight = flown(self._task, route)
        if flight is None:
            self._refused.append(route)
            return
        length = length_of(flight)
        if not self.improvements or length < self.improvements[-1].length:
            seconds = time.monotonic() - self._began
            self.improvements.append(FlightImprovement(seconds, flight, length, found_by))


def _straightened(task: Survey, route: Floats) -> Floats:
    """Return a route without the waypoints whose removal makes its flight shorter, one at a time.

    A route that cannot be flown is returned as it is, unless one waypoint less lets it be flown.
    """
    flight = flown(task, route)
    length = math.inf if flight is None else length_of(flight)
    shorter = True
    while shorter and len(route) > 2:
        shorter = False
        for number in range(1, len(route) - 1):
            without = np.delete(route, number, axis=0)
            found = flown(task, without)
            if found is not None and length_of(found) < length:
                route, length, shorter = without, length_of(found), True
                break
    return route
