"""The compiled calls of an optimizer: many swarms begun, or resized and advanced by one iteration.

What is the same for all optimizers is written here once, and compiled for each of them: its `Rules`, a
NamedTuple without content, stands for its kernels, which `Optimizer` enters below.
"""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import kernel, kernel_by_class, parallel_kernel
from swarm_gym.population import (
    Swarms,
    Workspace,
    add_members,
    adopt_members,
    clear,
    make_workspace,
    resize,
    summarise,
)
from swarm_gym.problem.tables import Table, select

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Kernels = dict[type, Callable[..., Any]]


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


BEGIN: Kernels = {}
ADOPT: Kernels = {}
RESIZE: Kernels = {}
ITERATE: Kernels = {}

# Of one swarm, each like the kernel above that is the same for most optimizers:
begin = kernel_by_class(BEGIN)
adopt = kernel_by_class(ADOPT)
change_size = kernel_by_class(RESIZE)
# iterate(rules, swarms, b, table, work, repair_degree, knobs): the moves, repairs and evaluations of an
# iteration; it ends early where the evaluation budget is spent.
iterate = kernel_by_class(ITERATE)


@kernel
def step_swarm(
    rules: Any,
    swarms: Swarms,
    b: int,
    tables: Table,
    size: int,
    repair_degree: float,
    knobs: Floats,
    mean_weight: float,
) -> None:
    """Resize swarm `b`, advance it by one iteration and summarise it."""
    table = select(tables, swarms.problem[b])
    work = make_workspace(swarms.positions.shape[2])
    change_size(rules, swarms, b, table, work, size)
    iterate(rules, swarms, b, table, work, repair_degree, knobs)
    summarise(swarms, b, mean_weight)


@kernel
def begin_serial(
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


@kernel
def step_serial(
    rules: Any,
    swarms: Swarms,
    tables: Table,
    chosen: Flags,
    sizes: Integers,
    repair_degrees: Floats,
    knobs: Floats,
    mean_weight: float,
) -> None:
    """`step_swarm` for the chosen swarms, one after the other."""
    for b in range(sizes.shape[0]):
        if chosen[b]:
            step_swarm(rules, swarms, b, tables, sizes[b], repair_degrees[b], knobs[b], mean_weight)


@parallel_kernel
def step_parallel(
    rules: Any,
    swarms: Swarms,
    tables: Table,
    chosen: Flags,
    sizes: Integers,
    repair_degrees: Floats,
    knobs: Floats,
    mean_weight: float,
) -> None:
    """`step_swarm` for the chosen swarms, spread over threads."""
    for b in numba.prange(sizes.shape[0]):
        if chosen[b]:
            step_swarm(rules, swarms, b, tables, sizes[b], repair_degrees[b], knobs[b], mean_weight)
