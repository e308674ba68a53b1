"""Runs of pygmo: its generational particle swarm and its genetic algorithm.

`pso_gen` evaluates a population in one call. `sga` of pygmo 2.20 evaluates one member per call, and so does
`pso`, which is therefore slower than `pso_gen`.
"""

from typing import Any

import pygmo

from experiments.speed.peers.cost import Cost, Floats
from swarm_gym.problem import Problem


class OneByOne:
    """A problem for pygmo that evaluates one member per call."""

    def __init__(self, problem: Problem, cost: Cost):
        self.bounds = tuple(bound.tolist() for bound in problem.bounds)
        self.cost = cost

    def get_bounds(self) -> tuple[list[float], ...]:
        """Return lower and upper bounds of decision vectors."""
        return self.bounds

    def fitness(self, vector: Floats) -> list[float]:
        """Return the fitness of one member, (dimension,), as a list."""
        return [self.cost.of_one(vector)]


class Together(OneByOne):
    """A problem for pygmo that evaluates a population in one call."""

    def batch_fitness(self, vectors: Floats) -> Floats:
        """Return the fitness of all members, (m,), whose vectors follow each other in one flat array."""
        return self.cost.of_many(vectors.reshape(-1, len(self.bounds[0])))


def particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with its default parameters; return the number of evaluations."""
    swarm = pygmo.pso_gen(gen=iterations, seed=0)
    swarm.set_bfe(pygmo.bfe())
    population = pygmo.population(Together(problem, cost), size, b=pygmo.bfe(), seed=0)
    return _evolve(swarm, population)


def genetic(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the genetic algorithm with its default parameters; return the number of evaluations."""
    population = pygmo.population(OneByOne(problem, cost), size, seed=0)
    return _evolve(pygmo.sga(gen=iterations, seed=0), population)


def _evolve(algorithm: Any, population: Any) -> int:
    return pygmo.algorithm(algorithm).evolve(population).problem.get_fevals()
