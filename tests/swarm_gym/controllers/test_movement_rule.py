"""The rule `psa` against the algorithm of the paper, step by step, and on swarms."""

import math
from statistics import NormalDist

import numpy as np
import pytest

from helpers.refusals import refused
from swarm_gym.controllers import SizeLimits, make_controller
from swarm_gym.controllers.movement_rule import best_normalized_step
from swarm_gym.errors import SettingError
from swarm_gym.rollout import run_episodes

LIMITS, NAME = SizeLimits(2, 300), "cma-es"


def seen(iteration, restarts, movement, expected, dimension=10):
    return np.array([[0.0, 0.0, 0.0, iteration, restarts, movement, expected, dimension]])


def best_step(size, n):
    """Return the best normalised step size by the formula of the paper, with plain loops."""
    mu = size // 2
    raw = [math.log((size + 1) / 2) - math.log(i) for i in range(1, mu + 1)]
    weights = [one / sum(raw) for one in raw]
    mueff = 1 / sum(one * one for one in weights)
    normal = NormalDist()
    c = -sum(w * normal.inv_cdf((i - 0.375) / (size + 0.25)) for i, w in enumerate(weights, 1))
    return c * n * mueff / (n - 1 + c * c * mueff)


@pytest.mark.parametrize(("size", "n"), [(4, 2), (10, 10), (41, 10), (300, 40)])
def test_the_best_step_on_a_sphere_is_that_of_the_formula(size, n):
    assert best_normalized_step(size, n) == pytest.approx(best_step(size, n), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_sizes_and_factors_are_those_of_the_algorithm(seed):
    controller = make_controller("psa:start=12,threshold=1.3", LIMITS)
    controller.reset(1)
    assert controller.act(seen(0, 0, 0.0, 0.0))[0].tolist() == [12.0, 0.0, 1.0, 0.01]
    generator, wanted, size, sizes = np.random.default_rng(seed), 12.0, 12, []
    for k in range(1, 60):
        movement, expected = generator.uniform(0.0, 2.0), 1.0 - 0.36**k
        wanted = min(max(wanted * math.exp(0.4 * (expected - movement / 1.3)), 12.0), 300.0)
        new = math.floor(wanted + 0.5)
        found = controller.act(seen(k, 0, movement, expected))[0]
        factor = min(max(best_step(new, 10) / best_step(size, 10), 0.5), 2.0)
        assert found.tolist() == [new, 0.0, pytest.approx(factor, abs=1e-9), 0.01]
        size = new
        sizes.append(size)
    assert max(sizes) > 40
    assert len(set(sizes)) > 10


def test_a_restart_begins_with_the_first_size_and_changes_no_step():
    controller = make_controller("psa", LIMITS)
    controller.reset(1)
    for k in range(6):
        grown = controller.act(seen(k, 0, 0.1, 1.0))[0]
    assert grown[0] > 40
    assert controller.act(seen(6, 1, 0.1, 1.0))[0, [0, 2]].tolist() == [10.0, 1.0]
    assert controller.act(seen(7, 1, 0.1, 1.0))[0, 0] == 14  # 10 exp(0.4 (1 - 0.1 / 1.4)) is 14.5


def test_the_size_grows_where_the_function_is_rugged():
    """Function 1 is a sphere, function 3 is Rastrigin's."""
    options = {"iterations": 400, "max_evaluations": 8000, "max_population_size": 300}
    sphere, rugged = (
        run_episodes(
            make_controller("psa", LIMITS), f"metabox-bbob:{number}-10", range(6), "cma-es", **options
        )
        for number in (1, 3)
    )
    assert (sphere.final_fitness < 1e-8).all()
    assert np.nanmax(rugged.sizes, axis=1).mean() > 1.5 * np.nanmax(sphere.sizes, axis=1).mean()


def test_what_the_rule_cannot_have_is_refused():
    refused(lambda: make_controller("psa:threshold=0"), "threshold must lie", error=SettingError)
    refused(
        lambda: run_episodes(make_controller("psa"), "case1", range(1), "firefly", iterations=2),
        "cma-es", error=SettingError,
    )  # fmt: skip
