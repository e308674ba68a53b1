"""CMA-ES in distribution against the libraries `cmaes` and `cma` (pycma), at the default lambda."""

import math
import warnings

import numpy as np
import pytest
from scipy.stats import ks_2samp

from helpers.builders import advance, begin, function_problem

# Numbers of BBOB functions; and whether runs are compared by their evaluations until a gap of 1e-6, or by
# their gap after a budget, since not all reach the optimum.
TO_TARGET = {"sphere": 1, "ellipsoid": 10}
AT_BUDGET = {"rosenbrock": 8, "rastrigin": 15}
TARGET, BUDGET = 1e-6, 2000
STEP, RANGE = 0.5, 10.0
OURS, THEIRS = 64, 12  # numbers of runs
LEAST_P = 1e-3  # of 16 comparisons


def first_point(dimension):
    """Return a point from which no run has to cross the bounds."""
    return np.where(np.arange(dimension) % 2, 1.5, -1.0)


def default_size(dimension):
    return 4 + math.floor(3 * math.log(dimension))


def our_runs(problem, until_target):
    """Return evaluations until the target, or gaps at the budget, of swarms side by side."""
    dimension, size = problem.dimension, default_size(problem.dimension)
    population = np.tile(first_point(dimension), (size, 1))
    parameters = {"first_step": STEP / RANGE, "restarts": "degenerate"}
    swarms, tables = begin(
        "cma-es", [problem] * OURS, size, populations=[population] * OURS, parameters=parameters
    )
    reached = np.zeros(OURS)
    for _ in range(20 * BUDGET):
        going = (reached == 0) if until_target else swarms.evaluations < BUDGET + size
        if not going.any():
            break
        advance("cma-es", swarms, tables, size, 0.0, parameters, chosen=going)
        there = (swarms.best_fitness < TARGET) & (reached == 0)
        reached[there] = swarms.evaluations[there] - size  # the first population is one point
    return reached if until_target else np.log10(swarms.best_fitness)


def their_run(problem, until_target, ask, tell):
    size, best, spent = default_size(problem.dimension), np.inf, 0
    while (best >= TARGET) if until_target else (spent < BUDGET):
        points = ask(size)
        fitness = [problem.evaluate(point)[0] for point in points]
        tell(points, fitness)
        best, spent = min(best, *fitness), spent + size
    return spent if until_target else np.log10(best)


def run_cmaes(problem, until_target, seed):
    optimizer = pytest.importorskip("cmaes", reason="needs cmaes, of the extra `train`").CMA(
        mean=first_point(problem.dimension), sigma=STEP, seed=seed
    )
    return their_run(
        problem,
        until_target,
        lambda size: [optimizer.ask() for _ in range(size)],
        lambda points, fitness: optimizer.tell(list(zip(points, fitness, strict=True))),
    )


def run_pycma(problem, until_target, seed):
    library = pytest.importorskip("cma", reason="needs pycma, of the group dev")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        options = {"verbose": -9, "seed": seed + 1}
        strategy = library.CMAEvolutionStrategy(first_point(problem.dimension), STEP, options)
        return their_run(problem, until_target, strategy.ask, strategy.tell)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("library", "function", "dimension"),
    [
        (library, function, dimension)
        for library in (run_cmaes, run_pycma)
        for function in (*TO_TARGET, *AT_BUDGET)
        for dimension in (5, 10)
    ],
)
def test_runs_are_distributed_as_those_of_the_library(library, function, dimension):
    until_target = function in TO_TARGET
    number = (TO_TARGET | AT_BUDGET)[function]
    problem = function_problem(f"function:bbob-{number}-{dimension}-1")
    theirs = [library(problem, until_target, seed) for seed in range(THEIRS)]
    ours = our_runs(problem, until_target)
    print(f"{library.__name__} {function}-{dimension}: ours {np.median(ours):.4g}, theirs", end=" ")
    print(f"{np.median(theirs):.4g}, p {ks_2samp(ours, theirs).pvalue:.3g}")
    assert ks_2samp(ours, theirs).pvalue > LEAST_P


@pytest.mark.slow
def test_a_strategy_with_other_rates_is_told_apart():
    """The comparison can fail: members of twice the number take other evaluations."""
    problem, size = function_problem("function:bbob-1-10-1"), 2 * default_size(10)
    ours = our_runs(problem, until_target=True)
    parameters = {"first_step": STEP / RANGE}
    swarms, tables = begin(
        "cma-es", [problem] * 12, size, populations=[np.tile(first_point(10), (size, 1))] * 12,
        parameters=parameters,
    )  # fmt: skip
    spent = np.zeros(12)
    while (spent == 0).any():
        advance("cma-es", swarms, tables, size, 0.0, parameters)
        there = (swarms.best_fitness < TARGET) & (spent == 0)
        spent[there] = swarms.evaluations[there] - size
    assert ks_2samp(ours, spent).pvalue < LEAST_P
