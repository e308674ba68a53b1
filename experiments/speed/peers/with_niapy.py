"""An FA-60 run of swarm_gym, of niapy's `FireflyAlgorithm` and of NumPy: time per evaluation.

niapy's algorithm differs in `>=` instead of `>`, so that every firefly also moves towards itself. Times
include overheads. niapy runs with a cost function in NumPy, as a user would write it, and with our compiled
cost.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from niapy.algorithms.basic import FireflyAlgorithm
from niapy.problems import Problem as NiapyProblem
from niapy.task import Task

from experiments.speed.measurement import (
    CASES,
    NUMPY_COST,
    Measurement,
    Quantity,
    derived,
    medians,
    seconds_of,
)
from experiments.speed.moves import SIZE, numpy_per_move, per_move
from experiments.speed.numpy_firefly import NumpyFirefly, analytic_problem
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.tables import evaluate_entry

COMPILED_COST = "niapy, our compiled cost"
ITERATIONS = 2


class NiapyPathProblem(NiapyProblem):
    """A case of the SPSFA paper as a problem of niapy."""

    def __init__(self, problem: AnalyticProblem, cost: Callable[[Any], float]):
        lower, upper = problem.bounds
        super().__init__(problem.dimension, lower.tolist(), upper.tolist())
        self.cost = cost

    def _evaluate(self, x: Any) -> float:
        return self.cost(x)


def compiled_cost(problem: AnalyticProblem) -> Callable[[Any], float]:
    """Return the cost by our kernel, with as little Python around it as possible."""
    path = np.zeros(len(problem.table.lower) + 1)
    offsets, table = path[1 : problem.dimension + 1], problem.table

    def cost(x: Any) -> float:
        offsets[:] = x
        return evaluate_entry(table, path)[0]

    return cost


def niapy_per_evaluation(case: str, compiled: bool) -> Callable[[], float]:
    """Return a function that measures FA-60 with the SPSFA paper's parameters and first population."""
    problem = analytic_problem(case)
    cost = compiled_cost(problem) if compiled else NumpyFirefly(problem, 1, seed=0).evaluate

    def first_population(task: Any, population_size: int, rng: Any, **_: Any) -> Any:
        population = rng.uniform(*problem.initial_bounds, (population_size, problem.dimension))
        return population, np.apply_along_axis(task.eval, 1, population)

    def once() -> float:
        task = Task(NiapyPathProblem(problem, cost), max_iters=ITERATIONS)
        algorithm = FireflyAlgorithm(
            population_size=SIZE,
            alpha=2.0 / task.range,
            beta0=0.1,
            gamma=5e-6,
            theta=1.0,
            seed=0,
            initialization_function=first_population,
        )
        return seconds_of(lambda: algorithm.run(task)) / task.evals * 1e6

    return once


def compiled_call(case: str) -> Callable[[], float]:
    """Return a function that measures a call of the compiled cost; most of it is the call from Python."""
    problem = analytic_problem(case)
    cost, x = compiled_cost(problem), np.zeros(problem.dimension)

    def once() -> float:
        return seconds_of(lambda: [cost(x) for _ in range(10_000)]) / 10_000 * 1e6

    return once


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for case in CASES:
        yield Quantity(f"{case}: swarm_gym", "us", per_move(case, 0.0, ITERATIONS))
        yield Quantity(f"{case}: NumPy", "us", numpy_per_move(case, ITERATIONS))
        yield Quantity(f"{case}: {NUMPY_COST}", "us", niapy_per_evaluation(case, compiled=False))
        yield Quantity(f"{case}: {COMPILED_COST}", "us", niapy_per_evaluation(case, compiled=True))
        yield Quantity(f"{case}: of that, the call of the cost", "us", compiled_call(case))


def summary(measurements: list[Measurement]) -> list[Measurement]:
    """Return ratios of medians."""
    found = medians(measurements)
    return [
        derived(
            f"{case}: {peer} / swarm_gym", "times", found[f"{case}: {peer}"] / found[f"{case}: swarm_gym"]
        )
        for case in CASES
        for peer in ("NumPy", NUMPY_COST, COMPILED_COST)
    ]
