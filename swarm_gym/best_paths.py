"""The best paths so far of swarms, as points on the map: the best by fitness, and the best feasible one.

The paper's fitness trades a little collision for a little length, so the best path by fitness often grazes
obstacles. The best feasible one is kept as well.

Paths are NumPy arrays. If the state of the swarms is tensors, the numbers of paths are copied from these.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import as_numpy, namespace_of
from swarm_gym.population import Swarms
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.worlds import Worlds

Floats = NDArray[np.float64]


class BestPaths:
    """The best paths so far of B swarms, read from their state.

    Args:
        swarms: state of the swarms.
        worlds: problems that the swarms work on.
    """

    def __init__(self, swarms: Swarms, worlds: Worlds):
        self._swarms, self._worlds = swarms, worlds
        self._dimension = worlds.problems[0].dimension
        self._are_walks = swarms.walk.shape[1] > 0

    def best(self) -> Floats:
        """Return (B, k, 2) best paths by fitness, in map units; for test functions, see `Problem.points`.

        A walk that has reached the target stays there.
        """
        return self._walks() if self._are_walks else self._points(self._swarms.best_position)

    def best_of(self, row: int) -> Floats:
        """Return (k, 2) the best path of a swarm by fitness; a walk ends when it has reached the target."""
        number = int(self._swarms.problem[row])
        if self._are_walks:
            return np.vstack([as_numpy(self._swarms.best_walk_points(row)), self._targets[number]])
        vector = as_numpy(self._swarms.best_position[row, : self._dimension])
        return self._worlds.problems[number].points(vector)

    def feasible(self, fitness: Floats | None = None) -> Floats:
        """Return (B, k, 2) best feasible paths, as `best` does; NaN where there is none.

        Args:
            fitness: (B,) what `feasible_fitness` returns, if it is known, as an array of NumPy.
        """
        paths = self._walks() if self._are_walks else self._points(self._swarms.feasible_position)
        none = np.isnan(as_numpy(self.feasible_fitness()) if fitness is None else fitness)
        if none.any():
            paths[none] = np.nan
        return paths

    def feasible_fitness(self) -> Floats:
        """Return (B,) fitness of the best feasible paths; NaN where there is none.

        An event on the map forgets all paths except the members' and the best one by fitness.
        """
        swarms, xp = self._swarms, namespace_of(self._swarms.problem)
        if self._are_walks:
            return xp.where(swarms.best_collision <= FEASIBILITY_TOLERANCE, swarms.best_fitness, np.nan)
        return xp.where(xp.isfinite(swarms.feasible_fitness), swarms.feasible_fitness, np.nan)

    def _points(self, positions: Floats) -> Floats:
        return self._worlds.points(as_numpy(positions)[:, : self._dimension], as_numpy(self._swarms.problem))

    def _walks(self) -> Floats:
        problem, walk, best_walk = map(
            as_numpy, (self._swarms.problem, self._swarms.walk, self._swarms.best_walk)
        )
        num_points = walk.shape[1]
        paths = np.repeat(self._targets[problem][:, None], num_points + 1, axis=1)
        walked = np.arange(num_points) < best_walk[:, None]
        paths[:, :-1][walked] = walk[walked]
        return paths

    @cached_property
    def _targets(self) -> Floats:
        """(number of problems, 2) targets of walks."""
        return np.array([problem.points(np.zeros(2))[-1] for problem in self._worlds.problems])
