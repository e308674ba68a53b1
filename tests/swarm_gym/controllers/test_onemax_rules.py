"""Rules of the (1 + (lambda, lambda)) genetic algorithm: decisions by hand, names, refusals, identity."""

import math

import numpy as np
import pytest

from agents import SizeLimits, make_controller
from helpers.bits import OPTIMIZER
from swarm_gym.controllers.onemax_rules import RULES
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError, SettingError, UnknownNameError
from swarm_gym.reference.onemax.optima import CHOICES, packaged

NAMES = {
    "theory": ["theory"],
    "one-fifth": ["one-fifth", "one-fifth:factor=2"],
    "symbolic": ["symbolic"],
    "static": ["static", "static:mutants=3,children=5,strength=0.5,bias=2"],
    "optimal": ["optimal:onemax", "optimal:onemax-four"],
}
EVERY_NAME = [name for names in NAMES.values() for name in names]


def decided(name, *states):
    """Return the decisions at states (length, ones)."""
    controller = make_controller(name)
    controller.reset(len(states))
    return controller.act(np.array(states, dtype=np.float64)).tolist()


def test_there_are_names_of_all_rules():
    assert NAMES.keys() == RULES.keys()


# Decisions.


def test_theory_is_the_root_of_n_over_the_zeros_and_halves_go_down():
    states = [(100, 0), (100, 50), (100, 75), (100, 96), (100, 99), (2000, 1999), (45, 25), (49, 45)]
    # sqrt(45 / 20) is 1.5, and sqrt(49 / 4) is 3.5.
    expected = [1, 1, 2, 5, 10, 45, 1, 3]
    assert decided("theory", *states) == [[size, 0.0] for size in expected]


def test_symbolic_crosses_over_alone_until_0_95_n_and_then_follows_theory():
    found = decided("symbolic", (100, 0), (100, 75), (100, 95), (100, 96), (200, 199))
    assert found == [
        [1, 0, 2, 0.001, 1], [1, 0, 4, 0.001, 1], [1, 0, 8, 0.001, 1], [5, 0, 10, 1, 1], [14, 0, 28, 1, 1],
    ]  # fmt: skip


def test_static_decides_what_its_name_says():
    assert decided("static", (100, 3), (50, 49)) == [[8, 0, 32, 1, 1]] * 2
    assert decided("static:mutants=3,children=5,strength=0.5,bias=2", (100, 3)) == [[3, 0, 5, 0.5, 2]]


@pytest.mark.parametrize("choices", ["onemax", "onemax-four"])
def test_optimal_decides_what_is_packaged_for_each_length(choices):
    states = [(50, 25), (100, 99), (50, 49), (100, 60), (100, 3)]
    for (size, ones), found in zip(states, decided(f"optimal:{choices}", *states), strict=True):
        decisions = packaged(size, choices).decisions
        columns = (decisions.mutants, decisions.children, decisions.strength, decisions.bias)
        assert found == [float(columns[0][ones]), 0.0, *(float(column[ones]) for column in columns[1:])]


def one_fifth_by_hand(factor, length, ones_seen):
    """Return the actions that the rule takes when it sees these numbers of ones, one after the other."""
    size, actions = 1.0, []
    for before, ones in zip([None, *ones_seen], ones_seen, strict=False):
        if before is not None:
            size = max(size / factor, 1.0) if ones > before else min(size * factor**0.25, length)
        whole = math.floor(size)
        actions.append([whole, 0.0, whole, size / whole, 1.0])
    return actions


@pytest.mark.parametrize("factor", [1.5, 2.0, 10.0])
def test_one_fifth_divides_after_a_gain_and_grows_by_the_fourth_root_otherwise(factor):
    ones = [5, 5, 5, 5, 6, 6, 8, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9]
    controller = make_controller(f"one-fifth:factor={factor}")
    controller.reset(1)
    found = [controller.act(np.array([[10.0, one]]))[0].tolist() for one in ones]
    np.testing.assert_allclose(found, one_fifth_by_hand(factor, 10, ones), rtol=1e-12)
    assert max(action[0] for action in found) > 2
    if factor == 10.0:
        assert found[-1] == [10, 0, 10, 1, 1]  # not above the length


def test_one_fifth_forgets_at_the_beginning_of_an_episode():
    """Let one of two swarms begin again, as a vector environment does: it falls to fewer ones."""
    controller = make_controller("one-fifth:factor=10")
    controller.reset(2)
    for _ in range(4):
        before = controller.act(np.array([[50.0, 30.0], [50.0, 30.0]]))
    assert before[:, 0].tolist() == [5, 5]
    after = controller.act(np.array([[50.0, 25.0], [50.0, 30.0]]))
    assert after[0].tolist() == [1, 0, 1, 1, 1]
    assert after[1, 0] == 9
    longer = controller.act(np.array([[90.0, 45.0], [50.0, 30.0]]))  # a longer string has more ones at once
    assert longer[:, 0].tolist() == [1, 17]
    controller.reset(2)
    assert controller.act(np.array([[50.0, 30.0]] * 2))[:, 0].tolist() == [1, 1]


