"""The table of regions of the multivariate optimization algorithm.

A region is a head, its best point, and a list of the best points around it. In `Swarms`, the first n members
are the heads of n regions, best first; their lists follow, one after the other. The registers hold n, then
the lengths of the lists; the last one is left to the optimizer.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.population import Swarms, copy_position, outlives

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Regions(NamedTuple):
    """The table of up to N regions, apart from the swarm; a column is a head and its list.

    Entry 0 of a column is the head, entries 1 to `length` are its list, best first.
    """

    position: Floats  # (N, N + 1, C)
    fitness: Floats  # (N, N + 1)
    collision: Floats  # (N, N + 1)
    length: Integers  # (N,) of the lists
    used: Integers  # (1,) columns in use
    order: Integers  # (N,) of the columns, best head first
    former: Floats  # (C,) scratch: a head that becomes part of its list


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
def make_regions(num_columns: int, width: int) -> Regions:
    """An empty table with room for that many regions, of positions with C = `width` columns."""
    shape = (num_columns, num_columns + 1)
    return Regions(
        np.zeros((num_columns, num_columns + 1, width)),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(num_columns, np.int64),
        np.zeros(1, np.int64),
        np.zeros(num_columns, np.int64),
        np.zeros(width),
    )


@kernel
def read_regions(swarms: Swarms, b: int, num_columns: int) -> Regions:
    """The table of swarm `b`, with room for that many regions."""
    regions = make_regions(num_columns, swarms.positions.shape[2])
    registers = swarms.registers[b]
    regions.used[0] = registers[0]
    row = registers[0]
    for i in range(registers[0]):
        regions.order[i] = i
        regions.length[i] = registers[1 + i]
        _copy_in(regions, i, 0, swarms, b, i)
        for k in range(registers[1 + i]):
            _copy_in(regions, i, 1 + k, swarms, b, row)
            row += 1
    return regions


@kernel(borrows=True)
def _copy_in(regions: Regions, column: int, entry: int, swarms: Swarms, b: int, row: int) -> None:
    _put(regions, column, entry, swarms.positions[b, row], swarms.fitness[b, row], swarms.collision[b, row])


@kernel(borrows=True)
def _put(
    regions: Regions, column: int, entry: int, position: Floats, fitness: float, collision: float
) -> None:
    copy_position(position, regions.position[column, entry])
    regions.fitness[column, entry] = fitness
    regions.collision[column, entry] = collision


@kernel(borrows=True)
def write_regions(regions: Regions, swarms: Swarms, b: int) -> None:
    """Write the table back: heads in order, then the lists, cut to the lengths of their places."""
    count, row = regions.used[0], regions.used[0]
    registers = swarms.registers[b]
    registers[0] = count
    for i in range(count):
        column = regions.order[i]
        registers[1 + i] = min(regions.length[column], count - i)
        _copy_out(regions, column, 0, swarms, b, i)
        for k in range(registers[1 + i]):
            _copy_out(regions, column, 1 + k, swarms, b, row)
            row += 1
    swarms.size[b] = row


@kernel(borrows=True)
def _copy_out(regions: Regions, column: int, entry: int, swarms: Swarms, b: int, row: int) -> None:
    copy_position(regions.position[column, entry], swarms.positions[b, row])
    swarms.fitness[b, row] = regions.fitness[column, entry]
    swarms.collision[b, row] = regions.collision[column, entry]


@kernel
def cut_regions(swarms: Swarms, b: int) -> None:
    """Let the registers of swarm `b` speak of the members that are left, after the last ones were deleted."""
    registers = swarms.registers[b]
    registers[0] = min(registers[0], swarms.size[b])
    left = swarms.size[b] - registers[0]
    for i in range(registers[0]):
        registers[1 + i] = min(registers[1 + i], left)
        left -= registers[1 + i]


@kernel
def sort_list(regions: Regions, column: int) -> None:
    """Order a list by fitness; equals keep their order."""
    length = regions.length[column]
    regions.length[column] = 0
    for entry in range(1, length + 1):
        position = regions.position[column, entry].copy()
        fitness, collision = regions.fitness[column, entry], regions.collision[column, entry]
        offer_local(regions, column, length, position, fitness, collision)


@kernel(borrows=True)
def sort_regions(regions: Regions) -> None:
    """Order the columns by the fitness of their heads; equals keep their order."""
    for place in range(1, regions.used[0]):
        _rank(regions, place)


@kernel(borrows=True)
def _rank(regions: Regions, place: int) -> None:
    """Move the column at that place of the order ahead of all with worse heads."""
    order = regions.order
    column = order[place]
    while place > 0 and regions.fitness[column, 0] < regions.fitness[order[place - 1], 0]:
        order[place] = order[place - 1]
        place -= 1
    order[place] = column


@kernel(borrows=True)
def offer_head(regions: Regions, limit: int, position: Floats, fitness: float, collision: float) -> None:
    """Enter a point as the head of a region without a list, where it is among the best `limit`."""
    count, order = regions.used[0], regions.order
    if count == limit:
        if fitness >= regions.fitness[order[count - 1], 0]:
            return
    else:
        order[count] = count
        regions.used[0] = count = count + 1
    column = order[count - 1]
    _put(regions, column, 0, position, fitness, collision)
    regions.length[column] = 0
    _rank(regions, count - 1)


@kernel(borrows=True)
def offer_local(
    regions: Regions, column: int, limit: int, position: Floats, fitness: float, collision: float
) -> None:
    """Enter a point into a list, where it is among the best `limit` of it; before equals that came later."""
    length = regions.length[column]
    if length == limit:
        if limit == 0 or fitness >= regions.fitness[column, length]:
            return
    else:
        regions.length[column] = length = length + 1
    entry = length
    while entry > 1 and fitness < regions.fitness[column, entry - 1]:
        _move_entry(regions, column, entry - 1, entry)
        entry -= 1
    _put(regions, column, entry, position, fitness, collision)


@kernel(borrows=True)
def _move_entry(regions: Regions, column: int, source: int, target: int) -> None:
    _put(
        regions,
        column,
        target,
        regions.position[column, source],
        regions.fitness[column, source],
        regions.collision[column, source],
    )


@kernel(borrows=True)
def promote(regions: Regions, column: int, limit: int) -> None:
    """Where the best of a list is better than its head, let them change places."""
    if regions.length[column] == 0 or regions.fitness[column, 1] >= regions.fitness[column, 0]:
        return
    copy_position(regions.position[column, 0], regions.former)
    fitness, collision = regions.fitness[column, 0], regions.collision[column, 0]
    for entry in range(regions.length[column]):
        _move_entry(regions, column, entry + 1, entry)
    regions.length[column] -= 1
    offer_local(regions, column, limit, regions.former, fitness, collision)


@kernel(borrows=True)
def drop_worst(regions: Regions) -> None:
    """Drop the region whose head `population.shrink` would delete first."""
    count, order = regions.used[0], regions.order
    worst = 0
    for i in range(1, count):
        here, there = order[i], order[worst]
        if not outlives(
            regions.fitness[here, 0],
            regions.collision[here, 0],
            regions.fitness[there, 0],
            regions.collision[there, 0],
        ):
            worst = i
    for i in range(worst, count - 1):
        order[i] = order[i + 1]
    regions.used[0] = count - 1
