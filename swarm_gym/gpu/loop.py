"""The entries on the device: they begin swarms and advance them by one iteration, all swarms at once.

`swarm_gym.optimizers.loop` does the same on the CPU. The entries are compiled for each optimizer and kind of
problem by itself, when they are first launched.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.gpu import firefly, functions, particle_swarm, waypoints
from swarm_gym.gpu.host import Entry
from swarm_gym.gpu.population import (
    Floats,
    PopulationKernels,
    ProblemKernels,
    Tally,
    begin_arrivals,
    forget_arrivals,
    load_tally,
    make_population_kernels,
    num_staying,
    store_tally,
    summarise,
)
from swarm_gym.gpu.random_stream import Stream, load_stream, store_stream
from swarm_gym.gpu.warps import entry, kernel, lane_number, natural, swarm_number
from swarm_gym.population import Swarms
from swarm_gym.problem.analytic.table import WaypointTable
from swarm_gym.problem.function.table import FunctionTable
from swarm_gym.problem.tables import Tables
from swarm_gym.sources import IMMIGRANTS

Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]


@kernel
def _settle_nobody(swarms: Swarms, b: int, tables: Tables, p: int, lane: int, first: int, size: int) -> None:
    """Do nothing with new members."""


@kernel
def _start_nobody(
    parameters: Floats, swarms: Swarms, b: int, tables: Tables, p: int, lane: int, size: int, stream: Stream
) -> Stream:
    """Return the stream: this optimizer draws nothing for the members of a first population."""
    return stream


@kernel
def _recall_nothing(
    swarms: Swarms, b: int, tables: Tables, p: int, lane: int, size: int, tally: Tally
) -> Tally:
    """Return the tally: this optimizer remembers nothing of members that would have to be evaluated."""
    return tally


def _make_recall_nothing(population: PopulationKernels) -> Callable[..., Tally]:
    return _recall_nothing


class OptimizerKernels(NamedTuple):
    """The functions of one optimizer on the device.

    Attributes:
        make_iterate: (problem, population) -> the function that advances a swarm by one iteration.
        make_recall: population -> the function that evaluates again what is remembered of each member.
        settle: (swarms, b, tables, p, lane, first, size) stores what the optimizer remembers of new members.
        start: (parameters, swarms, b, tables, p, lane, size, stream) -> stream; prepares a drawn population.
    """

    make_iterate: Callable[[ProblemKernels, PopulationKernels], Callable[..., tuple[Stream, Tally]]]
    make_recall: Callable[[PopulationKernels], Callable[..., Tally]] = _make_recall_nothing
    settle: Callable[..., None] = _settle_nobody
    start: Callable[..., Stream] = _start_nobody


class Entries(NamedTuple):
    """The entries for an optimizer on a kind of problem.

    Their arguments are (swarms, tables, chosen, sizes, parameters, mean_weight) and one more.

    Attributes:
        begin: (..., given) begins swarms with populations that are drawn, or that their first positions hold
            if these are `given`.
        step: (..., repair_degrees) resizes swarms and advances them by an iteration.
        re_evaluate: (..., False) evaluates again what swarms remember, since their problems have changed.
    """

    begin: Entry
    step: Entry
    re_evaluate: Entry


PROBLEMS: dict[type, ProblemKernels] = {
    WaypointTable: ProblemKernels(waypoints.evaluate, waypoints.repair, waypoints.draw_bend),
    FunctionTable: ProblemKernels(functions.evaluate, functions.repair, functions.draw_bend),
}
OPTIMIZERS: dict[str, OptimizerKernels] = {
    "firefly": OptimizerKernels(firefly.make_iterate),
    "particle-swarm": OptimizerKernels(
        particle_swarm.make_iterate,
        particle_swarm.make_recall,
        particle_swarm.settle,
        particle_swarm.start,
    ),
}


@lru_cache
def entries_for(optimizer: str, table: type) -> Entries:
    """Return the entries for an optimizer of `OPTIMIZERS` on a kind of problem of `PROBLEMS`."""
    problem, kernels = PROBLEMS[table], OPTIMIZERS[optimizer]
    population = make_population_kernels(problem)
    return Entries(
        _make_begin(kernels, population),
        _make_step(kernels, population, problem),
        _make_re_evaluate(kernels, population),
    )


def _make_begin(kernels: OptimizerKernels, population: PopulationKernels) -> Entry:
    settle, start = kernels.settle, kernels.start
    adopt_members, add_members = population.adopt_members, population.add_members

    @entry
    def begin(
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: Integers,
        parameters: Floats,
        mean_weight: float,
        given: bool,
    ) -> None:
        b, lane = swarm_number(), lane_number()
        if not chosen[b]:
            return
        p = natural(swarms.problem[b])
        stream = load_stream(swarms.stream, b, lane)
        tally = Tally(0, math.inf, math.inf, math.inf)
        size = 0
        if given:
            size = sizes[b]
            tally = adopt_members(swarms, b, tables, p, lane, size, tally)
            settle(swarms, b, tables, p, lane, 0, size)
        else:
            lower, upper = tables.initial_lower[p, lane], tables.initial_upper[p, lane]
            size, stream, tally = add_members(
                swarms, b, tables, p, lane, size, sizes[b], lower, upper, stream, tally
            )
            settle(swarms, b, tables, p, lane, 0, size)
            stream = start(parameters, swarms, b, tables, p, lane, size, stream)
        forget_arrivals(swarms, b, lane)
        summarise(swarms, b, lane, size, mean_weight)
        store_stream(swarms.stream, b, lane, stream)
        store_tally(swarms, b, lane, tally)

    return begin


def _make_step(kernels: OptimizerKernels, population: PopulationKernels, problem: ProblemKernels) -> Entry:
    iterate, settle = kernels.make_iterate(problem, population), kernels.settle
    change_size = population.change_size

    @entry
    def step(
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: Integers,
        parameters: Floats,
        mean_weight: float,
        repair_degrees: Floats,
    ) -> None:
        b, lane = swarm_number(), lane_number()
        if not chosen[b]:
            return
        p, size, new_size = natural(swarms.problem[b]), natural(swarms.size[b]), natural(sizes[b])
        stream, tally = load_stream(swarms.stream, b, lane), load_tally(swarms, b)
        begin_arrivals(swarms, b, lane)
        if swarms.source[b, IMMIGRANTS] > 0.0:
            staying = num_staying(swarms, b, size, new_size)
            size, stream, tally = change_size(swarms, b, tables, p, lane, size, staying, stream, tally)
        kept = min(size, new_size)
        size, stream, tally = change_size(swarms, b, tables, p, lane, size, new_size, stream, tally)
        settle(swarms, b, tables, p, lane, kept, size)
        stream, tally = iterate(
            parameters, swarms, b, tables, p, lane, size, repair_degrees[b], stream, tally
        )
        summarise(swarms, b, lane, size, mean_weight)
        store_stream(swarms.stream, b, lane, stream)
        store_tally(swarms, b, lane, tally)

    return step


def _make_re_evaluate(kernels: OptimizerKernels, population: PopulationKernels) -> Entry:
    recall = kernels.make_recall(population)
    adopt_members, evaluate_path = population.adopt_members, population.evaluate_path

    @entry
    def re_evaluate(
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: Integers,
        parameters: Floats,
        mean_weight: float,
        unused: bool,
    ) -> None:
        b, lane = swarm_number(), lane_number()
        if not chosen[b]:
            return
        p, best = natural(swarms.problem[b]), swarms.best_position[b, lane]
        tally = Tally(swarms.evaluations[b], math.inf, math.inf, math.inf)
        size = min(swarms.size[b], swarms.budget[b] - tally.evaluations)
        tally = adopt_members(swarms, b, tables, p, lane, size, tally)
        tally = recall(swarms, b, tables, p, lane, size, tally)
        if tally.evaluations < swarms.budget[b]:
            _, _, tally = evaluate_path(swarms, b, tables, p, lane, best, tally)
        summarise(swarms, b, lane, size, mean_weight)
        store_tally(swarms, b, lane, tally)

    return re_evaluate
