"""The interface of all problems, whatever their map and encoding."""

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import require_number
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, evaluate_entry, repair_entry
from swarm_gym.scenarios import StaticScenario

Floats = NDArray[np.float64]


class Problem(ABC):
    """Find the decision vector, shape (dimension,), of least fitness on a scenario.

    Attributes:
        scenario: the map and the task, or the test function.
    """

    scenario: StaticScenario

    @property
    def counts_evaluations(self) -> bool:
        """True if a run is measured by its evaluations until the target; the optimum is their least mean."""
        return False

    @property
    @abstractmethod
    def dimension(self) -> int:
        """Length of a decision vector."""

    @property
    @abstractmethod
    def table(self) -> Table:
        """The problem as the kernels read it."""

    @property
    @abstractmethod
    def lower_bound(self) -> float:
        """A lower bound of the fitness."""

    @property
    def least_fitness(self) -> float | None:
        """The least fitness if it is known without computing, else None."""
        return None

    @property
    def target(self) -> float:
        """The fitness at which an episode ends; minus infinity if it goes on after the optimum is found."""
        return -math.inf

    @property
    def gap_unit(self) -> float:
        """Unit of gaps to the optimum: the lower bound, or 1 if that is 0."""
        return self.lower_bound or 1.0

    @property
    @abstractmethod
    def collision_bound(self) -> float:
        """An upper bound of the degree of collision of paths inside the bounds, in map units."""

    @property
    @abstractmethod
    def identity(self) -> tuple[object, ...]:
        """Numbers and lists that the fitness depends on: equal for equal problems, whatever their names."""

    @abstractmethod
    def points(self, vectors: ArrayLike) -> Floats:
        """Return the paths, (..., k, 2) in map coordinates, of decision vectors (..., dimension).

        Without a map, these are the vectors in parallel coordinates.
        """

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper bounds of decision vectors, (dimension,) each: the workspace."""
        return self.table.lower[: self.dimension], self.table.upper[: self.dimension]

    @property
    def initial_bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the first population, (dimension,) each."""
        return self.table.initial_lower[: self.dimension], self.table.initial_upper[: self.dimension]

    def evaluate(self, vector: ArrayLike) -> tuple[float, float]:
        """Return fitness and degree of collision of one decision vector."""
        return evaluate_entry(self.table, self._path(vector))

    def repaired(self, vector: ArrayLike, repair_degree: float) -> Floats:
        """Return a decision vector after one repair pass of degree phi."""
        require_number("repair_degree", repair_degree, 0.0, 1.0)
        path = self._path(vector)
        repair_entry(self.table, path, repair_degree)
        return path[1 : self.dimension + 1]

    def _path(self, vector: ArrayLike) -> Floats:
        vector = np.asarray(vector, dtype=np.float64)
        if vector.shape != (self.dimension,):
            raise ValueError(f"expected {self.dimension} components, got shape {vector.shape}")
        if not np.isfinite(vector).all():
            raise ValueError(f"decision vectors must be finite, got {vector.tolist()}")
        path = np.zeros(columns(self.dimension) + 1)
        path[1 : self.dimension + 1] = vector
        return path
