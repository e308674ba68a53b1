"""Problems without a map: the least value of a BBOB function."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.problem.bbob.table import BbobTable, tabulate, values_at
from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.scenarios import BbobScenario

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BbobProblem(FunctionProblem):
    """Find the vector, shape (dimension,), at which a BBOB function is least.

    The fitness is the value above f_opt, which BBOB calls the precision: 0 is the optimum.

    Attributes:
        scenario: the function.
    """

    scenario: BbobScenario

    @cached_property
    def table(self) -> BbobTable:  # type: ignore[override]
        """The problem as the kernels read it."""
        return tabulate(self.scenario)

    @property
    def identity(self) -> tuple[object, ...]:
        """The suite and the numbers of function, dimension and instance, on which the fitness depends."""
        return self.scenario.identity

    def values(self, vectors: ArrayLike) -> Floats:
        """Return the fitness, (n,), of many decision vectors, (n, D)."""
        return values_at(self.table, np.ascontiguousarray(vectors, dtype=np.float64))

    def values_in_plane(self, first: Floats, second: Floats) -> Floats:
        """Return the values over a plane, (m, n); see `FunctionProblem.values_in_plane`."""
        vectors = np.tile(np.array(self.scenario.optimum), (len(second), len(first), 1))
        vectors[:, :, 0], vectors[:, :, 1] = first, second[:, None]
        return self.values(vectors.reshape(-1, self.dimension)).reshape(len(second), len(first))
