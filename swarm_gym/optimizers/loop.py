"""The compiled loops over swarms: they begin swarms, advance them by one iteration or evaluate them again.

These loops are the same for all optimizers. They are compiled for each optimizer by itself: the class of its
parameters, a NamedTuple, chooses its `Kernels`, which `Optimizer` registers here.
"""

from collections.abc import Callable
from itertools import chain, count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel, kernel_by_class
from swarm_gym.compiler.named_tuples import named_row
from swarm_gym.optimizers.parameter import Parameters
from swarm_gym.population import (
    Swarms,
    Workspace,
    add_members,
    adopt_members,
    clear,
    clear_workspace,
    make_workspace,
    num_staying,
    re_evaluate_members,
    recall,
    resize,
    summarise,
)
from swarm_gym.problem.tables import Table, Tables, select
from swarm_gym.sources import IMMIGRANTS, begin_arrivals, forget_arrivals

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


@kernel
def draw_population(
    _parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Begin swarm `b`, which is empty, with members from its source; uniform ones in the initial bounds."""
    add_members(swarms, b, table, work, size, table.initial_lower, table.initial_upper)


@kernel
def resize_population(
    _parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Grow or shrink swarm `b`."""
    resize(swarms, b, table, work, size)


@kernel
def adopt_population(
    _parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Begin swarm `b`, which is empty, with the first `size` positions as they stand."""
    adopt_members(swarms, b, table, work, size)


@kernel
def re_evaluate_population(
    _parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace
) -> None:
    """Evaluate the members of swarm `b` and then the best so far again, after its problem has changed."""
    best = swarms.best_position[b].copy()
    re_evaluate_members(swarms, b, table, work)
    recall(swarms, b, table, work, best)


@kernel(borrows=True)
def summarise_population(_parameters: Parameters, swarms: Swarms, b: int, mean_weight: float) -> None:
    """Write E(P) and other statistics of swarm `b` into its summary."""
    summarise(swarms, b, mean_weight)


class Kernels(NamedTuple):
    """The kernels of an optimizer, which work on one swarm.

    Their first arguments are (parameters, swarms, b, table, work): the parameters of swarm `b`, all swarms,
    the number of the swarm, its problem table and scratch arrays.

    Attributes:
        iterate: (..., repair_degree) moves, repairs and evaluates members for one iteration; it ends early
            if the evaluation budget is spent.
        begin: (..., size) draws a first population, see `draw_population`.
        adopt: (..., size) takes given positions as the first population, see `adopt_population`.
        change_size: (..., size) grows or shrinks a population, see `resize_population`.
        re_evaluate: (...) evaluates again all that a swarm remembers, members first, see
            `re_evaluate_population`; the budget suffices for at least one evaluation.
        summarise: (parameters, swarms, b, mean_weight) writes the statistics of a population that
            controllers see, see `summarise_population`.
    """

    iterate: Callable[..., None]
    begin: Callable[..., None] = draw_population
    adopt: Callable[..., None] = adopt_population
    change_size: Callable[..., None] = resize_population
    re_evaluate: Callable[..., None] = re_evaluate_population
    summarise: Callable[..., None] = summarise_population


_BY_CLASS: dict[str, dict[type, Callable[..., None]]] = {name: {} for name in Kernels._fields}

iterate, begin, adopt, change_size, re_evaluate, summarise_swarm = (
    kernel_by_class(_BY_CLASS[name]) for name in Kernels._fields
)


def register(parameter_class: type, kernels: Kernels) -> None:
    """Let a class of parameters choose these kernels.

    Numba tells NamedTuples apart by their names. If the name of the class is taken, it gets its full name. If
    that is taken, too, since a cell of a notebook or a module was executed again, it gets a number.
    """
    others = _BY_CLASS["iterate"]
    assert parameter_class not in others, (
        f"each optimizer needs a class of parameters of its own, got {parameter_class} again"
    )
    full, taken = f"{parameter_class.__module__}.{parameter_class.__qualname__}", {c.__name__ for c in others}
    names = chain((parameter_class.__name__, full), (f"{full}_{k}" for k in count(2)))
    parameter_class.__name__ = next(name for name in names if name not in taken)
    for name, kernel_of_optimizer in kernels._asdict().items():
        _BY_CLASS[name][parameter_class] = kernel_of_optimizer


@entry
def begin_chosen(
    defaults: Parameters,
    swarms: Swarms,
    tables: Tables,
    chosen: Flags,
    sizes: Integers,
    parameters: Floats,
    mean_weight: float,
) -> None:
    """Begin the chosen swarms with first populations that are drawn.

    The class of `defaults` chooses the kernels and names the columns of `parameters`, (B, number of them).
    """
    for b in range(sizes.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            clear(swarms, b)
            begin(named_row(defaults, parameters, b), swarms, b, table, work, sizes[b])
            forget_arrivals(swarms.arrivals[b])
            summarise_swarm(defaults, swarms, b, mean_weight)


@entry
def adopt_chosen(
    defaults: Parameters,
    swarms: Swarms,
    tables: Tables,
    chosen: Flags,
    sizes: Integers,
    parameters: Floats,
    mean_weight: float,
) -> None:
    """Begin the chosen swarms with their first positions as populations; arguments as of `begin_chosen`.

    It is apart from `begin_chosen` because few runs need it, and it is only compiled for those.
    """
    for b in range(sizes.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            clear(swarms, b)
            adopt(named_row(defaults, parameters, b), swarms, b, table, work, sizes[b])
            forget_arrivals(swarms.arrivals[b])
            summarise_swarm(defaults, swarms, b, mean_weight)


@entry
def step_chosen(
    defaults: Parameters,
    swarms: Swarms,
    tables: Tables,
    chosen: Flags,
    sizes: Integers,
    repair_degrees: Floats,
    parameters: Floats,
    mean_weight: float,
) -> None:
    """Resize the chosen swarms, advance them by one iteration and summarise them, one after the other.

    Immigrants replace members while a swarm is resized: it shrinks to those that stay, and grows again.

    The class of `defaults` chooses the kernels and names the columns of `parameters`, (B, number of them).
    """
    work = make_workspace(swarms.positions.shape[2], swarms.field.shape[1])
    for b in range(sizes.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            clear_workspace(work)
            own = named_row(defaults, parameters, b)
            begin_arrivals(swarms.arrivals[b], swarms.iteration[b])
            if swarms.source[b, IMMIGRANTS] > 0.0:
                change_size(own, swarms, b, table, work, num_staying(swarms, b, sizes[b]))
            change_size(own, swarms, b, table, work, sizes[b])
            iterate(own, swarms, b, table, work, repair_degrees[b])
            summarise_swarm(defaults, swarms, b, mean_weight)


@entry
def re_evaluate_chosen(
    defaults: Parameters, swarms: Swarms, tables: Tables, chosen: Flags, mean_weight: float
) -> None:
    """Evaluate the chosen swarms again, on problems that have changed, and summarise them.

    The class of `defaults` chooses the kernels, which need no parameters for this.
    """
    for b in range(chosen.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            re_evaluate(defaults, swarms, b, table, work)
            summarise_swarm(defaults, swarms, b, mean_weight)
