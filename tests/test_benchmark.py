"""The benchmark measures what it says: same problem, same moves."""

import numpy as np
import pytest

from experiments.benchmark import CASES, measure
from experiments.numpy_firefly import NumpyFirefly
from swarm_gym.problem import Problem
from swarm_gym.scenarios import make_scenario


@pytest.mark.parametrize("case", CASES)
def test_the_numpy_version_has_the_same_cost(case):
    problem = Problem(make_scenario(case))
    swarm = NumpyFirefly(problem, 2, seed=0)
    rng = np.random.default_rng(1)
    for spread in (5.0, 60.0, 250.0):
        for _ in range(100):
            position = rng.uniform(-spread, spread, 31)
            assert swarm.evaluate(position) == pytest.approx(problem.evaluate(position)[0], rel=1e-12)


def test_the_numpy_version_converges_like_the_kernels():
    swarm = NumpyFirefly(Problem(make_scenario("case3")), 12, seed=0)
    before = swarm.fitness.copy()
    for _ in range(5):
        swarm.iterate()
    assert swarm.fitness.mean() < before.mean()
    assert swarm.evaluations > 12 + 5 * 12 * 11 / 4


def test_a_figure_is_the_median_after_a_run_that_is_thrown_away():
    values = iter([100.0, 3.0, 1.0, 2.0])
    figure = measure("x", "s", 3, lambda: next(values))
    assert (figure.median, figure.low, figure.high) == (2.0, 1.0, 3.0)
