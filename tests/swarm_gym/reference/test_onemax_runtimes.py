"""Exact expected runtimes on OneMax, against enumeration, simulation and published numbers."""

import itertools

import numpy as np
import pytest

from agents import make_controller
from helpers.bits import OPTIMIZER, simulated_runtimes
from oracles import bit_strings
from oracles.bit_strings import Choice, paired
from swarm_gym.comparing.onemax import decisions_on, expected_runtime
from swarm_gym.errors import ScenarioError, SettingError
from swarm_gym.reference.onemax.runtimes import Choices, LambdaDecisions, expected_runtimes, optimal_control
from swarm_gym.rollout import run_episodes

# Mean and standard error of 1,000 published runs of theory's policy.
PUBLISHED_THEORY = {
    100: (582.6, 3.75), 200: (1233.4, 6.1), 500: (3237.2, 10.6), 1000: (6587.5, 16.8), 2000: (13361.9, 24.6),
}  # fmt: skip
PORTFOLIO = tuple(2**k for k in range(7))

either_count = pytest.mark.parametrize("copies_free", [True, False])


def decisions_of(size, decide):
    """Return the decisions at every number of ones, as the reference takes them."""
    mutants, children, alpha, beta = np.transpose([decide(ones) for ones in range(size)])
    return LambdaDecisions(mutants.astype(np.int64), children.astype(np.int64), alpha, beta)


def varying(ones):
    return (paired(3), Choice(2, 3, 0.5, 1.4), Choice(3, 1, 3.0), Choice(1, 3, 1.7, 0.6))[ones % 4]


# Enumeration.


@either_count
@pytest.mark.parametrize(
    ("size", "decide"),
    [
        (10, lambda _: paired(1)),
        (12, lambda _: paired(2)),
        (11, lambda _: paired(3)),
        (10, lambda _: Choice(3, 2, 0.5, 1.5)),
        (10, lambda _: Choice(1, 3, 2.5, 0.25)),
        (12, varying),
    ],
)
def test_expected_runtimes_are_the_enumerated_ones(size, decide, copies_free):
    found = expected_runtimes(decisions_of(size, decide), copies_free=copies_free)
    np.testing.assert_allclose(found, bit_strings.expectations(size, decide, copies_free), rtol=1e-10)


def test_what_can_never_gain_takes_forever():
    """Flip all bits and take all of them: from more than half the ones nothing is gained."""
    found = expected_runtimes(decisions_of(10, lambda _: Choice(2, 3, 5.0, 3.0)))
    assert np.isinf(found[5:10]).all()
    assert found[[0, 10]].tolist() == [2.0, 0.0]


@either_count
def test_the_optimal_lambda_is_that_of_brute_force(copies_free):
    sizes = (1, 2, 3)
    later, decisions = optimal_control(10, Choices(sizes), copies_free=copies_free)
    expected, best = bit_strings.least_expectations(10, [paired(size) for size in sizes], copies_free)
    np.testing.assert_allclose(later, expected, rtol=1e-10)
    assert decisions.mutants.tolist() == [choice.mutants for choice in best]
    np.testing.assert_array_equal(decisions.children, decisions.mutants)


@either_count
def test_the_four_optimal_parameters_are_those_of_brute_force(copies_free):
    """Compare the values; decisions that are equally good may differ, so compare what they are worth."""
    mutants, children, alpha, beta = (1, 2, 3), (1, 2, 3), (0.3, 1.0, 4.0), (0.5, 1.0, 2.0)
    later, decisions = optimal_control(10, Choices(mutants, children, alpha, beta), copies_free=copies_free)
    grid = [Choice(m, c, a, b) for m in mutants for c in children for a in alpha for b in beta]
    expected, _ = bit_strings.least_expectations(10, grid, copies_free)
    np.testing.assert_allclose(later, expected, rtol=1e-10)
    np.testing.assert_allclose(expected_runtimes(decisions, copies_free=copies_free), expected, rtol=1e-10)
    assert len(set(zip(*(getattr(decisions, name).tolist() for name in vars(decisions)), strict=True))) > 1


# Consistency at sizes that nobody can enumerate.


@either_count
def test_no_fixed_control_is_below_the_optimum_anywhere(copies_free):
    choices = (1, 2, 3, 4, 6, 9)
    later, decisions = optimal_control(80, Choices(choices), copies_free=copies_free)
    np.testing.assert_allclose(expected_runtimes(decisions, copies_free=copies_free), later, rtol=1e-12)
    for size in choices:
        fixed = expected_runtimes(LambdaDecisions.of_size(np.full(80, size)), copies_free=copies_free)
        assert (later <= fixed * (1 + 1e-12)).all()
        assert later[40] < fixed[40]


def test_no_control_of_four_parameters_is_below_their_optimum():
    choices = Choices((1, 3), (1, 8), (0.5, 1.0), (1.0, 2.0))
    later, _ = optimal_control(60, choices, start=30)
    for values in itertools.product(choices.mutants, choices.children, choices.strength, choices.bias):
        fixed = expected_runtimes(decisions_of(60, lambda _, values=values: Choice(*values)), 30)
        assert later[30] < fixed[30]
    assert np.isnan(later[:30]).all()


