"""How one ant walks over a grid: from cell to free neighbouring cell, and back out of dead ends.

Source: M. Dorigo, T. Stuetzle, "Ant Colony Optimization", MIT Press 2004, eq. 3.1 (choice of a move). What an ant
does on a grid where it can go no further is a reading, see docs/readings.md.

An ant sees how near to the target a cell is, and knows where it has been. Both are remembered for each cell in an
array of numbers, `places`: a head of `NUM_COMMON`, then for each cell, row by row, the last ant that was there and
its weight by sight, 0 where nobody has looked yet. Zeros are `places` that nobody has been to.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel, inner_kernel
from swarm_gym.optimizers.trails import NUM_MOVES, STEP_COLUMNS, STEP_ROWS, trail, untouched, update_cell
from swarm_gym.problem.walks import WalkTable, to_cells
from swarm_gym.random_stream import fill_uniform

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Added to distances in cells, so that the target has a weight too.
NEAREST = 0.5
# Steps forward or back that an ant takes at most, in widths and heights of the map.
PATIENCE = 4

# In the head: how many ants there have been, and what weights by sight depend on.
NUM_COMMON = 5
_ANTS, _SIGHT_WEIGHT, _TARGET_COLUMN, _TARGET_ROW, _WIDTH = range(NUM_COMMON)
_PER_CELL = 2


class Ants(NamedTuple):
    """What the ants of a swarm share."""

    trails: Floats  # see `trails`
    places: Floats  # see above
    noise: Floats  # (8,) random numbers
    running_sums: Floats  # (8,) of the weights of the moves that are allowed
    allowed: Integers  # (8,) which these are


@inner_kernel
def places_size(num_cells: int) -> int:
    """How many numbers are remembered of so many cells."""
    return NUM_COMMON + _PER_CELL * num_cells


@inlined_kernel
def most_steps(table: WalkTable) -> int:
    """How many steps an ant takes at most."""
    return PATIENCE * (table.num_columns + table.num_rows)


@inlined_kernel
def cell_at(table: WalkTable, x: float, y: float) -> tuple[int, int]:
    """Column and row of the cell that a point on the map, in map units, lies in."""
    column, row = to_cells(table, x, y)
    return int(np.floor(column + 0.5)), int(np.floor(row + 0.5))


@inner_kernel
def look_at(places: Floats, table: WalkTable, sight_weight: float) -> None:
    """Forget weights by sight that were of another target, map or exponent."""
    column, row = cell_at(table, table.target[0], table.target[1])
    if (
        places[_SIGHT_WEIGHT] != sight_weight
        or places[_TARGET_COLUMN] != column
        or places[_TARGET_ROW] != row
        or places[_WIDTH] != table.num_columns
    ):
        if places[_WIDTH] > 0.0:
            for place in range(NUM_COMMON + 1, places.shape[0], _PER_CELL):
                places[place] = 0.0
        places[_SIGHT_WEIGHT] = sight_weight
        places[_TARGET_COLUMN] = column
        places[_TARGET_ROW] = row
        places[_WIDTH] = table.num_columns


@inlined_kernel
def _weight_by_sight(places: Floats, place: int, column: int, row: int) -> float:
    """(1 / (eps + distance to the target in cells))^beta, of the cell at that place."""
    if places[place + 1] == 0.0:
        distance = np.hypot(column - places[_TARGET_COLUMN], row - places[_TARGET_ROW])
        places[place + 1] = (1.0 / (NEAREST + distance)) ** places[_SIGHT_WEIGHT]
    return places[place + 1]


@inlined_kernel
def _weigh_moves(ants: Ants, table: WalkTable, column: int, row: int, trail_weight: float) -> int:
    """Find the moves that are allowed from a cell and sum up their weights; how many there are."""
    trails, places, blocked = ants.trails, ants.places, table.blocked
    width, height, ant = table.num_columns, table.num_rows, places[_ANTS]
    cell = row * width + column
    touched = update_cell(trails, cell)
    count, total = 0, 0.0
    for k in range(NUM_MOVES):
        to_column, to_row = column + STEP_COLUMNS[k], row + STEP_ROWS[k]
        if not (0 <= to_column < width and 0 <= to_row < height) or blocked[to_row, to_column]:
            continue
        if k % 2 == 1 and (blocked[row, to_column] or blocked[to_row, column]):
            continue
        place = NUM_COMMON + _PER_CELL * (to_row * width + to_column)
        if places[place] == ant:
            continue
        tau = trail(trails, cell, k) if touched else untouched(trails)
        if trail_weight != 1.0:
            tau = tau**trail_weight
        total += tau * _weight_by_sight(places, place, to_column, to_row)
        ants.running_sums[count] = total
        ants.allowed[count] = k
        count += 1
    return count


@inner_kernel
def walk(
    ants: Ants,
    table: WalkTable,
    stream: NDArray[np.uint64],
    cells: NDArray[np.int32],
    first: int,
    trail_weight: float,
) -> tuple[int, bool]:
    """Let an ant walk from the start, and write columns and rows of its way into `cells`, from `first` on.

    Returns:
        Of how many cells its way is, and whether it ends in the target's.
    """
    places, noise, sums = ants.places, ants.noise, ants.running_sums
    column, row = cell_at(table, table.start[0], table.start[1])
    target_column, target_row = cell_at(table, table.target[0], table.target[1])
    places[_ANTS] += 1.0
    places[NUM_COMMON + _PER_CELL * (row * table.num_columns + column)] = places[_ANTS]
    cells[first, 0], cells[first, 1] = column, row
    length, drawn = 1, noise.shape[0]
    for _ in range(most_steps(table)):
        if column == target_column and row == target_row:
            break
        count = _weigh_moves(ants, table, column, row, trail_weight)
        if count == 0:
            if length == 1:
                break
            length -= 1
            column, row = cells[first + length - 1, 0], cells[first + length - 1, 1]
            continue
        if drawn == noise.shape[0]:
            fill_uniform(stream, noise)
            drawn = 0
        drop = noise[drawn] * sums[count - 1]  # eq. 3.1
        drawn += 1
        choice = 0
        while choice < count - 1 and sums[choice] <= drop:
            choice += 1
        column += STEP_COLUMNS[ants.allowed[choice]]
        row += STEP_ROWS[ants.allowed[choice]]
        places[NUM_COMMON + _PER_CELL * (row * table.num_columns + column)] = places[_ANTS]
        cells[first + length, 0], cells[first + length, 1] = column, row
        length += 1
    return length, column == target_column and row == target_row
