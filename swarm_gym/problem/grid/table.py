"""The problem table of a grid map; see `tables`.

Kernels work in cells: (column, row), cell centres at whole numbers. The map has a border of blocked cells
around it, which stands for everything outside.
"""

from functools import lru_cache
from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.problem.geometry.bends import modes_of_components
from swarm_gym.problem.grid.encoding import Encoding
from swarm_gym.problem.padding import Floats, Integers, Real, Whole, pad
from swarm_gym.scenarios import GridMap

# What `GridTable.steps_to_other` has more in blocked cells.
BLOCKED = 128


class GridTable(NamedTuple, Generic[Whole, Real]):
    """The problem table of a path on a grid map, with P control points and S blocks of eight samples.

    Samples beyond the last stand still at the target, which is free. In a stacked table every field has a
    leading problem axis.
    """

    dimension: Whole  # length of decision vectors
    resolution: Real  # map units per cell
    penalty: Real  # lambda, fitness per blocked piece
    num_pieces: Whole  # number of pieces between samples
    num_columns: Whole  # columns of the map with its border
    num_rows: Whole  # rows of the map with its border
    lower: Floats  # (C,) bounds of decision vectors
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population
    initial_upper: Floats  # (C,)
    width: Real  # largest extent of the map across the line, at a control point
    middles: Floats  # (K, C) decision vectors of the paths that smooth bends lie next to
    across: Floats  # (C,) change of the components per unit of offset
    modes: Floats  # (2, NUM_MODES, C) modes of smooth bends
    base: Floats  # (P, 2) control points of the zero vector
    gain: Floats  # (P, 2) change of a coordinate per unit of its component
    source: Integers  # (P, 2) place of that component in a path
    first: Integers  # (S,) first control point of the samples of a block
    weights: Floats  # (S width, 8) weights of that and the next control points, for each sample
    steps: Floats  # (S width, 8) change of these weights to the next sample
    blocked: NDArray[np.uint8]  # (cells,) 1 where blocked, row by row with the border
    steps_to_other: NDArray[np.uint8]  # (cells,) see `_steps_to_other`
    row_runs: NDArray[np.int16]  # (cells + rows,) see `_runs`
    column_runs: NDArray[np.int16]  # (cells + columns,) the same for columns, column by column
    nearest: NDArray[np.int32]  # (cells, 2) the nearest free cell
    curvature_weight: Real  # fitness per integral of the squared curvature, in cells squared
    row_costs: Floats  # (cells + rows,) see `_sums`, or (0,) where no cell costs anything
    column_costs: Floats  # (cells + columns,) the same for columns, column by column


GridTables = GridTable[Integers, Floats]  # of stacked problems


@kernel
def select(tables: GridTables, index: int) -> GridTable:
    """Return one problem table out of stacked ones, as views."""
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
        tables.width[index],
        tables.middles[index],
        tables.across[index],
        tables.modes[index],
        tables.base[index],
        tables.gain[index],
        tables.source[index],
        tables.first[index],
        tables.weights[index],
        tables.steps[index],
        tables.blocked[index],
        tables.steps_to_other[index],
        tables.row_runs[index],
        tables.column_runs[index],
        tables.nearest[index],
        tables.curvature_weight[index],
        tables.row_costs[index],
        tables.column_costs[index],
    )


def tabulate(
    grid: GridMap,
    encoding: Encoding,
    penalty: float,
    ways: Floats | None,
    costs: Floats | None,
    curvature_weight: float,
) -> GridTable:
    """Return the problem table of a map and an encoding.

    Args:
        grid: the map.
        encoding: the encoding.
        penalty: lambda, fitness per blocked piece.
        ways: (K, D) the paths that smooth bends lie next to; the straight line if there are none.
        costs: (height, width) fitness per unit of length in each cell, added to 1; None is 0 everywhere.
        curvature_weight: fitness per integral of the squared curvature, in map units squared.
    """
    cells = _cells(grid)
    padded = np.zeros((0, 0)) if costs is None else np.pad(costs, 1)
    first, weights, steps = _in_blocks(encoding)
    origin = grid.to_cells(np.zeros(2))
    return GridTable(
        len(encoding.lower),
        float(grid.resolution),
        float(penalty),
        len(encoding.first) - 1,
        cells.blocked.shape[1],
        cells.blocked.shape[0],
        pad(encoding.lower),
        pad(encoding.upper),
        pad(encoding.lower),
        pad(encoding.upper),
        float(encoding.width),
        pad(encoding.middle[None] if ways is None else ways),
        pad(encoding.across),
        modes_of_components(encoding.owner, len(encoding.base) - 2),
        grid.to_cells(encoding.base),
        grid.to_cells(encoding.gain) - origin,
        encoding.source + 1,  # a path begins with a zero
        first,
        weights,
        steps,
        cells.blocked.ravel(),
        cells.steps_to_other.ravel(),
        _runs(cells.blocked).ravel(),
        _runs(cells.blocked.T).ravel(),
        cells.nearest,
        float(curvature_weight) / grid.resolution**2,
        _sums(padded).ravel(),
        _sums(padded.T).ravel(),
    )


class _Cells(NamedTuple):
    """Arrays of cells for the kernels; all (rows, columns) with the border, `nearest` (cells, 2)."""

    blocked: NDArray[np.uint8]
    steps_to_other: NDArray[np.uint8]
    nearest: NDArray[np.int32]


@lru_cache(maxsize=8)
def _cells(grid: GridMap) -> _Cells:
    from scipy.ndimage import distance_transform_edt

    blocked = np.pad(grid.blocked, 1, constant_values=True)
    _, nearest = distance_transform_edt(blocked, return_indices=True)
    row, column = nearest.astype(np.int32) - 1
    return _Cells(
        blocked.astype(np.uint8),
        _steps_to_other(blocked),
        np.ascontiguousarray(np.stack([column, row], axis=-1).reshape(-1, 2)),
    )


def _steps_to_other(blocked: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return the number of steps, at most 127, from each cell to the nearest one of the other kind.

    A step leads to one of eight neighbours. Blocked cells have `BLOCKED` more.
    """
    from scipy.ndimage import distance_transform_cdt

    steps = distance_transform_cdt(blocked, "chessboard") + distance_transform_cdt(~blocked, "chessboard")
    return (np.minimum(steps, BLOCKED - 1) + BLOCKED * blocked).astype(np.uint8)


def _runs(rows: NDArray[np.uint8]) -> NDArray[np.int16]:
    """Return the number of blocked cells before each cell of a row, and in the whole row."""
    return np.pad(np.cumsum(rows, axis=1, dtype=np.int16), ((0, 0), (1, 0)))


def _sums(rows: Floats) -> Floats:
    """Return the sum of costs before each cell of a row, and of the whole row."""
    return np.pad(np.cumsum(rows, axis=1), ((0, 0), (1, 0)))


def _in_blocks(encoding: Encoding) -> tuple[Integers, Floats, Floats]:
    """Return `first`, `weights` and `steps` of all samples in blocks of eight."""
    first, weights = encoding.first, encoding.weights
    num_points, width = len(encoding.base), weights.shape[1]
    num_blocks = -(-len(first) // NUM_LANES)
    block_first = first[::NUM_LANES]
    # The weights of all control points, for every sample and the one after the last.
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
    """Rearrange (S 8, width) as (S width, 8)."""
    blocks = values.reshape(-1, NUM_LANES, values.shape[1]).transpose(0, 2, 1)
    return np.ascontiguousarray(blocks.reshape(-1, NUM_LANES))
