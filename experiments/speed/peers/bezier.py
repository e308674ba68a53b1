"""Optimizers of Bezier curves on a grid map beside particle swarms and genetic algorithms of other libraries.

All have the same map, dimension, population size and number of iterations, and each its own parameters and
operators; what counts is the time per evaluation, overheads and first population included. Each library runs
with a cost in NumPy, as a user would write it, and with our compiled one: what is left then is the library
itself.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from experiments.speed.measurement import Measurement, Quantity, derived, medians, seconds_of
from experiments.speed.moves import run_episode
from experiments.speed.peers.cost import Cost, compiled_cost, numpy_cost
from swarm_gym.env import SwarmEnv
from swarm_gym.problem import GridProblem
from swarm_gym.scenarios import GridScenario, make_scenario

SCENARIO, NUM_CONTROL_POINTS = "rooms:0", 4
SIZE, ITERATIONS = 65, 100
OURS = ("particle-swarm", "elite-genetic", "multivariate")
CALLS = 2000

# run(problem, cost, size, iterations) -> evaluations
Run = Callable[[GridProblem, Cost, int, int], int]


class Peer(NamedTuple):
    """An optimizer of another library, and ours that does the same."""

    name: str
    ours: str
    run: Run


def grid_problem() -> GridProblem:
    """The problem that all work on."""
    scenario = make_scenario(SCENARIO)
    assert isinstance(scenario, GridScenario)
    return GridProblem(scenario, "bezier", NUM_CONTROL_POINTS)


def quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """All of this group."""
    problem = grid_problem()
    costs = (numpy_cost(problem), compiled_cost(problem))
    for optimizer in OURS:
        yield Quantity(f"{optimizer}: swarm_gym", "us", ours_per_evaluation(optimizer))
        for peer in peers:
            if peer.ours == optimizer:
                for cost in costs:
                    once = per_evaluation(peer.run, problem, cost)
                    yield Quantity(f"{optimizer}: {peer.name}, {cost.name}", "us", once)
    for cost in costs:
        yield Quantity(f"call of {cost.name}, {SIZE} members", "us", of_population(problem, cost))
        yield Quantity(f"call of {cost.name}, one member", "us", of_member(problem, cost))


def summary(peers: tuple[Peer, ...], measurements: list[Measurement]) -> list[Measurement]:
    """Ratios of medians."""
    found = medians(measurements)
    return [
        derived(f"{name} / swarm_gym", "times", found[name] / found[f"{peer.ours}: swarm_gym"])
        for peer in peers
        for name in found
        if name.startswith(f"{peer.ours}: {peer.name}, ")
    ]


def ours_per_evaluation(optimizer: str) -> Callable[[], float]:
    """A run in a single environment without repair, Python included."""
    env = SwarmEnv(
        optimizer,
        scenario=SCENARIO,
        encoding="bezier",
        num_control_points=NUM_CONTROL_POINTS,
        initial_population_size=SIZE,
        iterations=ITERATIONS,
    )
    action = np.array([SIZE, 0.0])

    def once() -> float:
        def run() -> None:
            env.reset(seed=0)
            run_episode(env, action)

        return seconds_of(run) / env.simulation.swarms.evaluations[0] * 1e6

    return once


def per_evaluation(run: Run, problem: GridProblem, cost: Cost) -> Callable[[], float]:
    """A run of another library."""

    def once() -> float:
        evaluations = 0

        def counted() -> None:
            nonlocal evaluations
            evaluations = run(problem, cost, SIZE, ITERATIONS)

        return seconds_of(counted) / evaluations * 1e6

    return once


def of_population(problem: GridProblem, cost: Cost) -> Callable[[], float]:
    """What the cost takes by itself for each member of a population."""
    members = np.random.default_rng(0).uniform(*problem.bounds, (SIZE, problem.dimension))
    calls = CALLS // SIZE

    def once() -> float:
        return seconds_of(lambda: [cost.of_many(members) for _ in range(calls)]) / (calls * SIZE) * 1e6

    return once


def of_member(problem: GridProblem, cost: Cost) -> Callable[[], float]:
    """The same for a member alone."""
    member = np.random.default_rng(0).uniform(*problem.bounds)

    def once() -> float:
        return seconds_of(lambda: [cost.of_one(member) for _ in range(CALLS)]) / CALLS * 1e6

    return once
