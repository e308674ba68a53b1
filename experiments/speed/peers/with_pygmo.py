"""Runs of pygmo: the generational swarm, which takes costs of whole populations, and the genetic algorithm.

`sga` of pygmo 2.20 evaluates one member a call; its swarm `pso` does too, so that `pso_gen` is the faster.
"""

from typing import Any

import pygmo

from experiments.speed.peers.cost import Cost, Floats
from swarm_gym.problem import Problem


class OneByOne:
    """A problem for pygmo that evaluates one member a call."""

    def __init__(self, problem: Problem, cost: Cost):
        self.bounds = tuple(bound.tolist() for bound in problem.bounds)
        self.cost = cost

    def get_bounds(self) -> tuple[list[float], ...]:
        """Lower and upper bounds of decision vectors."""
        return self.bounds

    def fitness(self, vector: Floats) -> list[float]:
        """Of one member, (dimension,)."""
        return [self.cost.of_one(vector)]


class Together(OneByOne):
    """A problem for pygmo that evaluates a population in one call."""

    def batch_fitness(self, vectors: Floats) -> Floats:
        """Of all members, one after the other in a flat array."""
        return self.cost.of_many(vectors.reshape(-1, len(self.bounds[0])))


def particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """A run with the default parameters; returns its evaluations."""
    swarm = pygmo.pso_gen(gen=iterations, seed=0)
    swarm.set_bfe(pygmo.bfe())
    population = pygmo.population(Together(problem, cost), size, b=pygmo.bfe(), seed=0)
    return _evolve(swarm, population)


def genetic(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """A run with the default parameters; returns its evaluations."""
    population = pygmo.population(OneByOne(problem, cost), size, seed=0)
    return _evolve(pygmo.sga(gen=iterations, seed=0), population)


def _evolve(algorithm: Any, population: Any) -> int:
    return pygmo.algorithm(algorithm).evolve(population).problem.get_fevals()
