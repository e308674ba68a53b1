"""The walk of one ant over a grid: from cell to free neighbouring cell, and back out of dead ends.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, eq. 4 (choice of a move), with 1 / (eps + distance to the
target) as the visibility. All other rules on grids, and the exponent beta, are readings, see
docs/readings.md.

An ant sees the distance of a cell from the target, and knows the cells that it has visited. Both are stored
for each cell in an array of numbers, `places`: a head of `NUM_COMMON`, then for each cell, row by row, the
time of the last visit, and ln(eps + distance to the target in cells), or 0 if that is not computed yet. An
array of zeros is `places` of a map without visits. Time is counted in cells: an ant has as many moments of
its own as its walk can have cells.
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

# eps, added to distances in cells, so that the weight of the target is finite.
NEAREST = 0.5
# Most steps, forward or back, of an ant, as a multiple of the map's width + height.
STEP_LIMIT = 4

# Entries of the head: the last moment before the present ant; the target's cell and the map's width for which
# distances are stored; alpha and beta.
NUM_COMMON = 6
_BEFORE, _TARGET_COLUMN, _TARGET_ROW, _WIDTH, _TRAIL_WEIGHT, _SIGHT_WEIGHT = range(NUM_COMMON)
# Entries of a cell: the last visit, and the logarithm of its distance.
_PER_CELL = 2
_VISIT, _FARNESS = range(_PER_CELL)


class Ants(NamedTuple):
    """The arrays that the ants of a swarm share."""

    trails: Floats  # see `trails`
    places: Floats  # visits and distances of the cells, see the head of this module
    noise: Floats  # (8,) random numbers
    allowed: Integers  # (8,) moves that are allowed from the cell of an ant
    farness: Floats  # (8,) ln(eps + distance) of the cells to which they lead
    weights: Floats  # (8,) weights of these moves, then their running sums


@kernel
def make_ants(trails: Floats, places: Floats, noise: Floats) -> Ants:
    """Return ants that know these trails and places."""
    return Ants(
        trails, places, noise, np.empty(NUM_MOVES, np.int64), np.empty(NUM_MOVES), np.empty(NUM_MOVES)
    )


@kernel
def places_size(num_cells: int) -> int:
    """Return the length of `places` for this number of cells."""
    return NUM_COMMON + _PER_CELL * num_cells


@kernel(inline="late")
def most_steps(table: WalkTable) -> int:
    """Return the most steps that an ant takes."""
    return STEP_LIMIT * (table.num_columns + table.num_rows)


@kernel
def set_weights(places: Floats, trail_weight: float, sight_weight: float) -> None:
    """Set the exponents by which ants choose moves: alpha, and beta per cell of the straight line."""
    places[_TRAIL_WEIGHT], places[_SIGHT_WEIGHT] = trail_weight, sight_weight


@kernel
def learn_map(places: Floats, table: WalkTable) -> None:
    """Forget the stored distances if they are to another target, or on a map of another width."""
    column, row = cell_of(table, table.target[0], table.target[1])
    width = table.num_columns
    if places[_TARGET_COLUMN] == column and places[_TARGET_ROW] == row and places[_WIDTH] == width:
        return
    if places[_WIDTH] > 0.0:
        for place in range(NUM_COMMON + _FARNESS, places.shape[0], _PER_CELL):
            places[place] = 0.0
    places[_TARGET_COLUMN], places[_TARGET_ROW], places[_WIDTH] = column, row, width


@kernel(inline="late")
def _is_allowed(blocked: Flags, column: int, row: int, move: int) -> bool:
    """Return whether a move leads to a free cell of the map, and past no corner of a blocked cell."""
    to_column, to_row = column + STEP_COLUMNS[move], row + STEP_ROWS[move]
    if not (0 <= to_column < blocked.shape[1] and 0 <= to_row < blocked.shape[0]):
        return False
    if blocked[to_row, to_column]:
        return False
    return move % 2 == 0 or not (blocked[row, to_column] or blocked[to_row, column])


@kernel(inline="late")
def _first_above(sums: Floats, value: float, count: int) -> int:
    """Return the number of the first sum that exceeds a value, else of the last one."""
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
    """Let an ant walk from the start, and write columns and rows of its walk into `cells`, from `first` on.

    Returns:
        The number of cells of the walk, and whether it ends in the target's cell.
    """
    # No NamedTuples in the loop: the references to their arrays would be counted at every step.
    blocked, trails, places, noise = table.blocked, ants.trails, ants.places, ants.noise
    allowed, farness, weights = ants.allowed, ants.farness, ants.weights
    width, before, trail_weight = blocked.shape[1], places[_BEFORE], places[_TRAIL_WEIGHT]
    column, row = cell_of(table, table.start[0], table.start[1])
    end_column, end_row = cell_of(table, table.target[0], table.target[1])
    exponent = places[_SIGHT_WEIGHT] * math.hypot(end_column - column, end_row - row)  # beta
    places[NUM_COMMON + _PER_CELL * (row * width + column) + _VISIT] = before + 1.0
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
            if places[place + _VISIT] > before:
                continue
            if places[place + _FARNESS] == 0.0:
                distance = math.hypot(to_column - end_column, to_row - end_row)
                places[place + _FARNESS] = math.log(NEAREST + distance)
            allowed[count], farness[count] = move, places[place + _FARNESS]
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
        # Eq. 4. Visibilities are in units of the largest: their powers neither overflow nor all vanish.
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
        places[NUM_COMMON + _PER_CELL * (row * width + column) + _VISIT] = before + 1.0
        cells[first + length, 0], cells[first + length, 1] = column, row
        length += 1
    length = _cut_loops(places, blocked, cells, first, length)
    places[_BEFORE] += most_steps(table) + 1
    return length, column == end_column and row == end_row


@kernel
def _cut_loops(places: Floats, blocked: Flags, cells: Cells, first: int, length: int) -> int:
    """Let each cell be followed by the last cell of the walk next to it; return the number of cells left."""
    # So far all visited cells have the first moment of this ant; cells that it backed out of keep it.
    width, start = blocked.shape[1], places[_BEFORE] + 1.0
    for k in range(length):
        place = NUM_COMMON + _PER_CELL * (cells[first + k, 1] * width + cells[first + k, 0])
        places[place + _VISIT] = start + k
    k, kept = 0, 1
    while k < length - 1:
        column, row = cells[first + kept - 1, 0], cells[first + kept - 1, 1]
        for move in range(NUM_MOVES):
            if _is_allowed(blocked, column, row, move):
                cell = (row + STEP_ROWS[move]) * width + column + STEP_COLUMNS[move]
                k = max(k, int(places[NUM_COMMON + _PER_CELL * cell + _VISIT] - start))
        cells[first + kept, 0], cells[first + kept, 1] = cells[first + k, 0], cells[first + k, 1]
        kept += 1
    return kept
