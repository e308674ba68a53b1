"""Bezier curves on a grid map: our optimizers, and particle swarms and genetic algorithms of other libraries.

All have the same map, dimension, population size and number of iterations.
"""

from collections.abc import Iterator

from experiments.speed.measurement import Quantity
from experiments.speed.peers.cost import compiled_cost, numpy_cost
from experiments.speed.peers.runs import Peer, of_member, of_population, ours_per_evaluation, per_evaluation
from swarm_gym.env import SwarmEnv
from swarm_gym.problem import GridProblem
from swarm_gym.scenarios import GridScenario, make_scenario

SCENARIO, NUM_CONTROL_POINTS = "rooms:0", 4
SIZE, ITERATIONS = 65, 100
OURS = ("particle-swarm", "elite-genetic", "multivariate")


def grid_problem() -> GridProblem:
    """Return the problem that all optimizers solve."""
    scenario = make_scenario(SCENARIO)
    assert isinstance(scenario, GridScenario)
    return GridProblem(scenario, "bezier", NUM_CONTROL_POINTS)


def environment(optimizer: str) -> SwarmEnv:
    """Return an environment of one of our optimizers."""
    return SwarmEnv(
        optimizer,
        scenario=SCENARIO,
        encoding="bezier",
        num_control_points=NUM_CONTROL_POINTS,
        initial_population_size=SIZE,
        iterations=ITERATIONS,
    )


def quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    problem = grid_problem()
    costs = (numpy_cost(problem), compiled_cost(problem))
    for optimizer in OURS:
        yield Quantity(f"{optimizer}: swarm_gym", "us", ours_per_evaluation(environment(optimizer)))
        for peer in peers:
            if peer.ours == optimizer:
                for cost in costs:
                    once = per_evaluation(peer.run, problem, cost, SIZE, ITERATIONS)
                    yield Quantity(f"{optimizer}: {peer.name}, {cost.name}", "us", once)
    for cost in costs:
        yield Quantity(f"call of {cost.name}, {SIZE} members", "us", of_population(problem, cost, SIZE))
        yield Quantity(f"call of {cost.name}, one member", "us", of_member(problem, cost))
