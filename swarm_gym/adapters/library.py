"""Optimizers whose iterations a library carries out, in Python.

This package does all that is not the iteration itself: the first population, growth and shrinking,
immigrants, events on the map, E(P). What a library remembers between iterations lies in the arrays of the
swarm, never in objects. So environments can be copied and pickled, and swarms can branch, as all others.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.adapters.swarm_view import BudgetSpentError, SwarmView
from swarm_gym.ioh_problem import IohTable, IohTables, drawing
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import declared_parameters
from swarm_gym.population import Swarms, num_staying, summarise
from swarm_gym.problem.tables import Tables

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

KNOWN = 0  # column of `Swarms.registers`: number of members that the library has seen before


OwnParameters = TypeVar("OwnParameters", bound=NamedTuple)  # the class of parameters of an algorithm


class NoParameters(NamedTuple):
    """The parameters of an algorithm that has none to set."""


class LibraryOptimizer(Optimizer, Generic[OwnParameters]):
    """An optimizer whose iteration is Python code around a library; a subclass implements `iterate`.

    Between iterations, members are added and deleted by the rules of the SPSFA paper: new ones are uniform in
    the box that the population spans (eq. 12), and the worst collisions are deleted first. An iteration that
    the evaluation budget cuts short leaves the members as they were; its evaluations count for the best path.
    After an event on the map, the library has seen none of the members, which begin again.

    Attributes:
        calls_python: True: Python code may evaluate its decision vectors, such as a function of `ioh`.
    """

    name = "library"
    parameter_class: ClassVar[type] = NoParameters
    calls_python: ClassVar[bool] = True
    # They are registered for the class of parameters, as of any optimizer, but never compiled for it.
    kernels = Firefly.kernels

    def __init_subclass__(cls) -> None:
        # Not that of `Optimizer`: there are no kernels to choose.
        super(Optimizer, cls).__init_subclass__()
        cls.parameters = declared_parameters(cls.parameter_class)
        cls.defaults = cls.parameter_values({})

    @classmethod
    @abstractmethod
    def iterate(cls, swarm: SwarmView, parameters: OwnParameters) -> None:
        """Advance one swarm by one iteration: evaluate decision vectors, then replace the members.

        Args:
            swarm: the swarm, after growth or shrinking. `memory` and `notes` are to be written for the next
                iteration; rows of `memory` move with their members.
            parameters: object of `parameter_class` with the values of this swarm.

        Raises:
            BudgetSpentError: passed on from `SwarmView.evaluate`.
        """

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """Return R: one integer, the number of known members."""
        return 1

    @classmethod
    def initialise(
        cls,
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: Integers,
        mean_weight: float,
        given: bool = False,
        parameters: Floats | None = None,  # noqa: ARG003
    ) -> None:
        """Begin the chosen swarms with first populations of these sizes, (B,), drawn or given."""
        swarms.registers[chosen, KNOWN] = 0
        Firefly.initialise(swarms, _drawing(tables), chosen, sizes, mean_weight, given)
        for row in np.flatnonzero(chosen).tolist():
            SwarmView(swarms, tables, row, 0, 0.0).evaluate_drawn()

    @classmethod
    def step(
        cls,
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: Integers,
        repair_degrees: Floats,
        parameters: Floats,
        mean_weight: float,
        num_threads: int = 1,
        then: Callable[[Flags], None] | None = None,
    ) -> None:
        """Resize the chosen swarms and advance them by one iteration, one after the other."""
        rows = np.flatnonzero(chosen).tolist()
        for row in rows:
            staying = num_staying(swarms, row, sizes[row])
            swarms.registers[row, KNOWN] = min(swarms.registers[row, KNOWN], staying)
        _resize(swarms, tables, chosen, sizes, mean_weight, num_threads)
        for row in rows:
            known = int(swarms.registers[row, KNOWN])
            swarm = SwarmView(swarms, tables, row, known, float(repair_degrees[row]))
            swarm.evaluate_drawn(arrived=True)
            try:
                with np.errstate(over="ignore"):  # pymoo divides by distances of members that may coincide
                    cls.iterate(swarm, cls.parameter_class(*parameters[row].tolist()))
            except BudgetSpentError:
                pass  # the episode ends
            else:
                swarms.registers[row, KNOWN] = swarms.size[row]
            summarise(swarms, row, mean_weight)
        if then is not None:
            then(chosen)

    @classmethod
    def re_evaluate(
        cls, swarms: Swarms, tables: Tables, chosen: Flags, mean_weight: float, num_threads: int = 1
    ) -> None:
        """Evaluate members and the best so far again; what the library remembered is forgotten."""
        swarms.registers[chosen, KNOWN] = 0
        Firefly.re_evaluate(swarms, tables, chosen, mean_weight, num_threads)


def _drawing(tables: Tables | IohTables) -> Tables:
    """Return the tables by which compiled code draws members; without kernels of their own, others."""
    return drawing(tables) if isinstance(tables, IohTable) else tables


def _resize(
    swarms: Swarms, tables: Tables, chosen: Flags, sizes: Integers, mean_weight: float, num_threads: int
) -> None:
    """Grow or shrink the chosen swarms to these sizes, (B,), by compiled code.

    That code is the step of fireflies, with just the evaluations that growth takes: with none left, fireflies
    do not move. So nothing has to be compiled for an adapted library.
    """
    budget = swarms.budget.copy()
    staying = np.array([num_staying(swarms, row, size) for row, size in enumerate(sizes.tolist())])
    swarms.budget[:] = np.minimum(budget, swarms.evaluations + np.maximum(sizes - staying, 0))
    try:
        parameters = Firefly.stacked_parameters({}, len(sizes))
        no_repair = np.zeros(len(sizes))
        Firefly.step(swarms, _drawing(tables), chosen, sizes, no_repair, parameters, mean_weight, num_threads)
    finally:
        swarms.budget[:] = budget
