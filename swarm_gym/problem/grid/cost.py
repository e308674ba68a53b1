"""Fitness of a path on a grid map: its length, and a penalty for every infeasible sample.

Source: MOA paper, `f = L + lambda * N_im`, lambda = 500; N_im counts the samples in blocked cells or
outside the map. The degree of collision is the infeasible length, N_im L / (number of samples - 1), in map
units, so that thresholds on E(P) keep a meaning.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import (
    Lanes,
    broadcast,
    floor,
    load,
    look_up,
    maximum,
    minimum,
    square_root,
    total,
)
from swarm_gym.problem.grid.table import GridTable


@kernel(inline="late")
def samples_of(
    table: GridTable, path: NDArray[np.float64], block: int
) -> tuple[Lanes, Lanes, Lanes, Lanes, Lanes]:
    """Eight samples: their columns and rows, the ways to the next ones, and 1 where one is infeasible."""
    width = table.weights.shape[0] // table.first.shape[0]
    x, y, dx, dy = broadcast(0.0), broadcast(0.0), broadcast(0.0), broadcast(0.0)
    for k in range(width):
        point = table.first[block] + k
        column = table.base[point, 0] + table.gain[point, 0] * path[table.source[point, 0]]
        row = table.base[point, 1] + table.gain[point, 1] * path[table.source[point, 1]]
        weight, step = load(table.weights, block * width + k), load(table.steps, block * width + k)
        x, y = x + weight * column, y + weight * row
        dx, dy = dx + step * column, dy + step * row
    # In the map with its border. Rounded as by `GridMap.cell_of`: 1.5 in one sum could lead to another cell.
    column_of = floor(minimum(maximum(x, -1.0), table.num_columns - 2.0) + 0.5) + 1.0
    row_of = floor(minimum(maximum(y, -1.0), table.num_rows - 2.0) + 0.5) + 1.0
    return x, y, dx, dy, look_up(table.blocked, row_of * table.num_columns + column_of)


@kernel(inline="late")
def evaluate(table: GridTable, path: NDArray[np.float64]) -> tuple[float, float]:
    """Return fitness (minimised) and degree of collision of a path, both in map units; see `tables`."""
    lengths, counts = broadcast(0.0), broadcast(0.0)
    for block in range(table.first.shape[0]):
        _, _, dx, dy, infeasible = samples_of(table, path, block)
        lengths = lengths + square_root(dx * dx + dy * dy)
        counts = counts + infeasible
    length, count = total(lengths) * table.resolution, total(counts)
    return length + table.penalty * count, count * length / table.num_pieces
