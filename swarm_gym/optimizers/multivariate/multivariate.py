"""Multivariate optimization algorithm: a table of regions, each searched around its best point.

Source: Li et al., "A path planner based on multivariate optimization algorithm", Acta Electronica Sinica
44(9), 2016. A global list holds the heads of n regions, best first; below head i hangs a list of the best
n - i points (i from 0) found around it. An iteration draws n points anywhere, of which the best become heads,
and n - i points around each head. The lengths of the lists and what becomes of a list whose head is displaced
are readings, see docs/readings.md.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.multivariate.regions import (
    Regions,
    cut_regions,
    drop_worst,
    make_regions,
    num_besides,
    num_regions,
    offer_head,
    offer_local,
    promote,
    read_regions,
    sort_list,
    sort_regions,
    write_regions,
)
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import (
    Swarms,
    Workspace,
    adopt_members,
    evaluate_path,
    is_spent,
    re_evaluate_members,
    recall,
    span,
)
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class MultivariateRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@kernel(borrows=True)
def _search_anywhere(
    regions: Regions,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    draws: int,
    limit: int,
    lower: Floats,
    upper: Floats,
) -> None:
    """Draw points uniform in [lower, upper], (C,), as heads of the best `limit` regions."""
    for _ in range(draws):
        if is_spent(swarms, b):
            return
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(lower.shape[0]):
            work.path[k + 1] = lower[k] + (upper[k] - lower[k]) * work.noise[k]
        fitness, collision = evaluate_path(swarms, b, table, work)
        offer_head(regions, limit, work.path[1:], fitness, collision)


@kernel(borrows=True)
def _search_around(
    regions: Regions,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    radius: float,
) -> None:
    """Draw as many points around each head as its list has places, then sort the regions."""
    count, path = regions.used[0], work.path
    for i in range(count):
        column = regions.order[i]
        centre = regions.position[column, 0]  # it stays the head until the list is full
        # A region that fell back in rank keeps the best of its list.
        regions.length[column] = min(regions.length[column], count - i)
        for _ in range(count - i):
            if is_spent(swarms, b):
                break
            fill_uniform(swarms.stream[b], work.noise)
            for k in range(centre.shape[0]):
                near = centre[k] + radius * (2.0 * work.noise[k] - 1.0)
                path[k + 1] = min(max(near, table.lower[k]), table.upper[k])
            if repair_degree > 0.0:
                repair(table, path, repair_degree)
            fitness, collision = evaluate_path(swarms, b, table, work)
            offer_local(regions, column, count - i, path[1:], fitness, collision)
        promote(regions, column, count - i)
    sort_regions(regions)


@kernel
def begin(
    rules: MultivariateRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
    knobs: Floats,
) -> None:
    """Draw the heads in the initial bounds, and lists around them."""
    count = num_regions(size)
    regions = make_regions(count, swarms.positions.shape[2])
    draws = count + num_besides(size)
    _search_anywhere(regions, swarms, b, table, work, draws, count, table.initial_lower, table.initial_upper)
    _search_around(regions, swarms, b, table, work, 0.0, knobs[0])
    write_regions(regions, swarms, b)


@kernel
def adopt(
    rules: MultivariateRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Make the best positions heads; the others enter the list of the nearest head that has room, if any."""
    adopt_members(swarms, b, table, work, size)
    count = num_regions(size)
    regions = make_regions(count, swarms.positions.shape[2])
    ranked = _ranked(swarms.fitness[b, :size])
    for row in ranked[:count]:
        offer_head(regions, count, swarms.positions[b, row], swarms.fitness[b, row], swarms.collision[b, row])
    for row in ranked[count:]:
        position = swarms.positions[b, row]
        nearest, least = -1, math.inf
        for i in range(regions.used[0]):
            column = regions.order[i]
            distance = ((regions.position[column, 0] - position) ** 2).sum()
            if regions.length[column] < count - i and distance < least:
                nearest, least = i, distance
        if nearest >= 0:
            offer_local(
                regions,
                regions.order[nearest],
                count - nearest,
                position,
                swarms.fitness[b, row],
                swarms.collision[b, row],
            )
    write_regions(regions, swarms, b)


@kernel
def _ranked(fitness: Floats) -> Integers:
    """Members by fitness, equals in order; NumPy's sort would take longer to compile than the rest to run."""
    ranked = np.zeros(fitness.shape[0], np.int64)
    for i in range(fitness.shape[0]):
        k = i
        while k > 0 and fitness[i] < fitness[ranked[k - 1]]:
            ranked[k] = ranked[k - 1]
            k -= 1
        ranked[k] = i
    return ranked


@kernel
def change_size(
    rules: MultivariateRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Add regions, whose heads are drawn between the present ones, or drop the worst.

    What the asked size has beyond heads and full lists is drawn anywhere in the next iteration.
    """
    count, before = num_regions(size), swarms.registers[b, 0]
    swarms.registers[b, -1] = num_besides(size)
    if count == before:
        return
    regions = read_regions(swarms, b, max(count, before))
    if count > before:
        lower, upper = span(swarms.positions[b], before, table)  # eq. 12 of the SPSFA paper
        _search_anywhere(regions, swarms, b, table, work, count - before, count, lower, upper)
    else:
        for _ in range(before - count):
            drop_worst(regions)
    write_regions(regions, swarms, b)


@kernel
def iterate(
    rules: MultivariateRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`: points anywhere, which are not repaired, then points around the heads."""
    count = swarms.registers[b, 0]
    regions = read_regions(swarms, b, count)
    draws = count + swarms.registers[b, -1]
    _search_anywhere(regions, swarms, b, table, work, draws, count, table.lower, table.upper)
    _search_around(regions, swarms, b, table, work, repair_degree, knobs[0])
    write_regions(regions, swarms, b)


@kernel
def re_evaluate(
    rules: MultivariateRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
) -> None:
    """Evaluate heads and lists anew; sort the lists, make better ones of them heads, sort the regions."""
    best = swarms.best_position[b].copy()
    re_evaluate_members(swarms, b, table, work)
    cut_regions(swarms, b)
    regions = read_regions(swarms, b, swarms.registers[b, 0])
    for column in range(regions.used[0]):
        length = regions.length[column]
        sort_list(regions, column)
        promote(regions, column, length)
    sort_regions(regions)
    write_regions(regions, swarms, b)
    recall(swarms, b, table, work, best)


class Multivariate(Optimizer):
    """MOA with the radius printed in its paper; 65 members are 10 regions.

    The radius suits maps of some hundred map units; 0.075 of the longer side is the same for others.
    """

    name = "multivariate"
    smallest_population = 2
    knobs: ClassVar[dict[str, Knob]] = {
        "radius": Knob(
            20.0, 0.0, 1e6, "r", "half the side of the cube around a head, in map units", (0.02, 200.0)
        ),
    }
    rules = MultivariateRules
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def num_registers(capacity: int) -> int:
        """The number of regions, the lengths of their lists, and points that are drawn besides."""
        return 2 + num_regions(capacity)
