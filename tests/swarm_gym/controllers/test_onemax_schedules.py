"""Schedules over the share of zeros: decisions by hand, what is shipped, bad input."""

import numpy as np
import pytest

from agents import make_controller
from experiments.studies.onemax.share_schedules import loss
from swarm_gym.comparing.onemax import decisions_on, expected_runtime
from swarm_gym.controllers.onemax_schedules import LAST, NUM_KNOTS, ShareSchedule
from swarm_gym.errors import UnknownNameError
from swarm_gym.reference.onemax.optima import packaged

STEPS = np.arange(NUM_KNOTS, dtype=np.float64)


def decided(schedule, *states):
    """Return the decisions at states (length, ones)."""
    schedule.reset(len(states))
    return schedule.act(np.array(states, dtype=np.float64)).tolist()


def test_logarithms_are_linear_between_knots_and_lambda_is_rounded():
    """The knots are at log2(n / zeros) = 1, 1.75, 2.5, ..., and the k-th one has 2^(k / 2)."""
    schedule = ShareSchedule(STEPS[None] / 2.0)
    # n / zeros: 1 and 2 are at and below the first knot; 4 is a third of the way from knot 1 to knot 2.
    found = decided(schedule, (64, 0), (64, 32), (64, 48), (64, 56), (64, 63))
    places = [0.0, 0.0, 4.0 / 3.0, 8.0 / 3.0, 20.0 / 3.0]
    assert found == [[np.floor(2.0 ** (place / 2.0) + 0.5), 0.0] for place in places]


def test_beyond_the_last_knot_lambda_grows_by_the_root_and_rates_stay():
    schedule = ShareSchedule(
        np.stack([0.0 * STEPS + 3.0, 0.0 * STEPS + 4.0, 0.0 * STEPS - 1.0, 0.0 * STEPS + 0.5])
    )
    zeros = 3
    length = zeros * 2.0 ** (LAST + 4.0)
    before, after = decided(schedule, (2048, 2040), (length, length - zeros))
    np.testing.assert_allclose(before, [8, 0, 16, 0.5, 2**0.5], rtol=1e-12)
    np.testing.assert_allclose(after, [32, 0, 64, 0.5, 2**0.5], rtol=1e-12)


def test_decisions_are_actions_whatever_the_knots_are():
    for value in (-40.0, 40.0):
        decisions = decisions_on(ShareSchedule(np.full((4, NUM_KNOTS), value)), 50)
        assert set(decisions.mutants) == {1 if value < 0 else 512}
        assert set(decisions.children) == {1 if value < 0 else 256}


@pytest.mark.parametrize("size", [100, 200, pytest.param(500, marks=pytest.mark.slow)])
def test_the_schedule_that_ships_is_within_one_per_cent_of_the_optimum_where_it_was_tuned(size):
    found = expected_runtime(make_controller("share:lambda"), size)
    assert (
        packaged(size, "onemax").evaluations < found < 1.01 * packaged(size, "onemax-portfolio").evaluations
    )


@pytest.mark.parametrize("size", [100, pytest.param(1000, marks=pytest.mark.slow)])
def test_the_schedule_of_four_is_below_the_published_rule_of_three(size):
    assert expected_runtime(make_controller("share:four"), size) < 0.96 * expected_runtime(
        make_controller("symbolic"), size
    )


def test_tuning_judges_by_the_expected_runtimes_of_the_controller():
    knots = np.array(make_controller("share:lambda").knots)
    above = [
        np.log(expected_runtime(ShareSchedule(knots), n) / packaged(n, "onemax-portfolio").evaluations)
        for n in (100, 200, 500)
    ]
    assert loss(knots) == pytest.approx(np.mean(above), rel=1e-12)


def test_schedules_are_the_same_by_their_knots():
    assert ShareSchedule(STEPS[None]).identity() == ShareSchedule(STEPS[None].copy()).identity()
    assert ShareSchedule(STEPS[None]).identity() != ShareSchedule(STEPS[None] + 1.0).identity()


@pytest.mark.parametrize(
    "knots",
    [np.zeros(NUM_KNOTS), np.zeros((2, NUM_KNOTS)), np.zeros((1, 3)), np.full((1, NUM_KNOTS), np.nan)],
)
def test_knots_of_another_shape_or_without_a_number_are_refused(knots):
    with pytest.raises(ValueError, match=r"knots: expected finite numbers of shape \(1, 12\)"):
        ShareSchedule(knots)


def test_a_name_that_does_not_ship_is_refused_with_those_that_do():
    with pytest.raises(UnknownNameError, match=r"(?s)four.*lambda|lambda.*four"):
        make_controller("share:beta")
