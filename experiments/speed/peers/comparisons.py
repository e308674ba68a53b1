"""Comparisons with other libraries: fireflies on the three cases, curves on a grid map, and fish swarms.

Fireflies: an FA-60 run of swarm_gym, of NumPy and of other libraries, time per evaluation. All have the SPSFA
paper's parameters and first population. Times include overheads.

Curves: our optimizers, and particle swarms and genetic algorithms of other libraries. All have the same map,
dimension, population size and number of iterations.

Fish: ours and those of other libraries, on a test function and on the paths of a case. All have the same
population size, number of iterations and distribution of first populations. Parameters of the same meaning
have the same values. Numbers of evaluations per fish and iteration differ.
"""

from collections.abc import Iterator

import numpy as np

from experiments.speed.measurement import CASES, IN_NUMPY, Measurement, Quantity
from experiments.speed.moves import SIZE as FIREFLY_SIZE
from experiments.speed.moves import numpy_per_move, per_move
from experiments.speed.numpy_firefly import NumpyFirefly, analytic_problem
from experiments.speed.peers.cost import Cost, Floats, compiled_cost, numpy_cost
from experiments.speed.peers.runs import (
    Peer,
    of_member,
    of_population,
    ours_per_evaluation,
    per_evaluation,
    ratios,
)
from swarm_gym.env import SwarmEnv
from swarm_gym.problem import GridProblem
from swarm_gym.scenarios import GridScenario, make_scenario

FIREFLY_ITERATIONS = 2
CALL = "of that, the call of the cost"

CURVE_MAP, NUM_CONTROL_POINTS = "rooms:0", 4
CURVE_SIZE, CURVE_ITERATIONS = 65, 100
WITH_CURVES = ("particle-swarm", "elite-genetic", "multivariate")

FUNCTION, CASE = "function:rastrigin-10", "case1"
FISH_SIZE, FISH_ITERATIONS = 100, 10
FISH = "fish-swarm"


def firefly_quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of the group of fireflies."""
    for case in CASES:
        problem = analytic_problem(case)
        compiled = compiled_cost(problem)
        yield Quantity(f"{case}: swarm_gym", "us", per_move(case, 0.0, FIREFLY_ITERATIONS))
        yield Quantity(f"{case}: NumPy", "us", numpy_per_move(case, FIREFLY_ITERATIONS))
        for peer in peers:
            for cost in (path_cost(case), compiled):
                once = per_evaluation(peer.run, problem, cost, FIREFLY_SIZE, FIREFLY_ITERATIONS)
                yield Quantity(f"{case}: {peer.name}, {cost.name}", "us", once)
        yield Quantity(f"{case}: {CALL}", "us", of_member(problem, compiled))


def firefly_summary(measurements: list[Measurement]) -> list[Measurement]:
    """Return ratios of medians, but none of the call of the cost, which is part of a run."""
    return ratios([measured for measured in measurements if not measured.name.endswith(CALL)])


def grid_problem() -> GridProblem:
    """Return the problem whose curves all optimizers look for."""
    scenario = make_scenario(CURVE_MAP)
    assert isinstance(scenario, GridScenario)
    return GridProblem(scenario, "bezier", NUM_CONTROL_POINTS)


def curve_environment(optimizer: str) -> SwarmEnv:
    """Return an environment of curves of one of our optimizers."""
    return SwarmEnv(
        optimizer,
        scenario=CURVE_MAP,
        encoding="bezier",
        num_control_points=NUM_CONTROL_POINTS,
        initial_population_size=CURVE_SIZE,
        iterations=CURVE_ITERATIONS,
    )


def curve_quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of the group of curves."""
    problem = grid_problem()
    costs = (numpy_cost(problem), compiled_cost(problem))
    for optimizer in WITH_CURVES:
        yield Quantity(f"{optimizer}: swarm_gym", "us", ours_per_evaluation(curve_environment(optimizer)))
        for peer in peers:
            if peer.ours == optimizer:
                for cost in costs:
                    once = per_evaluation(peer.run, problem, cost, CURVE_SIZE, CURVE_ITERATIONS)
                    yield Quantity(f"{optimizer}: {peer.name}, {cost.name}", "us", once)
    for cost in costs:
        yield Quantity(
            f"call of {cost.name}, {CURVE_SIZE} members", "us", of_population(problem, cost, CURVE_SIZE)
        )
        yield Quantity(f"call of {cost.name}, one member", "us", of_member(problem, cost))


def rastrigin(x: Floats) -> float:
    """Return Rastrigin's function of one vector, (n,), as one would write it in NumPy."""
    return float(10.0 * len(x) + np.sum(x**2 - 10.0 * np.cos(2.0 * np.pi * x)))


def path_cost(scenario: str) -> Cost:
    """Return the cost on a case or function as one would write it without a compiler, a member at a time."""
    of_one = (
        rastrigin if scenario == FUNCTION else NumpyFirefly(analytic_problem(scenario), 1, seed=0).evaluate
    )
    return Cost(IN_NUMPY, of_one, lambda vectors: np.array([of_one(vector) for vector in vectors]))


def fish_environment(scenario: str) -> SwarmEnv:
    """Return an environment of our fish swarm."""
    return SwarmEnv(FISH, scenario=scenario, initial_population_size=FISH_SIZE, iterations=FISH_ITERATIONS)


def fish_quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of the group of fish."""
    for scenario in (FUNCTION, CASE):
        env = fish_environment(scenario)
        problem = env.simulation.problems[0]
        yield Quantity(f"{scenario}: swarm_gym", "us", ours_per_evaluation(env))
        for cost in (path_cost(scenario), compiled_cost(problem)):
            for peer in peers:
                once = per_evaluation(peer.run, problem, cost, FISH_SIZE, FISH_ITERATIONS)
                yield Quantity(f"{scenario}: {peer.name}, {cost.name}", "us", once)
            yield Quantity(f"call of {cost.name}, {scenario}", "us", of_member(problem, cost))
