"""Problems that Python code evaluates: functions of the package `ioh`.

Compiled code cannot call `ioh`. It draws new members from a table whose function has the value NaN
everywhere, and adapted optimizers evaluate what has this value, see `swarm_gym.adapters.library`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from swarm_gym.checks import require_number
from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.problem.function.table import SUM_SQUARES, FunctionTable, FunctionTables
from swarm_gym.problem.padding import Floats, Integers, Whole, pad
from swarm_gym.scenarios.ioh_scenario import SUITES, IohScenario, called, uncounted

_SUITES = tuple(SUITES)


class IohTable(NamedTuple, Generic[Whole]):
    """The problem table of a function of `ioh`; in a stacked table every field has a leading problem axis.

    Numbers name the function. It has the fields that the tables of all problems have, see
    `swarm_gym.problem.tables`, but no kernels.
    """

    dimension: Whole  # D
    suite: Whole  # number of the suite in the order of `SUITES`
    function: Whole  # number of the function in `ioh`
    instance: Whole  # number of the instance
    lower: Floats  # (C,) bounds of decision vectors: the domain
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population: the domain
    initial_upper: Floats  # (C,)


IohTables = IohTable[Integers]  # of stacked problems


def select(tables: IohTables, index: int) -> IohTable:
    """Return one problem table out of stacked ones, as views."""
    return IohTable._make(column[index] for column in tables)


def drawing(tables: IohTables) -> FunctionTables:
    """Return tables by which compiled code draws members; their fitness is NaN until `ioh` gives it."""
    unknown = np.full_like(tables.lower, np.nan)
    kinds = np.full_like(tables.function, SUM_SQUARES)  # which has no value without an optimum
    bounds = tables.lower, tables.upper, tables.initial_lower, tables.initial_upper
    return FunctionTable(tables.dimension, kinds, *bounds, unknown)


def value(table: IohTable, vector: Floats, counted: bool = True) -> float:
    """Return the value of the function at a decision vector, (D,), above its least one.

    Args:
        table: problem table of the function.
        vector: decision vector.
        counted: whether the evaluation counts for `ioh`, and appears in its logs.
    """
    kept = called if counted else uncounted
    problem = kept(_SUITES[table.suite], int(table.function), int(table.dimension), int(table.instance))
    return max(0.0, float(problem(vector)) - float(problem.optimum.y))


@dataclass(frozen=True)
class IohProblem(FunctionProblem):
    """Find the vector, shape (dimension,), at which a function of `ioh` is least.

    The fitness is the value above the least one: 0 is the optimum. What this object evaluates does not count
    for `ioh`; only what an optimizer evaluates does.

    Attributes:
        scenario: the function.
    """

    scenario: IohScenario

    @cached_property
    def table(self) -> IohTable:  # type: ignore[override]
        """The problem as adapted optimizers read it."""
        scenario = self.scenario
        low, high = (pad(np.full(scenario.dimension, bound)) for bound in scenario.domain)
        suite = _SUITES.index(scenario.suite)
        return IohTable(scenario.dimension, suite, scenario.number, scenario.instance, low, high, low, high)

    @property
    def identity(self) -> tuple[object, ...]:
        """Suite, function, dimension and instance, on which the fitness depends."""
        scenario = self.scenario
        return "ioh", scenario.suite, scenario.number, scenario.dimension, scenario.instance

    def evaluate(self, vector: ArrayLike) -> tuple[float, float]:
        """Return fitness and degree of collision, 0, of one decision vector."""
        return value(self.table, self._path(vector)[1 : self.dimension + 1], counted=False), 0.0

    def repaired(self, vector: ArrayLike, repair_degree: float) -> Floats:
        """Return a decision vector as it is, since there are no obstacles."""
        require_number("repair_degree", repair_degree, 0.0, 1.0)
        return self._path(vector)[1 : self.dimension + 1]

    def values_in_plane(self, first: Floats, second: Floats) -> Floats:
        """Return the values over a plane, (m, n); see `FunctionProblem.values_in_plane`."""
        vector = np.array(self.scenario.optimum)
        return np.array([[self._value_at(vector, (x, y)) for x in first] for y in second])

    def _value_at(self, vector: Floats, start: Sequence[float]) -> float:
        vector[:2] = start
        return value(self.table, vector, counted=False)
