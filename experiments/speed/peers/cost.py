"""The fitness of a problem as the cost function of other libraries: in NumPy, and compiled."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.speed.measurement import IN_NUMPY
from experiments.speed.numpy_bezier import numpy_fitness
from swarm_gym.compiler.jit import entry
from swarm_gym.problem import GridProblem, Problem
from swarm_gym.problem.layout import columns
from swarm_gym.problem.tables import Table, evaluate

Floats = NDArray[np.float64]


class Cost(NamedTuple):
    """A cost function in the two ways in which libraries call it."""

    name: str
    of_one: Callable[[Floats], float]  # of a member, (dimension,)
    of_many: Callable[[Floats], Floats]  # (m,) of m members, (m, dimension)


def numpy_cost(problem: GridProblem) -> Cost:
    """What one writes without a compiler on a grid map."""
    fitness = numpy_fitness(problem)
    return Cost(IN_NUMPY, lambda vector: float(fitness(vector)), fitness)


def compiled_cost(problem: Problem) -> Cost:
    """Our kernel, with as little Python around it as can be."""
    table, path = problem.table, np.zeros(columns(problem.dimension) + 1)
    one = np.empty((1, problem.dimension))
    fitness_of_one = np.empty(1)

    def of_one(vector: Floats) -> float:
        one[0] = vector
        _evaluate_all(table, one, path, fitness_of_one)
        return fitness_of_one[0]

    def of_many(vectors: Floats) -> Floats:
        fitness = np.empty(len(vectors))
        _evaluate_all(table, np.ascontiguousarray(vectors), path, fitness)
        return fitness

    return Cost("our compiled cost", of_one, of_many)


@entry
def _evaluate_all(table: Table, vectors: Floats, path: Floats, fitness: Floats) -> None:
    """Fitness, (m,), of decision vectors (m, dimension); `path` is room for one of them."""
    for i in range(vectors.shape[0]):
        for k in range(vectors.shape[1]):
            path[k + 1] = vectors[i, k]
        fitness[i] = evaluate(table, path)[0]
