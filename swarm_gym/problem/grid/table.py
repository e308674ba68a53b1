"""A problem on a grid map as the kernels read it; see `tables`.

Kernels work in cells: (column, row), cell centres at whole numbers. The map has a border of blocked cells
around it, for which everything outside stands.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.problem.grid.encoding import Encoding
from swarm_gym.problem.layout import pad
from swarm_gym.scenarios import GridMap

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class GridTable(NamedTuple):
    """What the kernels need of one problem, with P control points and S blocks of eight samples.

    Samples beyond the last stand still at the target, which is free. In a stacked table every field has a
    leading problem axis.
    """

    dimension: Any  # of decision vectors: a number, in a stacked table an array
    resolution: Any  # map units per cell, likewise
    penalty: Any  # lambda, fitness per infeasible sample, likewise
    num_pieces: Any  # pieces between samples, likewise
    num_columns: Any  # of the map with its border, likewise
    num_rows: Any  # likewise
    lower: Floats  # (C,) bounds of decision vectors
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) where the first population is drawn
    initial_upper: Floats  # (C,)
    base: Floats  # (P, 2) control points of the zero vector
    gain: Floats  # (P, 2) by how much a coordinate changes with its component
    source: Integers  # (P, 2) where in a path that component is
    first: Integers  # (S,) first control point of the samples of a block
    weights: Floats  # (S width, 8) of that and the next control points, sample by sample
    steps: Floats  # (S width, 8) the same of the way to the next sample
    blocked: NDArray[np.uint8]  # (cells,) 1 where blocked, row by row with the border
    nearest: NDArray[np.int32]  # (cells, 2) the nearest free cell


@kernel
def select(tables: GridTable, index: int) -> GridTable:
    """One problem out of stacked tables, as views."""
    return GridTable(
        tables.dimension[index],
        tables.resolution[index],
        tables.penalty[index],
        tables.num_pieces[index],
        tables.num_columns[index],
        tables.num_rows[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.base[index],
        tables.gain[index],
        tables.source[index],
        tables.first[index],
        tables.weights[index],
        tables.steps[index],
        tables.blocked[index],
        tables.nearest[index],
    )


def tabulate(grid: GridMap, encoding: Encoding, penalty: float) -> GridTable:
    """The table of a map and an encoding, with lambda fitness per infeasible sample."""
    blocked, nearest = _cells(grid)
    first, weights, steps = _in_blocks(encoding)
    origin = grid.to_cells(np.zeros(2))
    return GridTable(
        len(encoding.lower),
        float(grid.resolution),
        float(penalty),
        len(encoding.first) - 1,
        blocked.shape[1],
        blocked.shape[0],
        pad(encoding.lower),
        pad(encoding.upper),
        pad(encoding.lower),
        pad(encoding.upper),
        grid.to_cells(encoding.base),
        grid.to_cells(encoding.gain) - origin,
        encoding.source + 1,  # a path begins with a zero
        first,
        weights,
        steps,
        blocked.astype(np.uint8).ravel(),
        nearest,
    )


@lru_cache(maxsize=8)
def _cells(grid: GridMap) -> tuple[NDArray[np.bool_], NDArray[np.int32]]:
    """What is blocked, (rows, columns) with the border, and the nearest free cell of every cell."""
    from scipy.ndimage import distance_transform_edt

    blocked = np.pad(grid.blocked, 1, constant_values=True)
    _, nearest = distance_transform_edt(blocked, return_indices=True)
    row, column = nearest.astype(np.int32) - 1
    return blocked, np.ascontiguousarray(np.stack([column, row], axis=-1).reshape(-1, 2))


def _in_blocks(encoding: Encoding) -> tuple[Integers, Floats, Floats]:
    """`first`, `weights` and `steps` of all samples in blocks of eight."""
    first, weights = encoding.first, encoding.weights
    num_points, width = len(encoding.base), weights.shape[1]
    num_blocks = -(-len(first) // NUM_LANES)
    block_first = first[::NUM_LANES]
    # Of every sample and of the one after it, the weights of all control points.
    every = np.zeros((num_blocks * NUM_LANES + 1, num_points))
    every[len(first) :, -1] = 1.0
    every[np.arange(len(first))[:, None], first[:, None] + np.arange(width)] = weights
    window = np.repeat(block_first, NUM_LANES)[:, None] + np.arange(width)
    samples = np.arange(num_blocks * NUM_LANES)[:, None]
    here, there = every[samples, window], every[samples + 1, window]
    assert np.allclose(here.sum(axis=1), 1.0)
    assert np.allclose(there.sum(axis=1), 1.0)
    return block_first, _lanes_last(here), _lanes_last(there - here)


def _lanes_last(values: Floats) -> Floats:
    """(S 8, width) as (S width, 8)."""
    blocks = values.reshape(-1, NUM_LANES, values.shape[1]).transpose(0, 2, 1)
    return np.ascontiguousarray(blocks.reshape(-1, NUM_LANES))
