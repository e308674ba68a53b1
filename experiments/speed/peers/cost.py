"""Fitness functions as cost functions for other libraries: in NumPy, and compiled."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.speed.measurement import IN_NUMPY
from swarm_gym.compiler.jit import entry
from swarm_gym.problem import GridProblem, Problem
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, evaluate

Floats = NDArray[np.float64]


class Cost(NamedTuple):
    """A cost function in the two forms that libraries call.

    Attributes:
        name: name of the cost in the tables.
        of_one: function of one member, (dimension,).
        of_many: function of m members, (m, dimension), that returns m values, (m,).
    """

    name: str
    of_one: Callable[[Floats], float]
    of_many: Callable[[Floats], Floats]


def numpy_fitness(problem: GridProblem) -> Callable[[Floats], Floats]:
    """Return a function for the fitness, (...,), of Bezier curves on a grid map, written in NumPy.

    It takes decision vectors, (..., dimension), inside the bounds. It counts infeasible samples, as in the
    MOA paper, where the kernel measures the exact length in blocked cells.
    """
    curve, grid, penalty = problem.curve, problem.scenario.map, problem.penalty
    basis = np.ascontiguousarray(curve.weights.T)

    def fitness(vectors: Floats) -> Floats:
        # A curve lies in the convex hull of its control points, so that no sample is outside the map.
        control_points = grid.to_cells(curve.control_points(vectors))
        columns, rows = control_points[..., 0] @ basis, control_points[..., 1] @ basis
        across, down = np.diff(columns), np.diff(rows)
        length = grid.resolution * np.sqrt(across * across + down * down).sum(axis=-1)
        # Coordinates are not negative, so that cutting off decimals finds the nearest cell centre.
        infeasible = grid.blocked[(rows + 0.5).astype(int), (columns + 0.5).astype(int)]
        return length + penalty * np.count_nonzero(infeasible, axis=-1)

    return fitness


def numpy_cost(problem: GridProblem) -> Cost:
    """Return the cost of Bezier curves on a grid map as one would write it without a compiler."""
    fitness = numpy_fitness(problem)
    return Cost(IN_NUMPY, lambda vector: float(fitness(vector)), fitness)


def compiled_cost(problem: Problem) -> Cost:
    """Return the cost by our kernel, with as little Python around it as possible."""
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
    """Write the fitness, (m,), of decision vectors, (m, dimension); `path` is workspace for one of them."""
    for i in range(vectors.shape[0]):
        for k in range(vectors.shape[1]):
            path[k + 1] = vectors[i, k]
        fitness[i] = evaluate(table, path)[0]
