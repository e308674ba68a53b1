"""The walk of one ant over a grid: from cell to free neighbouring cell, and back out of dead ends.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, eq. 4 (choice of a move), with 1 / (eps + distance to the
target) as the visibility. All other rules on grids, and the exponent beta, are readings, see
docs/readings.md.

An ant sees the distance of a cell from the target, and knows the cells that it has visited. Both are stored
for each cell in the columns `VISIT` and `FARNESS` of a matrix, `places`, row by row of the map: the time of
the last visit, and ln(eps + distance to the target in cells), or 0 if that is not computed yet. What all
cells share is in the columns of `common`. The two are parts of one array of numbers, the memory of the ants;
an array of zeros is the memory of a map without visits. Time is counted in cells: an ant has as many moments
of its own as its walk can have cells.
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

# Columns of `common`: the last moment before the present ant; the target's cell and the map's width for which
# distances are stored; alpha and beta.
NUM_COMMON = 6
BEFORE, TARGET_COLUMN, TARGET_ROW, WIDTH, TRAIL_WEIGHT, SIGHT_WEIGHT = range(NUM_COMMON)
# Columns of `places`: the last visit of a cell, and the logarithm of its distance.
NUM_COLUMNS = 2
VISIT, FARNESS = range(NUM_COLUMNS)


class Ants(NamedTuple):
    """The arrays that the ants of a swarm share."""

    trails: Floats  # see `trails`
    common: Floats  # (NUM_COMMON,) what all cells share
    places: Floats  # (number of cells, NUM_COLUMNS) visits and distances of the cells
    noise: Floats  # (8,) random numbers
    allowed: Integers  # (8,) moves that are allowed from the cell of an ant
    farness: Floats  # (8,) ln(eps + distance) of the cells to which they lead
    weights: Floats  # (8,) weights of these moves, then their running sums


@kernel
def make_ants(trails: Floats, memory: Floats, noise: Floats) -> Ants:
    """Return ants that know these trails and have this memory, see `memory_size`."""
    num_cells = (memory.shape[0] - NUM_COMMON) // NUM_COLUMNS
    places = memory[NUM_COMMON:].reshape((num_cells, NUM_COLUMNS))
    allowed, farness, weights = np.empty(NUM_MOVES, np.int64), np.empty(NUM_MOVES), np.empty(NUM_MOVES)
    return Ants(trails, memory[:NUM_COMMON], places, noise, allowed, farness, weights)


@kernel
def memory_size(num_cells: int) -> int:
    """Return the length of the memory for this number of cells."""
    return NUM_COMMON + NUM_COLUMNS * num_cells


@kernel(inline="late")
def most_steps(table: WalkTable) -> int:
    """Return the most steps that an ant takes."""
    return STEP_LIMIT * (table.num_columns + table.num_rows)


@kernel
def set_weights(ants: Ants, trail_weight: float, sight_weight: float) -> None:
    """Set the exponents by which ants choose moves: alpha, and beta per cell of the straight line."""
    ants.common[TRAIL_WEIGHT], ants.common[SIGHT_WEIGHT] = trail_weight, sight_weight


@kernel
def learn_map(ants: Ants, table: WalkTable) -> None:
    """Forget the stored distances if they are to another target, or on a map of another width."""
    common, places, width = ants.common, ants.places, table.num_columns
    column, row = cell_of(table, table.target[0], table.target[1])
    if common[TARGET_COLUMN] == column and common[TARGET_ROW] == row and common[WIDTH] == width:
        return
    if common[WIDTH] > 0.0:
        for cell in range(places.shape[0]):
            places[cell, FARNESS] = 0.0
    common[TARGET_COLUMN], common[TARGET_ROW], common[WIDTH] = column, row, width


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
    blocked, trails, common, places = table.blocked, ants.trails, ants.common, ants.places
    noise, allowed, farness, weights = ants.noise, ants.allowed, ants.farness, ants.weights
    width, before, trail_weight = blocked.shape[1], common[BEFORE], common[TRAIL_WEIGHT]
    column, row = cell_of(table, table.start[0], table.start[1])
    end_column, end_row = cell_of(table, table.target[0], table.target[1])
    exponent = common[SIGHT_WEIGHT] * math.hypot(end_column - column, end_row - row)  # beta
    places[row * width + column, VISIT] = before + 1.0
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
            cell = to_row * width + to_column
            if places[cell, VISIT] > before:
                continue
            if places[cell, FARNESS] == 0.0:
                distance = math.hypot(to_column - end_column, to_row - end_row)
                places[cell, FARNESS] = math.log(NEAREST + distance)
            allowed[count], farness[count] = move, places[cell, FARNESS]
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
        places[row * width + column, VISIT] = before + 1.0
        cells[first + length, 0], cells[first + length, 1] = column, row
        length += 1
    length = _cut_loops(places, before, blocked, cells, first, length)
    common[BEFORE] += most_steps(table) + 1
    return length, column == end_column and row == end_row


@kernel
def _cut_loops(places: Floats, before: float, blocked: Flags, cells: Cells, first: int, length: int) -> int:
    """Let each cell be followed by the last cell of the walk next to it; return the number of cells left."""
    # So far all visited cells have the first moment of this ant; cells that it backed out of keep it.
    width, start = blocked.shape[1], before + 1.0
    for k in range(length):
        places[cells[first + k, 1] * width + cells[first + k, 0], VISIT] = start + k
    k, kept = 0, 1
    while k < length - 1:
        column, row = cells[first + kept - 1, 0], cells[first + kept - 1, 1]
        for move in range(NUM_MOVES):
            if _is_allowed(blocked, column, row, move):
                cell = (row + STEP_ROWS[move]) * width + column + STEP_COLUMNS[move]
                k = max(k, int(places[cell, VISIT] - start))
        cells[first + kept, 0], cells[first + kept, 1] = cells[first + k, 0], cells[first + k, 1]
        kept += 1
    return kept