@pytest.mark.parametrize("name", EVERY_NAME)
def test_the_state_after_the_last_step_is_decided_for_too(name):
    """Ask at the optimum, where formulas divide by zero, but vector environments ask once more."""
    assert np.isfinite(decided(name, (50, 50))).all()


@pytest.mark.parametrize("name", EVERY_NAME)
def test_swarms_are_decided_for_independently(name):
    generator = np.random.default_rng(0)
    lengths = generator.choice([50.0, 100.0], 6)
    steps = [
        np.stack([lengths, np.floor(lengths * share)], axis=1)
        for share in np.sort(generator.uniform(0.5, 1.0, (12, 6)), axis=0)
    ]
    together = make_controller(name)
    together.reset(6)
    decisions = np.stack([together.act(step) for step in steps])
    for row in range(6):
        alone = make_controller(name)
        alone.reset(1)
        np.testing.assert_array_equal(
            decisions[:, row], [alone.act(step[row : row + 1])[0] for step in steps]
        )


@pytest.mark.parametrize(
    "name", [*EVERY_NAME, "static:mutants=512,children=256,strength=32,bias=4", "one-fifth:factor=10"]
)
@pytest.mark.parametrize("size", [50, 100])
def test_every_decision_is_an_action_of_its_environment(name, size):
    controller = make_controller(name)
    env = SwarmEnv(OPTIMIZER, scenario=f"onemax:{size}", iterations=3000, **controller.env_options())
    controller.reset(1)
    observation, _ = env.reset(seed=1)
    ended = False
    while not ended:
        action = controller.act(observation[None])[0]
        assert action in env.action_space
        observation, _, ended, _, info = env.step(action)
    assert info["best_fitness"] == 0.0


@pytest.mark.parametrize("name", ["theory", "symbolic", "one-fifth:factor=10"])
def test_decisions_on_the_longest_strings_are_actions_too(name):
    controller = make_controller(name)
    env = SwarmEnv(OPTIMIZER, scenario="onemax:100000", iterations=1, **controller.env_options())
    controller.reset(3)
    for _ in range(60):
        actions = controller.act(np.array([[1e5, 99_999.0], [1e5, 95_001.0], [1e5, 0.0]]))
        assert all(action in env.action_space for action in actions)


# Names.


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("theory:factor=2", "unknown parameter 'factor'"),
        ("symbolic:x", "unknown parameter 'x'"),
        ("one-fifth:factor=1", r"factor must lie in \[1.01, 10\], got 1.0; valid: factor"),
        ("one-fifth:factor=nan", "factor must lie"),
        ("one-fifth:factor=2,factor=3", "given twice"),
        ("one-fifth:grow=2", "unknown parameter 'grow'.*factor in"),
        ("static:mutants=0", "mutants must lie"),
        ("static:mutants=2.5", "mutants must be an integer"),
        ("static:children=257", "children must lie"),
        ("static:strength=0", "strength must lie"),
        ("static:bias=-1", "bias must lie"),
        ("static:bias=4.5", "bias must lie"),
    ],
)
def test_parameters_that_cannot_be_are_refused(name, message):
    with pytest.raises(SettingError, match=message):
        make_controller(name)


def test_unknown_choices_are_refused_with_the_known_ones():
    for name in ("optimal:two", "optimal"):
        with pytest.raises(UnknownNameError, match=r"choices.*onemax-portfolio"):
            make_controller(name)
    assert make_controller("optimal:onemax-portfolio").choices in CHOICES


def test_lengths_without_a_packaged_optimum_are_refused_with_those_that_have_one():
    with pytest.raises(ScenarioError, match=r"optimal:onemax.*n = 50, 100, .*got n = 51"):
        decided("optimal:onemax", (51, 30))


@pytest.mark.parametrize("limits", [SizeLimits(2, 200), SizeLimits(1, 10)])
def test_rules_need_sizes_from_1_and_their_own_optimizer(limits):
    options = make_controller("theory", limits).env_options()
    assert (options["min_population_size"], options["max_population_size"]) == (1, 512)
    assert options["made_for"] == OPTIMIZER
    assert options["observation"] == "theory"


def test_rules_that_differ_have_other_identities_and_equal_ones_the_same():
    names = [*EVERY_NAME, "static:mutants=9", "static:bias=0.5", "optimal:onemax-portfolio"]
    identities = [repr(make_controller(name).identity()) for name in names]
    assert len(set(identities)) == len(names)
    assert make_controller("one-fifth").identity() == make_controller("one-fifth:factor=1.5").identity()
    assert identities == [repr(make_controller(name).identity()) for name in names]
