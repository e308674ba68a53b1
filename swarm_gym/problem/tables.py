"""Problem tables, from which kernels read problems of every kind, and the functions of these tables.

A table of each kind is a NamedTuple with at least the fields `dimension` and `lower`, `upper`,
`initial_lower` and `initial_upper`, (C,) each. Kernels are compiled separately for each kind. A `path` is an
array (C + 1,): a zero, then a decision vector, padded.
"""

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel, kernel_by_class
from swarm_gym.problem.analytic import cost
from swarm_gym.problem.analytic import repair as shift_repair
from swarm_gym.problem.analytic import table as analytic_table
from swarm_gym.problem.analytic.table import WaypointTable, WaypointTables
from swarm_gym.problem.bbob import table as bbob_table
from swarm_gym.problem.bbob.table import BbobTable, BbobTables
from swarm_gym.problem.function import table as function_table
from swarm_gym.problem.function.table import FunctionTable, FunctionTables
from swarm_gym.problem.geometry import bends
from swarm_gym.problem.grid import cost as grid_cost
from swarm_gym.problem.grid import repair as grid_repair
from swarm_gym.problem.grid import table as grid_table
from swarm_gym.problem.grid.table import GridTable, GridTables
from swarm_gym.problem.onemax import table as onemax_table
from swarm_gym.problem.onemax.table import OneMaxTable, OneMaxTables
from swarm_gym.problem.terrain import bends as terrain_bends
from swarm_gym.problem.terrain import cost as terrain_cost
from swarm_gym.problem.terrain import repair as terrain_repair
from swarm_gym.problem.terrain import table as terrain_table
from swarm_gym.problem.terrain.table import TerrainTable, TerrainTables
from swarm_gym.problem.walk import table as walk_table
from swarm_gym.problem.walk.table import WalkTable, WalkTables

Floats = NDArray[np.float64]

Table = WaypointTable | GridTable | FunctionTable | BbobTable | OneMaxTable | WalkTable | TerrainTable
# Of stacked problems.
Tables = WaypointTables | GridTables | FunctionTables | BbobTables | OneMaxTables | WalkTables | TerrainTables

# evaluate(table, path) -> fitness (minimised) and degree of collision, both in map units
evaluate: Callable[[Table, Floats], tuple[float, float]] = kernel_by_class(
    {
        WaypointTable: cost.evaluate,
        GridTable: grid_cost.evaluate,
        FunctionTable: function_table.evaluate,
        BbobTable: bbob_table.evaluate,
        OneMaxTable: onemax_table.evaluate,
        WalkTable: walk_table.evaluate,
        TerrainTable: terrain_cost.evaluate,
    }
)

# repair(table, path, repair_degree): one repair pass of degree phi in [0, 1] over `path`, in place
repair: Callable[[Table, Floats, float], None] = kernel_by_class(
    {
        WaypointTable: shift_repair.repair,
        GridTable: grid_repair.repair,
        FunctionTable: function_table.repair,
        BbobTable: bbob_table.repair,
        OneMaxTable: onemax_table.repair,
        WalkTable: walk_table.repair,
        TerrainTable: terrain_repair.repair,
    }
)

# draw_bend(table, amplitude, kind, noise, path): write a smooth bend into `path`
draw_bend: Callable[[Table, float, int, Floats, Floats], None] = kernel_by_class(
    {
        WaypointTable: bends.draw_bend,
        GridTable: bends.draw_bend,
        FunctionTable: bends.no_bend,
        BbobTable: bends.no_bend,
        OneMaxTable: bends.no_bend,
        WalkTable: bends.no_bend,
        TerrainTable: terrain_bends.draw_flight,
    }
)

# select(tables, index) -> one problem out of stacked tables, as views
select: Callable[[Tables, int], Table] = kernel_by_class(
    {
        WaypointTable: analytic_table.select,
        GridTable: grid_table.select,
        FunctionTable: function_table.select,
        BbobTable: bbob_table.select,
        OneMaxTable: onemax_table.select,
        WalkTable: walk_table.select,
        TerrainTable: terrain_table.select,
    }
)


@kernel
def _root_of_dimension(table: WaypointTable | GridTable | TerrainTable) -> float:
    return math.sqrt(float(table.dimension))


@kernel
def _one(table: object) -> float:  # noqa: ARG001
    return 1.0


# unit_length(table) -> the Euclidean length that a distance of 1 has, where components are measured in their
# ranges: components of a path are averaged over, so that distances do not grow with their number.
unit_length: Callable[[Table], float] = kernel_by_class(
    {
        WaypointTable: _root_of_dimension,
        GridTable: _root_of_dimension,
        TerrainTable: _root_of_dimension,
        FunctionTable: _one,
        BbobTable: _one,
    }
)


@entry
def evaluate_entry(table: Table, path: Floats) -> tuple[float, float]:
    """Return what `evaluate` does; for callers in Python."""
    return evaluate(table, path)


@entry
def repair_entry(table: Table, path: Floats, repair_degree: float) -> None:
    """Do what `repair` does; for callers in Python."""
    repair(table, path, repair_degree)


def stack(tables: list[Table]) -> Tables:
    """Stack tables of one kind and dimension along a leading axis; shorter arrays are padded with zeros."""
    kind = type(tables[0])
    return cast(Tables, kind._make(_pad_and_stack(column) for column in zip(*tables, strict=True)))


def put(tables: Tables, row: int, table: Table) -> Tables:
    """Put a table into a row of stacked ones; return these, in place or copied where it takes more room."""
    return type(tables)._make(
        _put_padded(np.asarray(column), row, np.asarray(value))
        for column, value in zip(tables, table, strict=True)
    )


def _put_padded(column: NDArray, row: int, array: NDArray) -> NDArray:
    shape = np.maximum(column.shape[1:], array.shape).astype(int)
    if tuple(shape) != column.shape[1:]:
        larger = np.zeros((len(column), *shape), dtype=column.dtype)
        larger[tuple(map(slice, column.shape))] = column
        column = larger
    column[row] = 0
    index: tuple[Any, ...] = (row, *map(slice, array.shape))
    column[index] = array
    return column


def _pad_and_stack(values: tuple) -> NDArray:
    arrays = [np.asarray(value) for value in values]
    shape = np.max([array.shape for array in arrays], axis=0).astype(int)
    out = np.zeros((len(arrays), *shape), dtype=arrays[0].dtype)
    for row, array in enumerate(arrays):
        index: tuple[Any, ...] = (row, *map(slice, array.shape))
        out[index] = array
    return out
