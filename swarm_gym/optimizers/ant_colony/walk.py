"""How one ant walks over a grid: from cell to free neighbouring cell, and back out of dead ends.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, eq. 4 (choice of a move), with 1 / (eps + distance to the
target) as the visibility. What is done on grids beyond this, and the exponent beta, are readings, see
docs/readings.md.

An ant sees how far a cell is from the target, and knows where it has been. Both are remembered for each cell
in an array of numbers, `places`: a head of `NUM_COMMON`, then for each cell, row by row, when an ant was
there last, and ln(eps + distance to the target in cells), or 0 where nobody has looked yet. Zeros are
`places` of a map that nobody has been to. Time is counted in cells: an ant has as many moments of its own as
its way can have.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers.ant_colony.trails import NUM_MOVES, STEP_COLUMNS, STEP_ROWS, current_trails
from swarm_gym.problem.walk.table import WalkTable, cell_of

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Cells = NDArray[np.int32]
Flags = NDArray[np.bool_]

# eps, added to distances in cells: the target has no infinite weight.
NEAREST = 0.5
# Steps forward or back that an ant takes at most, in widths and heights of the map.
PATIENCE = 4

# In the head: the last moment before the ant that walks, what distances are of, and how ants decide.
NUM_COMMON = 6
_BEFORE, _TARGET_COLUMN, _TARGET_ROW, _WIDTH, _TRAIL_WEIGHT, _SIGHT_WEIGHT = range(NUM_COMMON)
_PER_CELL = 2


class Ants(NamedTuple):
    """What the ants of a swarm share."""

    trails: Floats  # see `trails`
    places: Floats  # see above
    noise: Floats  # (8,) random numbers
    allowed: Integers  # (8,) moves from where an ant is
    farness: Floats  # (8,) ln(eps + distance) of where they lead to
    weights: Floats  # (8,) of them, then their running sums


@kernel
def make_ants(trails: Floats, places: Floats, noise: Floats) -> Ants:
    """Ants that know these trails and places."""
    return Ants(
        trails, places, noise, np.empty(NUM_MOVES, np.int64), np.empty(NUM_MOVES), np.empty(NUM_MOVES)
    )


@kernel
def places_size(num_cells: int) -> int:
    """How many numbers are remembered of so many cells."""
    return NUM_COMMON + _PER_CELL * num_cells


@kernel(inline="late")
def most_steps(table: WalkTable) -> int:
    """How many steps an ant takes at most."""
    return PATIENCE * (table.num_columns + table.num_rows)


@kernel
def set_weights(places: Floats, trail_weight: float, sight_weight: float) -> None:
    """Let ants decide by these from now on: alpha, and beta for each cell of the straight line."""
    places[_TRAIL_WEIGHT], places[_SIGHT_WEIGHT] = trail_weight, sight_weight


@kernel
def learn_map(places: Floats, table: WalkTable) -> None:
    """Forget distances that were to another target, or on a map of another width."""
    column, row = cell_of(table, table.target[0], table.target[1])
    width = table.num_columns
    if places[_TARGET_COLUMN] == column and places[_TARGET_ROW] == row and places[_WIDTH] == width:
        return
    if places[_WIDTH] > 0.0:
        for place in range(NUM_COMMON + 1, places.shape[0], _PER_CELL):
            places[place] = 0.0
    places[_TARGET_COLUMN], places[_TARGET_ROW], places[_WIDTH] = column, row, width


@kernel(inline="late")
def _is_allowed(blocked: Flags, column: int, row: int, move: int) -> bool:
    """Whether a move leads to a free cell on the map, and past no corner of a blocked one."""
    to_column, to_row = column + STEP_COLUMNS[move], row + STEP_ROWS[move]
    if not (0 <= to_column < blocked.shape[1] and 0 <= to_row < blocked.shape[0]):
        return False
    if blocked[to_row, to_column]:
        return False
    return move % 2 == 0 or not (blocked[row, to_column] or blocked[to_row, column])


@kernel(inline="late")
def _first_above(sums: Floats, value: float, count: int) -> int:
    """The first of the sums that exceeds a value, else the last one."""
    k = 0
    while k < count - 1 and sums[k] <= value:
        k += 1
    return k


@kernel
def walk(
    ants: Ants,
    table: WalkTable,
    stream: NDArray[np.uint64],
    cells: Cells,
    first: int,
) -> tuple[int, bool]:
    """Let an ant walk from the start, and write columns and rows of its way into `cells`, from `first` on.

    Returns:
        Of how many cells its way is, and whether it ends in the target's.
    """
    # No NamedTuples in the loop: their arrays would be counted at every step.
    blocked, trails, places, noise = table.blocked, ants.trails, ants.places, ants.noise
    allowed, farness, weights = ants.allowed, ants.farness, ants.weights
    width, before, trail_weight = blocked.shape[1], places[_BEFORE], places[_TRAIL_WEIGHT]
    column, row = cell_of(table, table.start[0], table.start[1])
    end_column, end_row = cell_of(table, table.target[0], table.target[1])
    exponent = places[_SIGHT_WEIGHT] * math.hypot(end_column - column, end_row - row)  # beta
    places[NUM_COMMON + _PER_CELL * (row * width + column)] = before + 1.0
    cells[first, 0], cells[first, 1] = column, row
    length, drawn = 1, noise.shape[0]
    for _ in range(most_steps(table)):
        if column == end_column and row == end_row:
            break
        count, least = 0, math.inf
        for move in range(NUM_MOVES):
            if not _is_allowed(blocked, column, row, move):
                continue
            to_column, to_row = column + STEP_COLUMNS[move], row + STEP_ROWS[move]
            place = NUM_COMMON + _PER_CELL * (to_row * width + to_column)
            if places[place] > before:
                continue
            if places[place + 1] == 0.0:
                distance = math.hypot(to_column - end_column, to_row - end_row)
                places[place + 1] = math.log(NEAREST + distance)
            allowed[count], farness[count] = move, places[place + 1]
            least = min(least, farness[count])
            count += 1
        if count == 0:
            if length == 1:
                break
            length -= 1
            column, row = cells[first + length - 1, 0], cells[first + length - 1, 1]
            continue
        tau = current_trails(trails, row * width + column)
        for k in range(count):
            weights[k] = trails[tau + allowed[k]]
        if trail_weight != 1.0:
            for k in range(count):
                weights[k] = weights[k] ** trail_weight
        # Eq. 4, visibilities in units of the largest: their powers neither overflow nor vanish all together.
        total = 0.0
        for k in range(count):
            total += weights[k] * math.exp(exponent * (least - farness[k]))
            weights[k] = total
        if drawn == noise.shape[0]:
            fill_uniform(stream, noise)
            drawn = 0
        move = allowed[_first_above(weights, float(noise[drawn] * total), count)]
        drawn += 1
        column, row = column + STEP_COLUMNS[move], row + STEP_ROWS[move]
        places[NUM_COMMON + _PER_CELL * (row * width + column)] = before + 1.0
        cells[first + length, 0], cells[first + length, 1] = column, row
        length += 1
    length = _cut_loops(places, blocked, cells, first, length)
    places[_BEFORE] += most_steps(table) + 1
    return length, column == end_column and row == end_row


@kernel
def _cut_loops(places: Floats, blocked: Flags, cells: Cells, first: int, length: int) -> int:
    """Go on from each cell to the last one of the way that is next to it; how many cells are left."""
    # Until here all cells had the first moment of this ant; those that it left again still do.
    width, start = blocked.shape[1], places[_BEFORE] + 1.0
    for k in range(length):
        place = NUM_COMMON + _PER_CELL * (cells[first + k, 1] * width + cells[first + k, 0])
        places[place] = start + k
    k, kept = 0, 1
    while k < length - 1:
        column, row = cells[first + kept - 1, 0], cells[first + kept - 1, 1]
        for move in range(NUM_MOVES):
            if _is_allowed(blocked, column, row, move):
                cell = (row + STEP_ROWS[move]) * width + column + STEP_COLUMNS[move]
                k = max(k, int(places[NUM_COMMON + _PER_CELL * cell] - start))
        cells[first + kept, 0], cells[first + kept, 1] = cells[first + k, 0], cells[first + k, 1]
        kept += 1
    return kept
