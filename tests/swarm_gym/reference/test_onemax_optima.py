"""Optimal controls of OneMax that ship with the package."""

import numpy as np
import pytest

from swarm_gym.errors import ScenarioError, UnknownNameError
from swarm_gym.reference.onemax import optima
from swarm_gym.reference.onemax.optima import (
    CHOICES,
    COUNTINGS,
    compute,
    is_packaged,
    packaged,
)
from swarm_gym.reference.onemax.runtimes import LambdaDecisions, expected_runtimes

# Expected evaluations under the published choices of lambda, from a prototype.
KNOWN = {100: 541.4, 200: 1132.8, 500: 2973.8, 1000: 6084.7, 2000: 12387.7}

SHIPPED = [
    pytest.param(size, *key, marks=pytest.mark.slow if size > 500 else ())
    for key, sizes in optima.SHIPPED.items()
    for size in sizes
]


def test_optima_ship_for_the_lengths_that_are_named():
    named = {(size, *key) for key, sizes in optima.SHIPPED.items() for size in sizes}
    assert named == {(size, choices, counting) for choices, counting, size in optima._packaged()}
    assert not is_packaged(51, "onemax")


@pytest.mark.parametrize(("size", "choices", "counting"), SHIPPED)
def test_packaged_decisions_have_the_packaged_runtime(size, choices, counting):
    optimum = packaged(size, choices, counting)
    start = size // 2
    later = expected_runtimes(optimum.decisions, start, counting == "copies-free")
    assert later[start] + 1.0 == pytest.approx(optimum.evaluations, abs=1e-4)


@pytest.mark.parametrize(("size", "choices", "counting"), SHIPPED)
def test_packaged_decisions_are_among_the_choices(size, choices, counting):
    decisions, chosen = packaged(size, choices, counting).decisions, CHOICES[choices]
    assert {len(column) for column in vars(decisions).values()} == {size}
    assert set(decisions.mutants.tolist()) <= set(chosen.mutants)
    assert set(decisions.children.tolist()) <= set(chosen.children or chosen.mutants)
    assert set(decisions.strength.tolist()) <= set(chosen.strength)
    assert set(decisions.bias.tolist()) <= set(chosen.bias)
    if not chosen.children:
        np.testing.assert_array_equal(decisions.children, decisions.mutants)


@pytest.mark.parametrize("size", [size for size in KNOWN if is_packaged(size, "onemax-portfolio")])
def test_packaged_optima_of_the_published_choices_are_those_of_the_prototype(size):
    assert packaged(size, "onemax-portfolio").evaluations == pytest.approx(KNOWN[size], abs=0.1)


@pytest.mark.parametrize("counting", COUNTINGS)
def test_choices_that_include_others_are_never_worse(counting):
    few, all_sizes, four = (
        packaged(100, name, counting).evaluations for name in ("onemax-portfolio", "onemax", "onemax-four")
    )
    assert four < all_sizes < few
    assert packaged(100, "onemax-four-published", counting).evaluations < few


def test_no_constant_lambda_reaches_the_packaged_optimum():
    best = packaged(100, "onemax").evaluations
    for size in (1, 2, 3, 5, 8, 64):
        assert expected_runtimes(LambdaDecisions.of_size(np.full(100, size)), 50)[50] + 1.0 > best + 1.0


@pytest.mark.parametrize(("choices", "counting"), [("onemax", "all"), ("onemax-portfolio", "copies-free")])
def test_what_ships_is_what_is_computed(choices, counting):
    computed, stored = compute(50, choices, counting), packaged(50, choices, counting)
    assert computed.evaluations == pytest.approx(stored.evaluations, abs=1e-5)
    np.testing.assert_array_equal(computed.decisions.mutants, stored.decisions.mutants)
    assert set(computed.decisions.mutants[:25]) == {computed.decisions.mutants[25]}


def test_what_does_not_ship_is_refused_with_what_does():
    with pytest.raises(ScenarioError, match=r"n = 50, 100, .*got n = 51; .*compute"):
        packaged(51, "onemax")
    with pytest.raises(ScenarioError, match="no length"):
        packaged(50, "some")
    with pytest.raises(UnknownNameError, match=r"'some'.*onemax-portfolio"):
        compute(50, "some")
    with pytest.raises(UnknownNameError, match=r"'some'.*copies-free"):
        compute(50, "onemax", "some")
