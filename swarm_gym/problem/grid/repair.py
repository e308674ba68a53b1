"""Repair of infeasible paths on grid maps: control points are pulled towards free cells, by a degree phi.

This is a reading (docs/readings.md): no paper says how a curve is repaired. Each run of consecutive
infeasible samples has a mean vector to the nearest free cells. The free control point with the largest weight
in the run moves by phi times the vector that takes the run there. It moves at most three times the mean one.
All runs are found before the path changes.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, look_up, store, total
from swarm_gym.problem.grid.cost import cells_of, samples_of
from swarm_gym.problem.grid.table import GridTable

Floats = NDArray[np.float64]

# A control point with a smaller weight in a run moves no further than with this one.
LEAST_WEIGHT = 1.0 / 3.0
# Weights that differ by a smaller share are the same.
NEARLY = 1e-9


@kernel(inline="late")
def repair(table: GridTable, path: Floats, repair_degree: float) -> None:
    """Repair a path once, in place and inside the bounds; see `tables`."""
    num_blocks, num_points = table.first.shape[0], table.base.shape[0]
    width = table.weights.shape[0] // num_blocks
    moves = np.zeros((num_points, 2))
    weights = np.zeros(num_points)  # weights of the control points, summed over the run
    x, y, infeasible = np.empty(NUM_LANES), np.empty(NUM_LANES), np.empty(NUM_LANES)
    count, away_x, away_y = 0, 0.0, 0.0
    for block in range(num_blocks):
        columns, rows, _, _ = samples_of(table, path, block)
        flags = look_up(table.blocked, cells_of(table, columns, rows))
        if count == 0 and total(flags) == 0.0:
            continue
        store(x, 0, columns)
        store(y, 0, rows)
        store(infeasible, 0, flags)
        for lane in range(NUM_LANES):
            if infeasible[lane] > 0.0:
                column = int(np.floor(min(max(x[lane], -1.0), table.num_columns - 2.0) + 0.5)) + 1
                row = int(np.floor(min(max(y[lane], -1.0), table.num_rows - 2.0) + 0.5)) + 1
                cell = row * table.num_columns + column
                away_x += table.nearest[cell, 0] - x[lane]
                away_y += table.nearest[cell, 1] - y[lane]
                for k in range(width):
                    weights[table.first[block] + k] += table.weights[block * width + k, lane]
                count += 1
            elif count > 0:
                _pull(moves, weights, count, away_x, away_y)
                weights[:] = 0.0
                count, away_x, away_y = 0, 0.0, 0.0
    # No run is open, since the last sample is the target, which is free.
    for point in range(1, num_points - 1):
        if moves[point, 0] != 0.0 or moves[point, 1] != 0.0:
            _move(table, path, point, repair_degree * moves[point, 0], repair_degree * moves[point, 1])


@kernel
def _pull(moves: Floats, weights: Floats, count: int, away_x: float, away_y: float) -> None:
    """Add the move for one run, of the control point with the largest weight in it, to the moves (P, 2)."""
    heaviest = 1
    for point in range(2, weights.shape[0] - 1):
        # Points between whole segments of a run weigh the same but for rounding: the first of them is taken.
        if weights[point] > (1.0 + NEARLY) * weights[heaviest]:
            heaviest = point
    weight = max(weights[heaviest] / count, LEAST_WEIGHT)
    moves[heaviest, 0] += away_x / count / weight
    moves[heaviest, 1] += away_y / count / weight


@kernel
def _move(table: GridTable, path: Floats, point: int, columns: float, rows: float) -> None:
    """Move a control point by a vector, as far as its encoding and the bounds let it."""
    k, m = table.source[point, 0], table.source[point, 1]
    gain_x, gain_y = table.gain[point, 0], table.gain[point, 1]
    if k == m:  # along a line
        along = (columns * gain_x + rows * gain_y) / (gain_x * gain_x + gain_y * gain_y)
        path[k] = min(max(path[k] + along, table.lower[k - 1]), table.upper[k - 1])
        return
    path[k] = min(max(path[k] + columns / gain_x, table.lower[k - 1]), table.upper[k - 1])
    path[m] = min(max(path[m] + rows / gain_y, table.lower[m - 1]), table.upper[m - 1])
