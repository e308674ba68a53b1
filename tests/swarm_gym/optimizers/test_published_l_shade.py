"""Differential evolution with the linear reduction ends as the L-SHADE of niapy does, in distribution."""

import numpy as np
import pytest
from scipy.stats import ks_2samp

from helpers.builders import advance, begin, function_problem
from swarm_gym.optimizers import get_optimizer

pytest.importorskip("niapy")
from niapy.algorithms.modified import LpsrSuccessHistoryAdaptiveDifferentialEvolution
from niapy.problems import Problem
from niapy.task import Task

NAME = "differential-evolution"
FUNCTIONS = {"sphere": 1, "Rastrigin": 3, "Rosenbrock": 8, "ill-conditioned ellipsoid": 10}
RUNS, SMALLEST = 60, 4
LEAST_P = 0.01 / 12  # 0.01 for the twelve comparisons together
BUDGETS = {2: 800, 5: 2500, 10: 5000}  # evaluations by dimension; most gaps are not yet lost in rounding


class OfOurs(Problem):
    """One of our functions, as niapy calls it."""

    def __init__(self, problem):
        super().__init__(problem.dimension, *(bound[0] for bound in problem.bounds))
        self.problem = problem

    def _evaluate(self, x):
        return self.problem.evaluate(x)[0]


class AsPrinted(LpsrSuccessHistoryAdaptiveDifferentialEvolution):
    """The L-SHADE of niapy, whose archive loses vectors at random, as printed; niapy drops the last ones."""

    def post_selection(self, pop, arc, arc_ind_cnt, *more, **options):
        arc[:arc_ind_cnt] = arc[self.rng.permutation(arc_ind_cnt)]
        return super().post_selection(pop, arc, arc_ind_cnt, *more, **options)


def first_size(dimension):
    return 18 * dimension


def log_gaps(problem, budget, last=SMALLEST, seed=0):
    """Return log10 of the gap of our runs, whose size falls with the share of the evaluations spent."""
    first = first_size(problem.dimension)
    swarms, tables = begin(
        NAME, [problem] * RUNS, first, capacity=first, budget=budget, iterations=budget, seed=seed
    )
    while (swarms.evaluations < budget).any():
        sizes = np.floor(first + (last - first) * swarms.evaluations / budget + 0.5)
        advance(NAME, swarms, tables, sizes, 0.0)
    assert (swarms.evaluations == budget).all()
    return np.log10(np.maximum(swarms.best_fitness, 1e-300))


def log_gaps_of_niapy(problem, budget):
    found = []
    for seed in range(RUNS):
        algorithm = AsPrinted(first_size(problem.dimension), seed=seed)
        task = Task(problem=OfOurs(problem), max_evals=budget)
        found.append(algorithm.run(task)[1])
        assert task.evals == budget
    return np.log10(np.maximum(found, 1e-300))


def test_defaults_are_those_of_niapy():
    theirs = LpsrSuccessHistoryAdaptiveDifferentialEvolution().get_parameters()
    ours = get_optimizer(NAME).defaults
    keys = ("pbest_factor", "hist_mem_size", "extern_arc_rate")
    assert tuple(ours) == tuple(theirs[key] for key in keys)


# It compiles the optimizer for functions; other tests compare it with its oracle step by step, on maps.
@pytest.mark.slow
@pytest.mark.parametrize("dimension", BUDGETS)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_gaps_at_a_fixed_budget_are_distributed_as_those_of_niapy(name, dimension):
    """The test has something to see: without the reduction, the distributions differ on the sphere."""
    problem, budget = function_problem(f"function:bbob-{FUNCTIONS[name]}-{dimension}-1"), BUDGETS[dimension]
    ours, theirs = log_gaps(problem, budget), log_gaps_of_niapy(problem, budget)
    assert ks_2samp(ours, theirs).pvalue > LEAST_P
    if name == "sphere":
        assert ks_2samp(log_gaps(problem, budget, last=first_size(dimension)), theirs).pvalue < 1e-6
