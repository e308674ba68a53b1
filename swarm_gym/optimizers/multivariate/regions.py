"""The table of regions of the multivariate optimization algorithm.

A region is a head, its best point, and a list of the best points around it. In `Swarms`, the first n members
are the heads of n regions, best first; their lists follow, one after the other. The registers hold n, the
lengths of the lists, and last the number of extra points that the next iteration draws.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.population import Swarms, copy_position, outlives

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


# Registers: the number of regions, the length of the first list, and `num_extra`.
NUM_REGIONS, FIRST_LENGTH, NUM_EXTRA = 0, 1, -1
# Entries of a column: the head of a region, and the best point of its list.
HEAD, BEST_OF_LIST = 0, 1


class Regions(NamedTuple):
    """The table of up to N regions, outside the swarm; a column is a head and its list.

    Entry `HEAD` of a column is the head, entries 1 to `length` are its list, best first.
    """

    position: Floats  # (N, N + 1, C)
    fitness: Floats  # (N, N + 1)
    collision: Floats  # (N, N + 1)
    length: Integers  # (N,) lengths of the lists
    used: Integers  # (1,) number of columns in use
    order: Integers  # (N,) numbers of the columns, best head first
    former: Floats  # (C,) scratch: a head that becomes part of its list


@kernel
def num_regions(size: int) -> int:
    """Return n, the most regions whose heads and full lists are at most `size` members, but at least one."""
    return max(int((math.sqrt(9.0 + 8.0 * size) - 3.0) / 2.0), 1)


@kernel
def num_extra(size: int) -> int:
    """Return by how much `size` exceeds heads and full lists, the number of extra points to draw."""
    count = num_regions(size)
    return max(size - count * (count + 3) // 2, 0)


@kernel
def make_regions(num_columns: int, width: int) -> Regions:
    """Return an empty table with room for this number of regions, of positions with C = `width` columns."""
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
    """Return the table of swarm `b`, with room for this number of regions."""
    regions = make_regions(num_columns, swarms.positions.shape[2])
    registers = swarms.registers[b]
    regions.used[0] = registers[NUM_REGIONS]
    row = registers[NUM_REGIONS]
    for i in range(registers[NUM_REGIONS]):
        regions.order[i] = i
        regions.length[i] = registers[FIRST_LENGTH + i]
        _copy_in(regions, i, HEAD, swarms, b, i)
        for k in range(registers[FIRST_LENGTH + i]):
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
    """Write the table back: heads in order, then the lists, each cut to the most points of its rank."""
    count, row = regions.used[0], regions.used[0]
    registers = swarms.registers[b]
    registers[NUM_REGIONS] = count
    for i in range(count):
        column = regions.order[i]
        registers[FIRST_LENGTH + i] = min(regions.length[column], count - i)
        _copy_out(regions, column, HEAD, swarms, b, i)
        for k in range(registers[FIRST_LENGTH + i]):
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
    """Correct the registers of swarm `b` for the members that are left, after the last ones were deleted."""
    registers = swarms.registers[b]
    registers[NUM_REGIONS] = min(registers[NUM_REGIONS], swarms.size[b])
    left = swarms.size[b] - registers[NUM_REGIONS]
    for i in range(registers[NUM_REGIONS]):
        registers[FIRST_LENGTH + i] = min(registers[FIRST_LENGTH + i], left)
        left -= registers[FIRST_LENGTH + i]


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
    """Move the column at this place of the order ahead of all columns with worse heads."""
    order = regions.order
    column = order[place]
    while place > 0 and regions.fitness[column, HEAD] < regions.fitness[order[place - 1], HEAD]:
        order[place] = order[place - 1]
        place -= 1
    order[place] = column


@kernel(borrows=True)
def offer_head(regions: Regions, limit: int, position: Floats, fitness: float, collision: float) -> None:
    """Enter a point as the head of a region with an empty list, if it is among the best `limit` heads."""
    count, order = regions.used[0], regions.order
    if count == limit:
        if fitness >= regions.fitness[order[count - 1], HEAD]:
            return
    else:
        order[count] = count
        regions.used[0] = count = count + 1
    column = order[count - 1]
    _put(regions, column, HEAD, position, fitness, collision)
    regions.length[column] = 0
    _rank(regions, count - 1)


@kernel(borrows=True)
def offer_local(
    regions: Regions, column: int, limit: int, position: Floats, fitness: float, collision: float
) -> None:
    """Enter a point into a list if it is among the best `limit`, behind earlier points of equal fitness."""
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
    """Exchange the head and the best point of its list, if that is better."""
    if regions.length[column] == 0 or regions.fitness[column, BEST_OF_LIST] >= regions.fitness[column, HEAD]:
        return
    copy_position(regions.position[column, HEAD], regions.former)
    fitness, collision = regions.fitness[column, HEAD], regions.collision[column, HEAD]
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
            regions.fitness[here, HEAD],
            regions.collision[here, HEAD],
            regions.fitness[there, HEAD],
            regions.collision[there, HEAD],
        ):
            worst = i
    for i in range(worst, count - 1):
        order[i] = order[i + 1]
    regions.used[0] = count - 1
