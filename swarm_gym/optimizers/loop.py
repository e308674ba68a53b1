"""The compiled calls of an optimizer: many swarms begun, or resized and advanced by one iteration.

What is the same for all optimizers is written here once, and compiled for each of them: its `Rules`, a
NamedTuple without content, stands for its `Kernels`, which `Optimizer` enters below.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel, kernel_by_class
from swarm_gym.population import (
    Swarms,
    Workspace,
    add_members,
    adopt_members,
    clear,
    make_workspace,
    re_evaluate_members,
    recall,
    resize,
    summarise,
)
from swarm_gym.problem.tables import Table, select

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


@kernel
def draw_population(
    rules: Any,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
    knobs: Floats,  # noqa: ARG001
) -> None:
    """Begin swarm `b`, which is empty, with members uniform in the initial bounds."""
    add_members(swarms, b, table, work, size, table.initial_lower, table.initial_upper)


@kernel
def resize_population(
    rules: Any,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Grow or shrink swarm `b`."""
    resize(swarms, b, table, work, size)


@kernel
def adopt_population(
    rules: Any,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Begin swarm `b`, which is empty, with the first `size` positions as they stand."""
    adopt_members(swarms, b, table, work, size)


@kernel
def re_evaluate_population(
    rules: Any,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
) -> None:
    """Evaluate anew, after the problem of swarm `b` has changed, its members and then the best so far."""
    best = swarms.best_position[b].copy()
    re_evaluate_members(swarms, b, table, work)
    recall(swarms, b, table, work, best)


class Kernels(NamedTuple):
    """What an optimizer does to one swarm.

    Attributes:
        iterate: (rules, swarms, b, table, work, repair_degree, knobs) the moves, repairs and evaluations of
            an iteration; it ends early where the evaluation budget is spent.
        begin: draws a first population, see `draw_population`.
        adopt: takes given positions as the first population, see `adopt_population`.
        change_size: grows or shrinks a population, see `resize_population`.
        re_evaluate: evaluates all that is remembered, members first, see `re_evaluate_population`; the budget
            suffices for one of them at least.
    """

    iterate: Callable[..., None]
    begin: Callable[..., None] = draw_population
    adopt: Callable[..., None] = adopt_population
    change_size: Callable[..., None] = resize_population
    re_evaluate: Callable[..., None] = re_evaluate_population


_BY_RULES: dict[str, dict[type, Callable[..., None]]] = {name: {} for name in Kernels._fields}

iterate, begin, adopt, change_size, re_evaluate = (
    kernel_by_class(_BY_RULES[name]) for name in Kernels._fields
)


def enter(rules: type, kernels: Kernels) -> None:
    """Let `rules` stand for these kernels.

    Its name must be its own, since Numba tells NamedTuples apart by their names.
    """
    taken = {other.__name__ for other in _BY_RULES["iterate"]}
    assert rules.__name__ not in taken, f"optimizers need rules of their own, got {rules} again"
    for name, own in kernels._asdict().items():
        _BY_RULES[name][rules] = own


@entry
def begin_chosen(
    rules: Any,
    swarms: Swarms,
    tables: Table,
    chosen: Flags,
    sizes: Integers,
    knobs: Floats,
    given: bool,
    mean_weight: float,
) -> None:
    """Begin the chosen swarms: draw first populations, or take their positions where these are given."""
    for b in range(sizes.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            clear(swarms, b)
            if given:
                adopt(rules, swarms, b, table, work, sizes[b])
            else:
                begin(rules, swarms, b, table, work, sizes[b], knobs[b])
            summarise(swarms, b, mean_weight)


@entry
def step_chosen(
    rules: Any,
    swarms: Swarms,
    tables: Table,
    chosen: Flags,
    sizes: Integers,
    repair_degrees: Floats,
    knobs: Floats,
    mean_weight: float,
) -> None:
    """Resize the chosen swarms, advance them by one iteration and summarise them, one after the other."""
    for b in range(sizes.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            change_size(rules, swarms, b, table, work, sizes[b])
            iterate(rules, swarms, b, table, work, repair_degrees[b], knobs[b])
            summarise(swarms, b, mean_weight)


@entry
def re_evaluate_chosen(rules: Any, swarms: Swarms, tables: Table, chosen: Flags, mean_weight: float) -> None:
    """Evaluate the chosen swarms anew, on problems that have changed, and summarise them."""
    for b in range(chosen.shape[0]):
        if chosen[b]:
            table = select(tables, swarms.problem[b])
            work = make_workspace(swarms.positions.shape[2])
            re_evaluate(rules, swarms, b, table, work)
            summarise(swarms, b, mean_weight)
