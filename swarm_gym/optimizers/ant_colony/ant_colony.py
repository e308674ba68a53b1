"""Ant colony optimization on a grid: ants that walk from start to target, by trails and by sight.

Source: M. Dorigo, V. Maniezzo, A. Colorni, "Ant System: optimization by a colony of cooperating agents", IEEE
Trans. Syst. Man Cybern. B 26(1):29-41, 1996, with elitist ants (section V.D). Brand and Yu, "Autonomous robot
path optimization using firefly algorithm", ICMLC 2013, compare with an ant colony and print nothing of it:
all parameters are readings, see docs/readings.md.

A member is an ant, and its position the point where it ended: the target, if it arrived. An iteration is a
cohort of as many ants as the population size says; of the ones before they find nothing but the trails.
"""

import math
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.ant_colony.trails import (
    begin_trails,
    evaporate,
    lay_on_way,
    settle_way,
    trails_size,
)
from swarm_gym.optimizers.ant_colony.walk import (
    PATIENCE,
    Ants,
    learn_map,
    make_ants,
    most_steps,
    places_size,
    set_weights,
    walk,
)
from swarm_gym.optimizers.best_walk import re_evaluate_walk
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import evaluate
from swarm_gym.problem.walk.table import WalkTable, cell_of, to_map

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# The share of a fitness by which another one has to be less to be better: many ways are equally long, and
# rounding must not choose the one that the elite lays its trail on.
_MARGIN = 1e-12
# In the registers: how many ants walk in the next iteration, and whether the best so far arrived.
_NEXT_SIZE, _BEST_ARRIVED = range(2)


class AntColonyRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`.

    The field of a swarm holds its trails, then what is remembered of places; see `trails` and `ant_walk`.
    """


class Ways(NamedTuple):
    """Ways that trails are laid on: of the ants that arrived, in their order."""

    cells: NDArray[np.int32]  # (N, 2) columns and rows, one way after the other
    ends: Integers  # (number of ants + 1,) where a way begins, and the one before ends
    lengths: Floats  # (number of ants,) in map units
    number: Integers  # (1,) how many there are


@kernel
def _make_ways(num_ants: int, most_cells: int) -> Ways:
    """Room for the ways of so many ants."""
    # What they do not fill of it takes no memory.
    cells = np.empty((num_ants * most_cells, 2), np.int32)
    return Ways(cells, np.zeros(num_ants + 1, np.int64), np.empty(num_ants), np.zeros(1, np.int64))


@kernel
def _make_ants(swarms: Swarms, b: int, work: Workspace) -> Ants:
    """The ants of swarm `b`, with what they know."""
    common = trails_size(0) + places_size(0)
    num_cells = (swarms.field.shape[1] - common) // (trails_size(1) + places_size(1) - common)
    trails, places = swarms.field[b, : trails_size(num_cells)], swarms.field[b, trails_size(num_cells) :]
    return make_ants(trails, places, work.noise)


@kernel(inline="late")
def _point_of(table: WalkTable, cells: NDArray[np.int32], first: int, k: int) -> tuple[float, float]:
    """Point k of the way along the cells from `first` on: the start, then their centres."""
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
) -> Ways:
    """Let a cohort of up to `size` ants walk, while the budget lasts; they lay nothing yet."""
    learn_map(ants.places, table)
    ways, path = _make_ways(size, most_steps(table) + 1), work.path
    for i in range(min(size, swarms.budget[b] - swarms.evaluations[b])):
        first = ways.ends[ways.number[0]]
        num_cells, arrived = walk(ants, table, swarms.stream[b], ways.cells, first)
        # The target takes the place of its cell, but not of the start, where both are in one cell.
        num_points = max(num_cells - 1, 1) if arrived else num_cells
        x, y = _point_of(table, ways.cells, first, 0)
        length = 0.0
        for k in range(1, num_points):
            to_x, to_y = _point_of(table, ways.cells, first, k)
            length += math.hypot(to_x - x, to_y - y)
            x, y = to_x, to_y
        if arrived:
            length += math.hypot(table.target[0] - x, table.target[1] - y)
            path[1], path[2] = table.target[0], table.target[1]
            swarms.fitness[b, i], swarms.collision[b, i] = length, 0.0
            ways.lengths[ways.number[0]] = length
            ways.number[0] += 1
            ways.ends[ways.number[0]] = first + num_cells
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
                swarms.walk[b, k, 0], swarms.walk[b, k, 1] = _point_of(table, ways.cells, first, k)
    return ways


@kernel
def _best_way(swarms: Swarms, b: int, table: WalkTable) -> NDArray[np.int32]:
    """The cells of the best way so far, if that arrived and is still free, (its length, 2); else none."""
    if swarms.registers[b, _BEST_ARRIVED] == 0 or swarms.best_collision[b] > 0.0:
        return np.empty((0, 2), np.int32)
    num_points = swarms.best_walk[b]
    cells = np.empty((num_points + 1, 2), np.int32)
    for k in range(num_points):
        cells[k, 0], cells[k, 1] = cell_of(table, swarms.walk[b, k, 0], swarms.walk[b, k, 1])
    cells[num_points, 0], cells[num_points, 1] = cell_of(table, table.target[0], table.target[1])
    return cells


@kernel
def _renew_trails(swarms: Swarms, b: int, table: WalkTable, ants: Ants, ways: Ways, knobs: Floats) -> None:
    """Let trails evaporate, and lay those of the ants that arrived and of the best one so far."""
    trails, width, cells = ants.trails, table.num_columns, ways.cells
    best = _best_way(swarms, b, table)
    straight = math.hypot(table.target[0] - table.start[0], table.target[1] - table.start[1])
    evaporate(trails, knobs[2])
    for i in range(ways.number[0]):
        amount = knobs[3] * straight / ways.lengths[i]  # eq. 3
        lay_on_way(trails, width, cells[ways.ends[i] : ways.ends[i + 1]], amount)
    lay_on_way(trails, width, best, knobs[4] * (knobs[3] * straight / swarms.best_fitness[b]))
    settle_way(trails, width, cells[: ways.ends[ways.number[0]]])
    settle_way(trails, width, best)


@kernel
def begin(
    rules: AntColonyRules,
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    size: int,
    knobs: Floats,
) -> None:
    """A first cohort, by sight alone: the same trails are everywhere."""
    swarms.registers[b, _BEST_ARRIVED] = 0
    begin_trails(_make_ants(swarms, b, work).trails)
    change_size(rules, swarms, b, table, work, size)
    iterate(rules, swarms, b, table, work, 0.0, knobs)


@kernel
def change_size(
    rules: AntColonyRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,  # noqa: ARG001
    work: Workspace,  # noqa: ARG001
    size: int,
) -> None:
    """Let so many ants walk in the next iteration; the members are those of the last one until then."""
    swarms.registers[b, _NEXT_SIZE] = size


@kernel
def iterate(
    rules: AntColonyRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`: a cohort walks, then trails are renewed."""
    if is_spent(swarms, b):
        return
    ants = _make_ants(swarms, b, work)
    set_weights(ants.places, knobs[0], knobs[1])
    ways = _send_ants(swarms, b, table, work, ants, swarms.registers[b, _NEXT_SIZE])
    _renew_trails(swarms, b, table, ants, ways, knobs)


@kernel
def re_evaluate(
    rules: AntColonyRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
) -> None:
    """Send as many ants again, on a map that changed, by the trails that are there; they lay nothing."""
    size = swarms.size[b]
    if swarms.budget[b] - swarms.evaluations[b] > size:
        re_evaluate_walk(swarms, b, table)
    else:
        # It would come after the ants, who forget its walk.
        swarms.best_fitness[b] = math.inf
    _send_ants(swarms, b, table, work, _make_ants(swarms, b, work), size)


class AntColony(Optimizer):
    """Ants that walk over the free cells of a map; Ant System with an elitist weight.

    Phi is without effect, since ants do not enter blocked cells.
    """

    name = "ant-colony"
    encodings = ("walk",)
    adopts = False
    knobs: ClassVar[dict[str, Knob]] = {
        "trail_weight": Knob(
            1.0, 0.0, 10.0, "alpha", "exponent of the trail in a move's weight", (0.1, 10.0)
        ),
        "sight_weight": Knob(
            0.25,
            0.0,
            10.0,
            "beta",
            "exponent of a cell's nearness to the target, for each cell of the straight line",
            (0.01, 2.0),
        ),
        "evaporation": Knob(
            0.2, 0.0, 1.0, "rho", "share of all trails that evaporates in an iteration", (0.01, 1.0)
        ),
        "deposit": Knob(
            0.02, 0.0, 1e3, "Q", "laid on each move of a way that is as long as the straight line"
        ),
        "elite_weight": Knob(10.0, 0.0, 1e3, "e", "how many ants the best way so far counts as besides"),
    }
    rules = AntColonyRules
    kernels = loop.Kernels(iterate, begin, change_size=change_size, re_evaluate=re_evaluate)

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """The size of the next cohort, and whether the best so far arrived."""
        return 2

    @staticmethod
    def walk_points(tables: Any, iterations: int) -> int:  # noqa: ARG004
        """As many as the way of an ant can have."""
        height, width = tables.blocked.shape[-2:]
        return PATIENCE * (height + width) + 1

    @staticmethod
    def field_size(tables: Any) -> int:
        """Trails, and what is remembered of places."""
        height, width = tables.blocked.shape[-2:]
        return trails_size(height * width) + places_size(height * width)
