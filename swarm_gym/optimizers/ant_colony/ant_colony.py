"""Ant colony optimization on a grid: ants walk from start to target, guided by trails and by sight.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, with elitist ants (section V.D). Brand and Yu, "Autonomous robot
path optimization using firefly algorithm", ICMLC 2013, compare with an ant colony but print no parameters:
all parameters are readings, see docs/readings.md.

A member is an ant, and its position is the end of its walk: the target, if it arrived. In an iteration a new
cohort of ants walks, as many as the population size; only the trails connect one cohort to the next.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.ant_colony.trails import (
    begin_trails,
    evaporate,
    lay_on_walk,
    settle_walk,
    trails_size,
)
from swarm_gym.optimizers.ant_colony.walk import (
    STEP_LIMIT,
    Ants,
    learn_map,
    make_ants,
    memory_size,
    most_steps,
    set_weights,
    walk,
)
from swarm_gym.optimizers.best_walk import re_evaluate_walk
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import Tables, evaluate
from swarm_gym.problem.walk.table import WalkTable, cell_of, to_map

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# A fitness is better if it is less by at least this share: many walks are equally long, and rounding must not
# choose the one on which the elite lays its trail.
_MARGIN = 1e-12
# Registers: how many ants walk in the next iteration, and whether the ant with the best walk so far arrived.
_NUM_REGISTERS = 2
_NEXT_SIZE, _BEST_ARRIVED = range(_NUM_REGISTERS)


class AntColonyParameters(NamedTuple):
    """Parameters of the ant colony.

    The field of a swarm holds its trails, then the memory of its ants; see `trails` and `walk`.
    """

    trail_weight: Annotated[
        float,
        Parameter(1.0, 0.0, 10.0, "alpha", "exponent of the trail in the weight of a move", (0.1, 10.0)),
    ]
    sight_weight: Annotated[
        float,
        Parameter(
            0.25,
            0.0,
            10.0,
            "beta",
            "exponent of a cell's nearness to the target, for each cell of the straight line",
            (0.01, 2.0),
        ),
    ]
    evaporation: Annotated[
        float,
        Parameter(0.2, 0.0, 1.0, "rho", "share of all trails that evaporates in an iteration", (0.01, 1.0)),
    ]
    deposit: Annotated[
        float,
        Parameter(
            0.02, 0.0, 1e3, "Q", "pheromone on each move of a walk that is as long as the straight line"
        ),
    ]
    elite_weight: Annotated[
        float,
        Parameter(
            10.0,
            0.0,
            1e3,
            "e",
            "number of additional ants for which the best walk so far counts",
            (0.1, 100.0),
        ),
    ]


class Walks(NamedTuple):
    """Walks of the ants that arrived, in the order of the ants; trails are laid on them."""

    cells: NDArray[np.int32]  # (N, 2) columns and rows, one walk after the other
    ends: Integers  # (number of ants + 1,) number of the cell at which a walk begins and the one before ends
    lengths: Floats  # (number of ants,) in map units
    number: Integers  # (1,) how many walks there are


@kernel
def _make_walks(num_ants: int, most_cells: int) -> Walks:
    """Return room for the walks of this number of ants."""
    # The operating system provides memory only for the part that is filled.
    cells = np.empty((num_ants * most_cells, 2), np.int32)
    return Walks(cells, np.zeros(num_ants + 1, np.int64), np.empty(num_ants), np.zeros(1, np.int64))


@kernel
def _make_ants(swarms: Swarms, b: int, work: Workspace) -> Ants:
    """Return the ants of swarm `b`, with their trails and their memory."""
    common = trails_size(0) + memory_size(0)
    num_cells = (swarms.field.shape[1] - common) // (trails_size(1) + memory_size(1) - common)
    trails, memory = swarms.field[b, : trails_size(num_cells)], swarms.field[b, trails_size(num_cells) :]
    return make_ants(trails, memory, work.noise)


@kernel(inline="late")
def _point_of(table: WalkTable, cells: NDArray[np.int32], first: int, k: int) -> tuple[float, float]:
    """Return point k of the walk along the cells from `first` on: the start, then the centres of cells."""
    if k == 0:
        return table.start[0], table.start[1]
    return to_map(table, float(cells[first + k, 0]), float(cells[first + k, 1]))


@kernel
def _send_ants(
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    ants: Ants,
    size: int,
) -> Walks:
    """Let a cohort of up to `size` ants walk, while the budget lasts, and return the walks; no new trails."""
    learn_map(ants, table)
    walks, path = _make_walks(size, most_steps(table) + 1), work.path
    for i in range(min(size, swarms.budget[b] - swarms.evaluations[b])):
        first = walks.ends[walks.number[0]]
        num_cells, arrived = walk(ants, table, swarms.stream[b], walks.cells, first)
        # The target replaces the centre of its cell, but not the start, if both are in one cell.
        num_points = max(num_cells - 1, 1) if arrived else num_cells
        x, y = _point_of(table, walks.cells, first, 0)
        length = 0.0
        for k in range(1, num_points):
            to_x, to_y = _point_of(table, walks.cells, first, k)
            length += math.hypot(to_x - x, to_y - y)
            x, y = to_x, to_y
        if arrived:
            length += math.hypot(table.target[0] - x, table.target[1] - y)
            path[1], path[2] = table.target[0], table.target[1]
            swarms.fitness[b, i], swarms.collision[b, i] = length, 0.0
            walks.lengths[walks.number[0]] = length
            walks.number[0] += 1
            walks.ends[walks.number[0]] = first + num_cells
        else:
            path[1], path[2] = x, y
            left, swarms.collision[b, i] = evaluate(table, path)
            swarms.fitness[b, i] = length + left
        swarms.evaluations[b] += 1
        for k in range(swarms.positions.shape[2]):
            swarms.positions[b, i, k] = path[k + 1]
        swarms.size[b] = i + 1
        if swarms.fitness[b, i] < swarms.best_fitness[b] * (1.0 - _MARGIN):
            swarms.best_fitness[b] = swarms.fitness[b, i]
            swarms.best_collision[b] = swarms.collision[b, i]
            swarms.best_position[b] = swarms.positions[b, i]
            swarms.registers[b, _BEST_ARRIVED] = arrived
            swarms.best_walk[b] = num_points
            for k in range(num_points):
                swarms.walk[b, k, 0], swarms.walk[b, k, 1] = _point_of(table, walks.cells, first, k)
    return walks


@kernel
def _best_cells(swarms: Swarms, b: int, table: WalkTable) -> NDArray[np.int32]:
    """Return the cells of the best walk so far, (k, 2); none if it did not arrive or is blocked now."""
    if swarms.registers[b, _BEST_ARRIVED] == 0 or swarms.best_collision[b] > 0.0:
        return np.empty((0, 2), np.int32)
    num_points = swarms.best_walk[b]
    cells = np.empty((num_points + 1, 2), np.int32)
    for k in range(num_points):
        cells[k, 0], cells[k, 1] = cell_of(table, swarms.walk[b, k, 0], swarms.walk[b, k, 1])
    cells[num_points, 0], cells[num_points, 1] = cell_of(table, table.target[0], table.target[1])
    return cells


@kernel
def _renew_trails(
    parameters: AntColonyParameters, swarms: Swarms, b: int, table: WalkTable, ants: Ants, walks: Walks
) -> None:
    """Let trails evaporate, then lay the trails of the ants that arrived and of the best one so far."""
    trails, width, cells = ants.trails, table.num_columns, walks.cells
    best = _best_cells(swarms, b, table)
    straight = math.hypot(table.target[0] - table.start[0], table.target[1] - table.start[1])
    evaporate(trails, parameters.evaporation)
    for i in range(walks.number[0]):
        amount = parameters.deposit * straight / walks.lengths[i]  # eq. 3
        lay_on_walk(trails, width, cells[walks.ends[i] : walks.ends[i + 1]], amount)
    best_amount = parameters.deposit * straight / swarms.best_fitness[b]
    lay_on_walk(trails, width, best, parameters.elite_weight * best_amount)
    settle_walk(trails, width, cells[: walks.ends[walks.number[0]]])
    settle_walk(trails, width, best)


@kernel
def begin(
    parameters: AntColonyParameters,
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    size: int,
) -> None:
    """Let a first cohort walk, by sight alone: the same trails are everywhere."""
    swarms.registers[b, _BEST_ARRIVED] = 0
    begin_trails(_make_ants(swarms, b, work).trails)
    change_size(parameters, swarms, b, table, work, size)
    iterate(parameters, swarms, b, table, work, 0.0)


@kernel
def change_size(
    _parameters: AntColonyParameters,
    swarms: Swarms,
    b: int,
    table: WalkTable,  # noqa: ARG001
    work: Workspace,  # noqa: ARG001
    size: int,
) -> None:
    """Set the number of ants of the next iteration; until then the members of the last one stay."""
    swarms.registers[b, _NEXT_SIZE] = size


@kernel
def iterate(
    parameters: AntColonyParameters,
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
) -> None:
    """Advance swarm `b` by one iteration: a cohort walks, then trails are renewed."""
    if is_spent(swarms, b):
        return
    ants = _make_ants(swarms, b, work)
    set_weights(ants, parameters.trail_weight, parameters.sight_weight)
    walks = _send_ants(swarms, b, table, work, ants, swarms.registers[b, _NEXT_SIZE])
    _renew_trails(parameters, swarms, b, table, ants, walks)


@kernel
def re_evaluate(
    _parameters: AntColonyParameters, swarms: Swarms, b: int, table: WalkTable, work: Workspace
) -> None:
    """Let as many ants walk again, on a map that has changed, by the present trails and without new ones."""
    size = swarms.size[b]
    if swarms.budget[b] - swarms.evaluations[b] > size:
        re_evaluate_walk(swarms, b, table)
    else:
        # Members come first: the budget has no evaluation left for the best walk, which is forgotten.
        swarms.best_fitness[b] = math.inf
    _send_ants(swarms, b, table, work, _make_ants(swarms, b, work), size)


class AntColony(Optimizer):
    """Ants that walk over the free cells of a map; Ant System with an elitist weight.

    Phi has no effect, since ants do not enter blocked cells.
    """

    name = "ant-colony"
    encodings = ("walk",)
    adopts = False
    parameter_class = AntColonyParameters
    kernels = loop.Kernels(iterate, begin, change_size=change_size, re_evaluate=re_evaluate)

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """Return the number of registers: the size of the next cohort, and whether the best arrived."""
        return _NUM_REGISTERS

    @staticmethod
    def walk_points(tables: Tables, iterations: int) -> int:  # noqa: ARG004
        """Return the most points that the walk of an ant has."""
        assert isinstance(tables, WalkTable)
        height, width = tables.blocked.shape[-2:]
        return STEP_LIMIT * (height + width) + 1

    @staticmethod
    def field_size(tables: Tables) -> int:
        """Return the size of the trails and of the memory."""
        assert isinstance(tables, WalkTable)
        height, width = tables.blocked.shape[-2:]
        return trails_size(height * width) + memory_size(height * width)
