"""Problems of bit strings: all ones are wanted."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.problem.onemax.table import OneMaxTable, tabulate
from swarm_gym.scenarios import OneMaxScenario

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class OneMaxProblem(FunctionProblem):
    """Find the string of n ones; a decision vector, (1,), is the number of ones.

    Attributes:
        scenario: length of the string, and number of ones at the beginning.
    """

    scenario: OneMaxScenario

    @cached_property
    def table(self) -> OneMaxTable:  # type: ignore[override]
        """The problem as the kernels read it."""
        return tabulate(self.scenario)

    @property
    def counts_evaluations(self) -> bool:
        """True, since a run is measured by its evaluations until the target."""
        return True

    @property
    def least_fitness(self) -> None:  # type: ignore[override]
        """None: the optimum is a number of evaluations, which has to be computed."""
        return None

    @property
    def target(self) -> float:
        """The fitness at which an episode ends: 0, all bits are set."""
        return 0.0

    @property
    def identity(self) -> tuple[object, ...]:
        """Length and start, on which runs depend."""
        return "onemax", self.scenario.size, self.scenario.start

    def values_in_plane(self, first: Floats, second: Floats) -> Floats:
        """Return the number of bits that are not set, (m, n), for these numbers of ones, (n,)."""
        return np.broadcast_to(self.scenario.size - first, (len(second), len(first))).copy()
