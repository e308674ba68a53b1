"""Artificial fish swarms, ours and those of other libraries, on a test function and on the paths of a case.

All have the same population size, number of iterations and distribution of first populations. Parameters of
the same meaning have the same values. Numbers of evaluations per fish and iteration differ.
"""

from collections.abc import Iterator

import numpy as np

from experiments.speed.measurement import IN_NUMPY, Quantity
from experiments.speed.numpy_firefly import NumpyFirefly, analytic_problem
from experiments.speed.peers.cost import Cost, Floats, compiled_cost
from experiments.speed.peers.runs import Peer, of_member, ours_per_evaluation, per_evaluation
from swarm_gym.env import SwarmEnv

FUNCTION, CASE = "function:rastrigin-10", "case1"
SIZE, ITERATIONS = 100, 10
OURS = "fish-swarm"


def rastrigin(x: Floats) -> float:
    """Return Rastrigin's function of one vector, (n,), as one would write it in NumPy."""
    return float(10.0 * len(x) + np.sum(x**2 - 10.0 * np.cos(2.0 * np.pi * x)))


def numpy_cost(scenario: str) -> Cost:
    """Return the cost as one would write it without a compiler, for one member at a time."""
    of_one = (
        rastrigin if scenario == FUNCTION else NumpyFirefly(analytic_problem(scenario), 1, seed=0).evaluate
    )
    return Cost(IN_NUMPY, of_one, lambda vectors: np.array([of_one(vector) for vector in vectors]))


def environment(scenario: str) -> SwarmEnv:
    """Return an environment of our fish swarm."""
    return SwarmEnv(OURS, scenario=scenario, initial_population_size=SIZE, iterations=ITERATIONS)


def quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for scenario in (FUNCTION, CASE):
        env = environment(scenario)
        problem = env.simulation.problems[0]
        yield Quantity(f"{scenario}: swarm_gym", "us", ours_per_evaluation(env))
        for cost in (numpy_cost(scenario), compiled_cost(problem)):
            for peer in peers:
                once = per_evaluation(peer.run, problem, cost, SIZE, ITERATIONS)
                yield Quantity(f"{scenario}: {peer.name}, {cost.name}", "us", once)
            yield Quantity(f"call of {cost.name}, {scenario}", "us", of_member(problem, cost))
