"""Multivariate optimization algorithm: a table of regions, each searched around its best point.

Source: Li et al., "A path planner based on multivariate optimization algorithm", Acta Electronica Sinica
44(9), 2016. A global list holds the heads of n regions, best first; below head i hangs a list of the best
n - i points (i from 0) found around it. An iteration draws n points anywhere, of which the best become heads,
and n - i points around each head. The lengths of the lists and what becomes of a list whose head is displaced
are readings, see docs/readings.md.

In `Swarms`, the first n members are the heads; the lists follow, one after the other. The registers hold n,
then the lengths of the lists.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import kernel
from swarm_gym.optimizers import driver
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, adopt_members, evaluate_path, outlives, span
from swarm_gym.problem.tables import Table, repair
from swarm_gym.random_stream import fill_uniform

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class MultivariateRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


class Structure(NamedTuple):
    """The table of up to N regions, apart from the swarm; a column is a head and its list.

    Entry 0 of a column is the head, entries 1 to `length` are its list, best first.
    """

    position: Floats  # (N, N + 1, C)
    fitness: Floats  # (N, N + 1)
    collision: Floats  # (N, N + 1)
    length: Integers  # (N,) of the lists
    used: Integers  # (1,) columns in use
    order: Integers  # (N,) of the columns, best head first


@kernel
def num_regions(size: int) -> int:
    """n: the largest whose heads and full lists are no more than `size` members, but at least one."""
    return max(int((math.sqrt(9.0 + 8.0 * size) - 3.0) / 2.0), 1)


@kernel
def num_besides(size: int) -> int:
    """What `size` has beyond heads and full lists: members that are drawn anywhere besides."""
    count = num_regions(size)
    return max(size - count * (count + 3) // 2, 0)


@kernel
def _make(num_columns: int, width: int) -> Structure:
    shape = (num_columns, num_columns + 1)
    return Structure(
        np.zeros((num_columns, num_columns + 1, width)),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(num_columns, np.int64),
        np.zeros(1, np.int64),
        np.zeros(num_columns, np.int64),
    )


@kernel
def _unpack(swarms: Swarms, b: int, num_columns: int) -> Structure:
    """The table of swarm `b`, with room for that many regions."""
    structure = _make(num_columns, swarms.positions.shape[2])
    registers = swarms.registers[b]
    structure.used[0] = registers[0]
    row = registers[0]
    for i in range(registers[0]):
        structure.order[i] = i
        structure.length[i] = registers[1 + i]
        _copy_in(structure, i, 0, swarms, b, i)
        for k in range(registers[1 + i]):
            _copy_in(structure, i, 1 + k, swarms, b, row)
            row += 1
    return structure


@kernel
def _copy_in(structure: Structure, column: int, entry: int, swarms: Swarms, b: int, row: int) -> None:
    _put(structure, column, entry, swarms.positions[b, row], swarms.fitness[b, row], swarms.collision[b, row])


@kernel
def _put(
    structure: Structure, column: int, entry: int, position: Floats, fitness: float, collision: float
) -> None:
    structure.position[column, entry] = position
    structure.fitness[column, entry] = fitness
    structure.collision[column, entry] = collision


@kernel
def _pack(structure: Structure, swarms: Swarms, b: int) -> None:
    """Write the table back: heads in order, then the lists, cut to the lengths of their places."""
    count, row = structure.used[0], structure.used[0]
    registers = swarms.registers[b]
    registers[0] = count
    for i in range(count):
        column = structure.order[i]
        registers[1 + i] = min(structure.length[column], count - i)
        _copy_out(structure, column, 0, swarms, b, i)
        for k in range(registers[1 + i]):
            _copy_out(structure, column, 1 + k, swarms, b, row)
            row += 1
    swarms.size[b] = row


@kernel
def _copy_out(structure: Structure, column: int, entry: int, swarms: Swarms, b: int, row: int) -> None:
    swarms.positions[b, row] = structure.position[column, entry]
    swarms.fitness[b, row] = structure.fitness[column, entry]
    swarms.collision[b, row] = structure.collision[column, entry]


@kernel
def _sort(structure: Structure) -> None:
    """Order the columns by the fitness of their heads; equals keep their order."""
    for place in range(1, structure.used[0]):
        _rank(structure, place)


@kernel
def _rank(structure: Structure, place: int) -> None:
    """Move the column at that place of the order to the front of those with worse heads."""
    order = structure.order
    column = order[place]
    while place > 0 and structure.fitness[column, 0] < structure.fitness[order[place - 1], 0]:
        order[place] = order[place - 1]
        place -= 1
    order[place] = column


@kernel
def _offer_head(structure: Structure, limit: int, position: Floats, fitness: float, collision: float) -> None:
    """Enter a point as the head of a region without a list, where it is among the best `limit`."""
    count, order = structure.used[0], structure.order
    if count == limit:
        if fitness >= structure.fitness[order[count - 1], 0]:
            return
    else:
        order[count] = count
        structure.used[0] = count = count + 1
    column = order[count - 1]
    _put(structure, column, 0, position, fitness, collision)
    structure.length[column] = 0
    _rank(structure, count - 1)


@kernel
def _offer_local(
    structure: Structure, column: int, limit: int, position: Floats, fitness: float, collision: float
) -> None:
    """Enter a point into a list, where it is among the best `limit` of it; before equals that came later."""
    length = structure.length[column]
    if length == limit:
        if limit == 0 or fitness >= structure.fitness[column, length]:
            return
    else:
        structure.length[column] = length = length + 1
    entry = length
    while entry > 1 and fitness < structure.fitness[column, entry - 1]:
        _move_entry(structure, column, entry - 1, entry)
        entry -= 1
    _put(structure, column, entry, position, fitness, collision)


@kernel
def _move_entry(structure: Structure, column: int, source: int, target: int) -> None:
    _put(
        structure,
        column,
        target,
        structure.position[column, source],
        structure.fitness[column, source],
        structure.collision[column, source],
    )


@kernel
def _promote(structure: Structure, column: int, limit: int) -> None:
    """Where the best of a list is better than its head, let them change places."""
    if structure.length[column] == 0 or structure.fitness[column, 1] >= structure.fitness[column, 0]:
        return
    position = structure.position[column, 0].copy()
    fitness, collision = structure.fitness[column, 0], structure.collision[column, 0]
    for entry in range(structure.length[column]):
        _move_entry(structure, column, entry + 1, entry)
    structure.length[column] -= 1
    _offer_local(structure, column, limit, position, fitness, collision)


@kernel
def _search_anywhere(
    structure: Structure,
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
        if swarms.evaluations[b] >= swarms.budget[b]:
            return
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(lower.shape[0]):
            work.path[k + 1] = lower[k] + (upper[k] - lower[k]) * work.noise[k]
        fitness, collision = evaluate_path(swarms, b, table, work)
        _offer_head(structure, limit, work.path[1:], fitness, collision)


@kernel
def _search_around(
    structure: Structure,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    radius: float,
) -> None:
    """Draw as many points around each head as its list has places, then sort the regions."""
    count, path = structure.used[0], work.path
    for i in range(count):
        column = structure.order[i]
        centre = structure.position[column, 0].copy()
        # A region that fell back in rank keeps the best of its list.
        structure.length[column] = min(structure.length[column], count - i)
        for _ in range(count - i):
            if swarms.evaluations[b] >= swarms.budget[b]:
                break
            fill_uniform(swarms.stream[b], work.noise)
            for k in range(centre.shape[0]):
                near = centre[k] + radius * (2.0 * work.noise[k] - 1.0)
                path[k + 1] = min(max(near, table.lower[k]), table.upper[k])
            if repair_degree > 0.0:
                repair(table, path, repair_degree)
            fitness, collision = evaluate_path(swarms, b, table, work)
            _offer_local(structure, column, count - i, path[1:], fitness, collision)
        _promote(structure, column, count - i)
    _sort(structure)


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
    structure = _make(count, swarms.positions.shape[2])
    draws = count + num_besides(size)
    _search_anywhere(
        structure, swarms, b, table, work, draws, count, table.initial_lower, table.initial_upper
    )
    _search_around(structure, swarms, b, table, work, 0.0, knobs[0])
    _pack(structure, swarms, b)


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
    structure = _make(count, swarms.positions.shape[2])
    ranked = _ranked(swarms.fitness[b, :size])
    for row in ranked[:count]:
        _offer_head(
            structure, count, swarms.positions[b, row], swarms.fitness[b, row], swarms.collision[b, row]
        )
    for row in ranked[count:]:
        position = swarms.positions[b, row]
        nearest, least = -1, math.inf
        for i in range(structure.used[0]):
            column = structure.order[i]
            distance = ((structure.position[column, 0] - position) ** 2).sum()
            if structure.length[column] < count - i and distance < least:
                nearest, least = i, distance
        if nearest >= 0:
            _offer_local(
                structure,
                structure.order[nearest],
                count - nearest,
                position,
                swarms.fitness[b, row],
                swarms.collision[b, row],
            )
    _pack(structure, swarms, b)


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
    structure = _unpack(swarms, b, max(count, before))
    if count > before:
        lower, upper = span(swarms.positions[b], before, table)  # eq. 12 of the SPSFA paper
        _search_anywhere(structure, swarms, b, table, work, count - before, count, lower, upper)
    else:
        for _ in range(before - count):
            _drop_worst(structure)
    _pack(structure, swarms, b)


@kernel
def _drop_worst(structure: Structure) -> None:
    """Drop the region whose head `population.shrink` would delete first."""
    count, order = structure.used[0], structure.order
    worst = 0
    for i in range(1, count):
        here, there = order[i], order[worst]
        if not outlives(
            structure.fitness[here, 0],
            structure.collision[here, 0],
            structure.fitness[there, 0],
            structure.collision[there, 0],
        ):
            worst = i
    for i in range(worst, count - 1):
        order[i] = order[i + 1]
    structure.used[0] = count - 1


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
    structure = _unpack(swarms, b, count)
    draws = count + swarms.registers[b, -1]
    _search_anywhere(structure, swarms, b, table, work, draws, count, table.lower, table.upper)
    _search_around(structure, swarms, b, table, work, repair_degree, knobs[0])
    _pack(structure, swarms, b)


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
    kernels = driver.Kernels(iterate, begin, adopt, change_size)

    @staticmethod
    def num_registers(capacity: int) -> int:
        """The number of regions, the lengths of their lists, and points that are drawn besides."""
        return 2 + num_regions(capacity)
