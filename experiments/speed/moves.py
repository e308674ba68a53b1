"""Time of a firefly move with evaluation, of its parts, of whole runs, in NumPy, and of new members."""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import gymnasium
import numpy as np

from experiments.speed.measurement import CASES, Measurement, Quantity, derived, medians, seconds_of
from experiments.speed.numpy_firefly import NumpyFirefly, analytic_problem
from swarm_gym.compiler.jit import entry
from swarm_gym.compiler.random_stream import STREAM_SHAPE, fill_uniform
from swarm_gym.env import SwarmEnv
from swarm_gym.optimizers.firefly import FireflyParameters, move_towards, squared_distance
from swarm_gym.population import Workspace, make_workspace
from swarm_gym.problem.analytic.cost import evaluate
from swarm_gym.problem.analytic.table import WaypointTable
from swarm_gym.problem.padding import columns
from swarm_gym.sources import (
    AMPLITUDE,
    NUM_SOURCE_NUMBERS,
    SMOOTH_SHARE,
    Source,
    draw_newcomer,
)

SIZE = 60
UNIFORM, SMOOTH = "new member, uniform", "new member, smooth"
# New members with their evaluation, by the name of the quantity.
NEW_MEMBERS = {UNIFORM: Source(), SMOOTH: Source(1.0)}
REPAIR_DEGREE = 0.2
CALLS = 20_000


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for case in CASES:
        yield Quantity(f"{case}: move with evaluation", "us", per_move(case, 0.0))
        yield Quantity(f"{case}: move with repair and evaluation", "us", per_move(case, REPAIR_DEGREE))
        yield Quantity(f"{case}: the same move in NumPy, without repair", "us", numpy_per_move(case))
        yield Quantity(f"{case}: FA-60 run of 100 iterations", "ms", run_milliseconds(case))
        for name, part in PARTS.items():
            yield Quantity(f"{case}: {name}", "ns", part_nanoseconds(case, part))
        for name, source in NEW_MEMBERS.items():
            yield Quantity(f"{case}: {name}", "ns", new_member_nanoseconds(case, source))


def summary(measurements: list[Measurement]) -> list[Measurement]:
    """Return ratios and the mean over the cases, computed from medians."""
    found = medians(measurements)
    ours = [found[f"{case}: move with evaluation"] for case in CASES]
    theirs = [found[f"{case}: the same move in NumPy, without repair"] for case in CASES]
    ratios = [
        derived(f"{case}: NumPy / swarm_gym", "times", b / a)
        for case, a, b in zip(CASES, ours, theirs, strict=True)
    ]
    mean = derived("move with evaluation, mean of the cases", "us", float(np.mean(ours)))
    births = [
        derived(
            f"{case}: {SMOOTH} / uniform", "times", found[f"{case}: {SMOOTH}"] / found[f"{case}: {UNIFORM}"]
        )
        for case in CASES
    ]
    return [*ratios, mean, *births]


def per_move(case: str, repair_degree: float, iterations: int = 100) -> Callable[[], float]:
    """Return a function that measures an FA-60 run in a single environment: time per move with evaluation."""
    env = SwarmEnv(scenario=case, initial_population_size=SIZE, iterations=iterations)

    def once() -> float:
        _, first = env.reset(seed=0)
        begin = time.perf_counter()
        info = run_episode(env, np.array([SIZE, repair_degree]))
        spent = time.perf_counter() - begin
        return spent / (info["evaluations"] - first["evaluations"]) * 1e6

    return once


def numpy_per_move(case: str, iterations: int = 2) -> Callable[[], float]:
    """Return a function that measures an FA-60 run in NumPy: time per firefly move with evaluation."""

    def once() -> float:
        swarm = NumpyFirefly(analytic_problem(case), SIZE, seed=0)
        before, begin = swarm.evaluations, time.perf_counter()
        for _ in range(iterations):
            swarm.iterate()
        return (time.perf_counter() - begin) / (swarm.evaluations - before) * 1e6

    return once


def run_milliseconds(case: str) -> Callable[[], float]:
    """Return a function that measures a whole FA-60 run with its reset."""
    env = SwarmEnv(scenario=case, initial_population_size=SIZE)

    def run() -> None:
        env.reset(seed=0)
        run_episode(env, np.array([SIZE, 0.0]))

    def once() -> float:
        return seconds_of(run) * 1e3

    return once


def run_episode(env: gymnasium.Env, action: np.ndarray) -> dict[str, Any]:
    """Repeat an action to the end of the episode and return the last info."""
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(action)
    return info


# The parts of a move, each repeated by itself. Results depend on all of the work, so that the compiler cannot
# leave out any of it; changes between calls are too small to matter.


@entry
def _random_numbers(table: WaypointTable, work: Workspace, calls: int) -> float:
    stream = np.ones(STREAM_SHAPE, dtype=np.uint64)
    for _ in range(calls):
        fill_uniform(stream, work.noise)
    return work.noise[0] + table.spacing


@entry
def _distance(table: WaypointTable, work: Workspace, calls: int) -> float:
    other, total = np.ones_like(work.noise), table.spacing
    for _ in range(calls):
        total += squared_distance(work.path, other)
        other[0] += 1e-9
    return total


@entry
def _move(table: WaypointTable, work: Workspace, calls: int) -> float:
    other = np.ones_like(work.noise)
    parameters = FireflyParameters(noise=2.0, attractiveness=0.1, absorption=5e-6)
    for _ in range(calls):
        move_towards(parameters, table, work, other)
    return work.path[1]


@entry
def _evaluation(table: WaypointTable, work: Workspace, calls: int) -> float:
    total = 0.0
    for _ in range(calls):
        total += evaluate(table, work.path)[0]
        work.path[1] += 1e-9
    return total


PARTS: dict[str, Callable[[WaypointTable, Workspace, int], float]] = {
    "random numbers of a move": _random_numbers,
    "distance to another": _distance,
    "distance, attraction and move": _move,
    "evaluation": _evaluation,
}


def part_nanoseconds(
    case: str, part: Callable[[WaypointTable, Workspace, int], float]
) -> Callable[[], float]:
    """Return a function that measures one part of a move on a path between the obstacles."""
    problem = analytic_problem(case)
    n = problem.dimension
    work = make_workspace(columns(n))
    rng = np.random.default_rng(0)

    def once() -> float:
        work.path[1 : n + 1] = np.cumsum(rng.normal(0.0, 3.0, n))
        work.noise[:] = rng.random(len(work.noise))
        return seconds_of(lambda: part(problem.table, work, CALLS)) / CALLS * 1e9

    return once


@entry
def _new_members(table: WaypointTable, work: Workspace, source: np.ndarray, calls: int) -> float:
    stream, total = np.ones(STREAM_SHAPE, dtype=np.uint64), 0.0
    for _ in range(calls):
        draw_newcomer(source, stream, table, work.noise, work.path, table.initial_lower, table.initial_upper)
        total += evaluate(table, work.path)[0]
    return total


def new_member_nanoseconds(case: str, source: Source) -> Callable[[], float]:
    """Return a function that measures the birth of a member in a first population, with its evaluation."""
    problem = analytic_problem(case)
    work = make_workspace(columns(problem.dimension))
    numbers = np.zeros(NUM_SOURCE_NUMBERS)
    numbers[[SMOOTH_SHARE, AMPLITUDE]] = source.smooth_share, source.amplitude
    births = partial(_new_members, problem.table, work, numbers, CALLS)

    def once() -> float:
        return seconds_of(births) / CALLS * 1e9

    return once
