"""Expected runtimes of the one-fifth rule, against enumeration, simulation and published numbers."""

import math

import numpy as np
import pytest

from agents import make_controller
from helpers.bits import OPTIMIZER
from helpers.slow import slow_but
from oracles import bit_strings
from oracles.bit_strings import Choice
from swarm_gym.comparing.onemax import decisions_on, expected_runtime
from swarm_gym.errors import SettingError
from swarm_gym.reference.onemax.adaptive import Ladder, ladder_runtimes
from swarm_gym.reference.onemax.runtimes import LambdaDecisions, expected_runtimes
from swarm_gym.rollout import run_episodes

# Mean and standard error of 1,000 published runs of the one-fifth rule.
PUBLISHED = {100: (619.724, 4.09), 200: (1308.223, 6.88), 500: (3371.872, 11.10)}

RUNGS = (Choice(1, 1), Choice(1, 2, 1.6, 0.8), Choice(2, 2), Choice(3, 2, 0.7, 1.3))


def ladder_of(choices, size, fall, last=None):
    """Return a ladder of choices whose last rung is the same for all numbers of ones, or as given."""
    mutants, children, alpha, beta = np.transpose(choices)
    rungs = LambdaDecisions(mutants.astype(np.int64), children.astype(np.int64), alpha, beta)
    return Ladder(rungs, np.full(size, len(choices) - 1) if last is None else np.array(last), fall)


def enumerated(choices, size, fall, last, copies_free):
    """Return the expected evaluations by rung and ones: one system of linear equations for all rungs."""
    later = np.zeros((len(choices), size + 1))
    for ones in range(size - 1, -1, -1):
        count = last[ones] + 1
        left, right = np.eye(count), np.zeros(count)
        for rung, choice in enumerate(choices[:count]):
            outcomes = bit_strings.outcomes(size, ones, choice, copies_free)
            for (gain, evaluations), share in outcomes.items():
                right[rung] += share * evaluations
                if gain > 0:
                    right[rung] += share * later[max(rung - fall, 0), ones + gain]
                else:
                    left[rung, min(rung + 1, count - 1)] -= share
        later[:count, ones] = np.linalg.solve(left, right)
        later[count:, ones] = np.nan
    return later


@pytest.mark.parametrize("copies_free", [True, False])
@pytest.mark.parametrize("fall", [1, 2])
@pytest.mark.parametrize("last", [[3] * 10, [0, 0, 1, 1, 1, 2, 2, 2, 3, 3]])
def test_expected_runtimes_are_the_enumerated_ones(fall, last, copies_free):
    found = ladder_runtimes(ladder_of(RUNGS, 10, fall, last), copies_free=copies_free)
    np.testing.assert_allclose(found, enumerated(RUNGS, 10, fall, last, copies_free), rtol=1e-10)


def test_a_ladder_of_one_rung_is_a_constant_control():
    found = ladder_runtimes(ladder_of([Choice(4, 6, 1.2, 0.9)], 60, 4), start=20)
    decisions = LambdaDecisions(np.full(60, 4), np.full(60, 6), np.full(60, 1.2), np.full(60, 0.9))
    np.testing.assert_allclose(found[0], expected_runtimes(decisions, 20), rtol=1e-12)


@pytest.mark.parametrize("last", [[*[3] * 9, 2], [4] * 10, [-1] * 10])
def test_a_last_rung_that_falls_or_does_not_exist_is_refused(last):
    with pytest.raises(ValueError, match=r"last: expected rungs from 0 to 3 that never fall.*got \["):
        ladder_of(RUNGS, 10, 4, last)


# The one-fifth rule.


def test_the_ladder_has_the_decisions_of_the_rule_while_nothing_is_gained():
    """Let the rule climb to the length of 12, where 1.5^(24 / 4) = 11.4 is the last value below."""
    controller = make_controller("one-fifth")
    controller.reset(1)
    climbed = np.array([controller.act(np.array([[12.0, 6.0]]))[0] for _ in range(28)])
    ladder = controller.ladder(12)
    assert len(ladder.rungs.mutants) == 26
    assert ladder.last[-1] == 25
    assert (controller.ladder(12, math.inf).last == 25).all()
    np.testing.assert_array_equal(climbed[:26, 0], ladder.rungs.mutants)
    np.testing.assert_array_equal(climbed[:26, 2], ladder.rungs.children)
    np.testing.assert_allclose(climbed[:26, 3], ladder.rungs.strength, rtol=1e-12)
    np.testing.assert_array_equal(climbed[25:, :3], np.tile([12.0, 0.0, 12.0], (3, 1)))


def test_a_gain_leads_down_by_the_factor():
    for factor in (1.5, 3.0):
        controller = make_controller(f"one-fifth:factor={factor}")
        rungs = controller.ladder(200).rungs
        sizes = rungs.mutants * rungs.strength
        assert controller.ladder(200).fall == 4
        np.testing.assert_allclose(sizes[4:-1], factor * sizes[:-5], rtol=1e-12)


def test_the_end_of_the_ladder_hardly_matters():
    controller = make_controller("one-fifth")
    found = [ladder_runtimes(controller.ladder(100, reach), 50)[0, 50] for reach in (4.0, 10.0, math.inf)]
    assert found[1] == pytest.approx(found[2], rel=1e-5)
    assert found[0] != pytest.approx(found[2], rel=1e-4)


@pytest.mark.parametrize("name", slow_but(["one-fifth:factor=3"], ["one-fifth", "one-fifth:factor=3"]))
def test_the_expected_runtime_is_the_simulated_mean(name):
    controller = make_controller(name)
    runs = run_episodes(controller, "onemax:60", range(1000), OPTIMIZER, iterations=3000)
    assert (runs.final_fitness == 0.0).all()
    error = runs.evaluations.std(ddof=1) / np.sqrt(1000)
    assert abs(runs.evaluations.mean() - expected_runtime(controller, 60)) < 3.5 * error


@pytest.mark.parametrize("size", [100, 200, pytest.param(500, marks=pytest.mark.slow)])
def test_the_rule_has_its_published_runtime(size):
    mean, error = PUBLISHED[size]
    assert abs(expected_runtime(make_controller("one-fifth"), size) - mean) < 2.0 * error


def test_the_rule_has_no_decisions_by_the_number_of_ones():
    with pytest.raises(SettingError, match=r"one-fifth.*remembers its lambda.*expected_runtime"):
        decisions_on(make_controller("one-fifth"), 50)
