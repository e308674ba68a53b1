"""Pheromone on the moves of a grid; evaporation is computed only for cells that are read.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, eq. 1 to 3, where rho stays; here it evaporates.
Limits after T. Stuetzle, H. H. Hoos, "MAX-MIN Ant System", Future Gener. Comput. Syst. 16:889-914, 2000.

A round is tau <- (1 - rho) tau everywhere, then the deposits, then tau <- clip(tau). Ants walk along a few
thousand moves of the millions on a map. So each cell stores the round in which its eight moves were last
brought up to date. When the cell is read, the rounds since then are computed one after the other, each
multiplied and clipped. This gives the same bits as rounds over all cells. Cells without a deposit so far
share one tau, and their memory is never touched.

Trails are an array of numbers: a head of `NUM_COMMON`, then for each cell, row by row, its last round and tau
of its moves in the directions `STEP_COLUMNS`, `STEP_ROWS`. An array of zeros can be begun as well.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel

Floats = NDArray[np.float64]
Cells = NDArray[np.int32]

# The moves to the neighbours of a cell, in the order of their angle: even ones straight, odd ones diagonal.
STEP_COLUMNS = np.array([1, 1, 0, -1, -1, -1, 0, 1])
STEP_ROWS = np.array([0, 1, 1, 1, 0, -1, -1, -1])
NUM_MOVES = 8
MOVE_BY_STEP = np.array([[5, 6, 7], [4, -1, 0], [3, 2, 1]])  # [rows + 1, columns + 1]

FIRST_TRAIL, LEAST_TRAIL, MOST_TRAIL = 1.0, 1e-4, 10.0

# Entries of the head: the present round, the first round of the episode, the share that stays after a round;
# then for cells without a deposit in this episode tau before it was clipped in this round, and all eight tau.
_ROUND, _BEGUN, _KEPT, _UNCLIPPED, _UNTOUCHED = range(5)
NUM_COMMON = _UNTOUCHED + NUM_MOVES
_PER_CELL = 1 + NUM_MOVES


@kernel
def trails_size(num_cells: int) -> int:
    """Return the length of the array of trails on this number of cells."""
    return NUM_COMMON + _PER_CELL * num_cells


@kernel
def begin_trails(trails: Floats) -> None:
    """Set all moves to the first tau; the count of rounds continues, so that no cell seems up to date."""
    trails[_ROUND] += 1.0
    trails[_BEGUN] = trails[_ROUND]
    trails[_UNTOUCHED : _UNTOUCHED + NUM_MOVES] = FIRST_TRAIL


@kernel(inline="late")
def current_trails(trails: Floats, cell: int) -> int:
    """Bring the moves of a cell up to date and return the place of their tau in `trails`."""
    place = NUM_COMMON + _PER_CELL * cell
    if trails[place] < trails[_BEGUN]:
        return _UNTOUCHED
    if trails[place] < trails[_ROUND]:
        _catch_up(trails, place, trails[_ROUND])
    return place + 1


@kernel
def evaporate(trails: Floats, evaporation: float) -> None:
    """Begin a round, in which the share rho evaporates from all moves."""
    kept = 1.0 - evaporation
    if kept != trails[_KEPT] and trails[_ROUND] > trails[_BEGUN]:
        # The share of the rounds that cells have not caught up with was another one.
        for cell in range((trails.shape[0] - NUM_COMMON) // _PER_CELL):
            current_trails(trails, cell)
    trails[_KEPT] = kept
    trails[_ROUND] += 1.0
    trails[_UNCLIPPED] = kept * trails[_UNTOUCHED]
    trails[_UNTOUCHED : _UNTOUCHED + NUM_MOVES] = _clipped(trails[_UNCLIPPED])


@kernel
def lay_on_walk(trails: Floats, width: int, cells: Cells, amount: float) -> None:
    """Lay an amount on each move along a walk in this round; `settle_walk` has to follow.

    Args:
        trails: trails on a map.
        width: W, number of columns of the map.
        cells: columns and rows of neighbouring cells, (k, 2).
        amount: amount of pheromone.
    """
    for k in range(cells.shape[0] - 1):
        column, row = cells[k]
        to_column, to_row = cells[k + 1]
        # Start and target may be in the same cell, which then appears twice, without a move.
        if to_column != column or to_row != row:
            _lay(trails, row * width + column, MOVE_BY_STEP[to_row - row + 1, to_column - column + 1], amount)


@kernel
def settle_walk(trails: Floats, width: int, cells: Cells) -> None:
    """Clip the moves of these cells after the last deposit of this round; cells without any are left out."""
    for k in range(cells.shape[0]):
        place = NUM_COMMON + _PER_CELL * (cells[k, 1] * width + cells[k, 0])
        if trails[place] == trails[_ROUND]:
            for move in range(place + 1, place + _PER_CELL):
                trails[move] = _clipped(trails[move])


@kernel
def _lay(trails: Floats, cell: int, move: int, amount: float) -> None:
    place = NUM_COMMON + _PER_CELL * cell
    if trails[place] < trails[_BEGUN]:
        for k in range(place + 1, place + _PER_CELL):
            trails[k] = trails[_UNCLIPPED]
    elif trails[place] < trails[_ROUND]:
        _catch_up(trails, place, trails[_ROUND] - 1.0)
        for k in range(place + 1, place + _PER_CELL):
            trails[k] *= trails[_KEPT]
    trails[place] = trails[_ROUND]
    trails[place + 1 + move] += amount


@kernel(inline="late")
def _clipped(value: float) -> float:
    return min(max(value, LEAST_TRAIL), MOST_TRAIL)


@kernel
def _catch_up(trails: Floats, place: int, last: float) -> None:
    """Compute the rounds up to `last`, in which nothing was laid on the moves of a cell."""
    changing = True
    while trails[place] < last and changing:
        trails[place] += 1.0
        changing = False
        for k in range(place + 1, place + _PER_CELL):
            value = _clipped(trails[_KEPT] * trails[k])
            changing = changing or value != trails[k]
            trails[k] = value
    trails[place] = last
