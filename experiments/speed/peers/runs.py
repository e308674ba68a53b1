"""Time per evaluation of optimizers, ours and those of other libraries, and the share of the cost function.

Each optimizer has its own parameters and operators; the time per evaluation includes overheads and the first
population. Each library runs with a cost in NumPy, as a user would write it, and with our compiled cost. The
difference is the library's own time.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from experiments.speed.measurement import Measurement, derived, medians, seconds_of
from experiments.speed.moves import run_episode
from experiments.speed.peers.cost import Cost
from swarm_gym.env import SwarmEnv
from swarm_gym.problem import Problem

CALLS = 2000

# run(problem, cost, size, iterations) returns the number of evaluations.
Run = Callable[[Problem, Cost, int, int], int]


class Peer(NamedTuple):
    """An optimizer of another library.

    Attributes:
        name: name in the tables.
        ours: name of our optimizer that it is compared with.
        run: function that runs it once.
    """

    name: str
    ours: str
    run: Run


def ours_per_evaluation(env: SwarmEnv) -> Callable[[], float]:
    """Return a function that measures a run of ours, Python included, without repair, of constant size."""
    action = np.array([env.simulation.settings.initial_population_size, 0.0])

    def once() -> float:
        def run() -> None:
            env.reset(seed=0)
            run_episode(env, action)

        return seconds_of(run) / env.simulation.swarms.evaluations[0] * 1e6

    return once


def per_evaluation(run: Run, problem: Problem, cost: Cost, size: int, iterations: int) -> Callable[[], float]:
    """Return a function that measures a run of another library."""

    def once() -> float:
        evaluations = 0

        def counted() -> None:
            nonlocal evaluations
            evaluations = run(problem, cost, size, iterations)

        return seconds_of(counted) / evaluations * 1e6

    return once


def of_population(problem: Problem, cost: Cost, size: int) -> Callable[[], float]:
    """Return a function that measures the cost alone, per member of a population."""
    members = np.random.default_rng(0).uniform(*problem.bounds, (size, problem.dimension))
    calls = CALLS // size

    def once() -> float:
        return seconds_of(lambda: [cost.of_many(members) for _ in range(calls)]) / (calls * size) * 1e6

    return once


def of_member(problem: Problem, cost: Cost) -> Callable[[], float]:
    """Return a function that measures the cost alone, for a single member."""
    member = np.random.default_rng(0).uniform(*problem.bounds)

    def once() -> float:
        return seconds_of(lambda: [cost.of_one(member) for _ in range(CALLS)]) / CALLS * 1e6

    return once


def ratios(measurements: list[Measurement]) -> list[Measurement]:
    """Return ratios of medians: every `<name>: <peer>, <cost>` over `<name>: swarm_gym`."""
    found = medians(measurements)
    compared = [(name, f"{name.partition(': ')[0]}: swarm_gym") for name in found]
    return [
        derived(f"{name} / swarm_gym", "times", found[name] / found[ours])
        for name, ours in compared
        if ours in found and name != ours
    ]
