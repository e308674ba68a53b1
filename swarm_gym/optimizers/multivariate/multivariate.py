"""Multivariate optimization algorithm: a table of regions, each searched around its best point.

Source: Li et al., "A path planner based on multivariate optimization algorithm", Acta Electronica Sinica
44(9), 2016, called the MOA paper here. A global list holds the heads of n regions, best first; head i has a
list of the best n - i points (i from 0) found around it. An iteration draws n points anywhere, of which the
best become heads, and n - i points around each head. The lengths of the lists and the treatment of a list
whose head is displaced are readings, see docs/readings.md.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.multivariate.regions import (
    FIRST_LENGTH,
    HEAD,
    NUM_EXTRA,
    NUM_REGIONS,
    Regions,
    cut_regions,
    drop_worst,
    make_regions,
    num_extra,
    num_regions,
    offer_head,
    offer_local,
    promote,
    read_regions,
    sort_list,
    sort_regions,
    write_regions,
)
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
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
from swarm_gym.sources import draw_newcomer, note_arrival

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class MultivariateParameters(NamedTuple):
    """Parameters of the multivariate optimization algorithm."""

    radius: Annotated[
        float,
        Parameter(
            20.0, 0.0, 1e6, "r", "half the side of the cube around a head, in map units", (0.02, 200.0)
        ),
    ]


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
    """Draw points from the swarm's source; the best become heads of at most `limit` regions.

    Uniform points lie in the box [lower, upper], (C,) each.
    """
    source, stream = swarms.source[b], swarms.stream[b]
    for _ in range(draws):
        if is_spent(swarms, b):
            return
        smooth = draw_newcomer(source, stream, table, work.noise, work.path, lower, upper)
        best = swarms.best_fitness[b]
        fitness, collision = evaluate_path(swarms, b, table, work)
        note_arrival(swarms.arrivals[b], swarms.iteration[b], smooth, fitness, best)
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
    """Draw as many points around each head as its list can hold, then sort the regions."""
    count, path = regions.used[0], work.path
    for i in range(count):
        column = regions.order[i]
        centre = regions.position[column, HEAD]  # the head, until the list is full
        # A region that fell in rank keeps the best points of its list.
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
    parameters: MultivariateParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Draw the heads in the initial bounds, then the lists around them."""
    count = num_regions(size)
    regions = make_regions(count, swarms.positions.shape[2])
    draws = count + num_extra(size)
    _search_anywhere(regions, swarms, b, table, work, draws, count, table.initial_lower, table.initial_upper)
    _search_around(regions, swarms, b, table, work, 0.0, parameters.radius)
    write_regions(regions, swarms, b)


@kernel
def adopt(
    _parameters: MultivariateParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Make the best positions heads; put the others into the list of the nearest head with room, if any."""
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
            distance = ((regions.position[column, HEAD] - position) ** 2).sum()
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
    """Return the members by fitness, equals in order; NumPy's sort takes long to compile."""
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
    _parameters: MultivariateParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Add regions, whose heads are drawn between the present ones, or drop the worst regions.

    If the size is more than heads and full lists, the next iteration draws the difference anywhere.
    """
    count, before = num_regions(size), swarms.registers[b, NUM_REGIONS]
    swarms.registers[b, NUM_EXTRA] = num_extra(size)
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
    parameters: MultivariateParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration: draw points anywhere, without repair, then around the heads."""
    count = swarms.registers[b, NUM_REGIONS]
    regions = read_regions(swarms, b, count)
    draws = count + swarms.registers[b, NUM_EXTRA]
    _search_anywhere(regions, swarms, b, table, work, draws, count, table.lower, table.upper)
    _search_around(regions, swarms, b, table, work, repair_degree, parameters.radius)
    write_regions(regions, swarms, b)


@kernel
def re_evaluate(
    _parameters: MultivariateParameters, swarms: Swarms, b: int, table: Table, work: Workspace
) -> None:
    """Evaluate heads and lists again, sort the lists, exchange heads for better points, sort the regions."""
    best = swarms.best_position[b].copy()
    re_evaluate_members(swarms, b, table, work)
    cut_regions(swarms, b)
    regions = read_regions(swarms, b, swarms.registers[b, NUM_REGIONS])
    for column in range(regions.used[0]):
        length = regions.length[column]
        sort_list(regions, column)
        promote(regions, column, length)
    sort_regions(regions)
    write_regions(regions, swarms, b)
    recall(swarms, b, table, work, best)


class Multivariate(Optimizer):
    """MOA with the radius printed in its paper; 65 members are 10 regions.

    The radius suits maps of some hundred map units; on other maps, use 0.075 of the longer side.
    """

    name = "multivariate"
    smallest_population = 2
    parameter_class = MultivariateParameters
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def num_registers(capacity: int) -> int:
        """Return the number of registers; see `regions`."""
        return FIRST_LENGTH + num_regions(capacity) + 1