def test_more_choices_are_never_worse_and_all_children_never_cheaper():
    few, many = (optimal_control(60, Choices(sizes), 30)[0][30:] for sizes in ((1, 4), (1, 2, 4, 8)))
    assert (many <= few).all()
    free, all_count = (optimal_control(60, Choices((1, 2, 4)), 30, one)[0][30:60] for one in (True, False))
    assert (free < all_count).all()


def test_a_start_leaves_the_numbers_above_it_as_they_are():
    decisions = LambdaDecisions.of_size(np.full(50, 3))
    whole, half = expected_runtimes(decisions), expected_runtimes(decisions, 25)
    np.testing.assert_array_equal(whole[25:], half[25:])
    assert np.isnan(half[:25]).all()


# Simulation.


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("theory", marks=pytest.mark.slow),
        "static:mutants=4,children=12,strength=1.5,bias=1.2",
        pytest.param("symbolic", marks=pytest.mark.slow),
        pytest.param("optimal:onemax", marks=pytest.mark.slow),
    ],
)
def test_expected_runtimes_are_the_simulated_means(name):
    controller = make_controller(name)
    runs = run_episodes(controller, "onemax:100", range(1000), OPTIMIZER, iterations=3000)
    assert (runs.final_fitness == 0.0).all()
    error = runs.evaluations.std(ddof=1) / np.sqrt(1000)
    assert abs(runs.evaluations.mean() - expected_runtime(controller, 100)) < 3.5 * error


@pytest.mark.parametrize("count", [60, pytest.param(250, marks=pytest.mark.slow)])
def test_expected_runtimes_are_the_means_on_strings(count):
    """Compare with bit strings at a length that nobody can enumerate, in both ways to count."""
    for copies_free in (True, False):
        runs = bit_strings.runtimes(3, count, 30, varying, copies_free)
        expected = expected_runtimes(decisions_of(30, varying), copies_free=copies_free)[15] + 1.0
        assert abs(runs.mean() - expected) < 4.0 * runs.std(ddof=1) / np.sqrt(count)


def test_expected_runtimes_are_the_simulated_means_where_all_children_count():
    runs = simulated_runtimes(600, "onemax:60-start:20", lambda _: paired(4), seed=1, counting="all")
    expected = expected_runtime(make_controller("static:mutants=4,children=4"), 60, 20, copies_free=False)
    assert abs(runs.mean() - expected) < 3.5 * runs.std(ddof=1) / np.sqrt(600)


# Published numbers.


@pytest.mark.parametrize("size", PUBLISHED_THEORY)
def test_theory_has_its_published_runtime(size):
    mean, error = PUBLISHED_THEORY[size]
    assert abs(expected_runtime(make_controller("theory"), size) - mean) < 2.0 * error


@pytest.mark.parametrize(
    ("size", "least"),
    [(100, 541.4), (200, 1132.8), pytest.param(500, 2973.8, marks=pytest.mark.slow)],
)
def test_the_optimum_of_the_published_choices_is_that_of_the_prototype(size, least):
    later, _ = optimal_control(size, Choices(PORTFOLIO), size // 2)
    assert later[size // 2] + 1.0 == pytest.approx(least, abs=0.1)


# Controllers.


def test_the_decisions_of_a_controller_are_those_that_it_takes_in_the_environment():
    controller = make_controller("symbolic")
    decisions = decisions_on(controller, 100)
    assert decisions.mutants[[0, 50, 95, 96, 99]].tolist() == [1, 1, 1, 5, 10]
    assert decisions.children[[0, 50, 96, 99]].tolist() == [2, 2, 10, 20]
    assert decisions.strength[[0, 95, 96]].tolist() == [0.001, 0.001, 1.0]
    runs = run_episodes(controller, "onemax:100-start:96", range(20), OPTIMIZER, iterations=1)
    assert set(runs.sizes[:, 0]) == {5}


def test_a_start_is_counted_from_and_one_out_of_range_is_refused():
    theory = make_controller("theory")
    assert expected_runtime(theory, 50, 50) == 1.0
    assert expected_runtime(theory, 50, 0) > expected_runtime(theory, 50) > expected_runtime(theory, 50, 49)
    assert expected_runtime(theory, 50) == expected_runtime(theory, 50, 25)
    for start in (-2, 51):
        with pytest.raises(ScenarioError, match=rf"\b0 to 50, got {start}"):
            expected_runtime(theory, 50, start)
    with pytest.raises(ScenarioError, match="10 to 100000, got 9"):
        expected_runtime(theory, 9)


def test_a_controller_that_sees_more_is_refused():
    with pytest.raises(SettingError, match=r"'rich'.*theory"):
        expected_runtime(make_controller("diversity-ladder"), 100)
