"""Problems without a map: the least value of a test function."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.problem.function.table import FunctionTable, tabulate, values_in_plane
from swarm_gym.problem.problem import Problem
from swarm_gym.scenarios import FunctionScenario

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FunctionProblem(Problem):
    """Find the vector, shape (dimension,), at which a function is least.

    Attributes:
        scenario: the function.
    """

    scenario: FunctionScenario

    @property
    def dimension(self) -> int:
        """Length of a decision vector."""
        return self.scenario.dimension

    @cached_property
    def table(self) -> FunctionTable:
        """The problem as the kernels read it."""
        return tabulate(self.scenario)

    @property
    def lower_bound(self) -> float:
        """A lower bound of the fitness: the least value, 0."""
        return 0.0

    @property
    def least_fitness(self) -> float:
        """The least value, which is 0."""
        return 0.0

    @property
    def collision_bound(self) -> float:
        """A positive upper bound, so that observations have a range; the degree of collision is always 0."""
        return 1.0

    @property
    def identity(self) -> tuple[object, ...]:
        """The function and its optimum, on which the fitness depends."""
        return self.scenario.function, list(self.scenario.optimum)

    def values_in_plane(self, first: Floats, second: Floats) -> Floats:
        """Return the values over a plane, (m, n); components beyond the first two come from the optimum.

        Args:
            first: (n,) values of the first component.
            second: (m,) values of the second component, where there is one.
        """
        return values_in_plane(self.table, first, second)

    def points(self, vectors: ArrayLike) -> Floats:
        """Return decision vectors (..., D) in parallel coordinates, (..., D, 2): number from 1, and value."""
        values = np.asarray(vectors, dtype=np.float64)
        points = np.empty((*values.shape, 2))
        points[..., 0], points[..., 1] = np.arange(1.0, self.dimension + 1), values
        return points
