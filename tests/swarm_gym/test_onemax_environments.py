"""Environments on bit strings: bits, ends, rewards, observations, refusals, gaps."""

import math
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from test_dynamic_environments import copied

from agents import make_controller
from helpers.bits import OPTIMIZER
from swarm_gym.action import ACTIONS
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, SettingError
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import get_optimizer
from swarm_gym.registration import environment_id
from swarm_gym.reward import NEED_A_BUDGET, NEED_AN_OPTIMUM, NEED_BITS, NEED_ROBOTS, REWARDS
from swarm_gym.rollout import run_episodes
from swarm_gym.vector_env import SwarmVectorEnv

SMALL = {"iterations": 300, "max_population_size": 20}
OF_BITS = ("theory", "theory-scaled")


def small(scenario="onemax:30", **options):
    return SwarmEnv(OPTIMIZER, scenario=scenario, **{**SMALL, **options})


def finish(env, action=(3.0, 0.0), seed=0):
    """Run one episode; return the sum of rewards, and what the last step returned."""
    env.reset(seed=seed)
    total, last, ended = 0.0, None, False
    while not ended:
        last = env.step(np.array(action))
        total += last[1]
        ended = last[2] or last[3]
    return total, last


# Episodes.


def test_defaults_are_the_published_ones():
    settings = small(iterations=5).simulation.settings
    made = gymnasium.make("swarm_gym/OnePlusLambdaLambda-v0").unwrapped.simulation.settings
    assert made.scenarios[0].name == "onemax:100"
    assert (made.initial_population_size, made.min_population_size, made.max_population_size) == (1, 1, 512)
    assert (made.observation, made.reward, made.iterations) == ("theory", "runtime", 20_000)
    assert (settings.iterations, settings.max_population_size, settings.reward) == (5, 20, "runtime")
    assert environment_id(OPTIMIZER) == "swarm_gym/OnePlusLambdaLambda-v0"


@pytest.mark.parametrize("observation", [*OF_BITS, "paper", "priced", "theory+scaled"])
@pytest.mark.parametrize("action", ["normalised", "extended-normalised"])
def test_gymnasium_checker_passes(observation, action):
    options = {**SMALL, "scenario": "onemax:30", "iterations": 20}
    env = gymnasium.make(environment_id(OPTIMIZER), action=action, observation=observation, **options)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env.unwrapped)
    assert [text for text in (str(w.message) for w in caught) if "precision lowered" not in text] == []


@pytest.mark.parametrize("make", [gymnasium.make, gymnasium.make_vec])
def test_gymnasium_makes_it_without_a_warning(make, recwarn):
    env = make(environment_id(OPTIMIZER), scenario="onemax:20", **SMALL)
    env.reset(seed=0)
    env.step(np.array([2.0, 0.0]) if make is gymnasium.make else np.array([[2.0, 0.0]]))
    assert [str(w.message) for w in recwarn] == []


def test_an_episode_begins_with_half_the_ones_for_one_evaluation():
    for scenario, ones in (("onemax:31", 15), ("onemax:30-start:4", 4)):
        observation, info = small(scenario).reset(seed=0)
        assert observation[1] == ones
        assert (info["best_fitness"], info["evaluations"]) == (observation[0] - ones, 1)
        assert info["best_path"].tolist() == [[1.0, ones]]


@pytest.mark.parametrize("seed", range(5))
def test_an_episode_ends_terminated_at_the_optimum_and_not_before(seed):
    env = small()
    observation, _ = env.reset(seed=seed)
    ended = False
    while not ended:
        assert observation[1] < 30
        observation, _, ended, truncated, info = env.step(np.array([3.0, 0.0]))
        assert not truncated
    assert observation.tolist() == [30.0, 30.0]
    assert info["best_fitness"] == 0.0


def test_a_string_of_ones_needs_nothing_more():
    """Begin at the optimum: the first step ends the episode for nothing."""
    env = small("onemax:30-start:30")
    env.reset(seed=0)
    _, reward, ended, _, info = env.step(np.array([3.0, 0.0]))
    assert (reward, ended, info["evaluations"]) == (0.0, True, 1)


@pytest.mark.parametrize("budget", [1, 2, 20, 41])
def test_a_budget_ends_the_episode_and_is_never_exceeded(budget):
    env = small("onemax:100", max_evaluations=budget)
    total, (observation, _, ended, truncated, info) = finish(env)
    assert ended != truncated
    assert info["evaluations"] == budget
    assert observation[1] < 100
    assert total * 100 == pytest.approx(1 - budget)


def test_too_few_iterations_end_the_episode():
    _, (observation, _, ended, truncated, _) = finish(small("onemax:100", iterations=3))
    assert ended or truncated
    assert observation[1] < 100


@pytest.mark.parametrize("counting", ["copies-free", "all"])
def test_rewards_add_up_to_the_evaluations_of_all_iterations_by_the_length(counting):
    for seed in range(3):
        total, (*_, info) = finish(small(counting=counting), seed=seed)
        assert total * 30 == pytest.approx(1 - info["evaluations"])
    options = {**SMALL, "counting": counting}
    runs = run_episodes(make_controller("theory"), "onemax:40", range(4), OPTIMIZER, **options)
    np.testing.assert_allclose(runs.returns * 40, 1 - runs.evaluations)


# Bits.


def decisions(seed, num=40):
    """Return actions of all four parameters."""
    low, high = [1, 0, 1, 0.001, 0.1], [20, 0, 40, 5.0, 4.0]
    return np.random.default_rng(seed).uniform(low, high, (num, 5))


@copied
def test_same_seed_same_bits_in_a_vector_and_after_copying(duplicate):
    width, scenarios = 4, ["onemax:60", "onemax:80-start:11"]
    options = {**SMALL, "scenario": scenarios, "action": "extended"}
    vector = SwarmVectorEnv(width, OPTIMIZER, autoreset_mode=AutoresetMode.DISABLED, **options)
    vector.reset(seed=5)
    steps = [vector.step(np.stack([decisions(5 + b)[k] for b in range(width)])) for k in range(10)]
    for row in range(width):
        env = small(scenarios, action="extended")
        env.reset(seed=5 + row)
        for k, action in enumerate(decisions(5 + row, 10)):
            if k == 5:
                env = duplicate(env)
            observation, reward, *_, info = env.step(action)
            np.testing.assert_array_equal(observation, steps[k][0][row])
            assert reward == steps[k][1][row]
            for name in ("evaluations", "best_fitness", "scenario"):
                assert info[name] == steps[k][4][name][row]


def test_results_do_not_depend_on_the_number_of_threads(numba_threads):
    found = []
    for num_threads in {1, numba_threads}:
        env = SwarmVectorEnv(7, OPTIMIZER, scenario="onemax:50", num_threads=num_threads, **SMALL)
        env.reset(seed=3)
        found.append([env.step(np.tile([5.0, 0.0], (7, 1)))[0] for _ in range(30)])
    for other in found[1:]:
        np.testing.assert_array_equal(found[0], other)


def test_episodes_of_a_vector_begin_again_at_the_start():
    env = SwarmVectorEnv(5, OPTIMIZER, scenario="onemax:20", autoreset_mode="SameStep", **SMALL)
    env.reset(seed=0)
    ended = np.zeros(5, dtype=int)
    for _ in range(200):
        observations, _, terminated, _, info = env.step(np.tile([4.0, 0.0], (5, 1)))
        ended += terminated
        for row in np.flatnonzero(terminated):
            assert observations[row].tolist() == [20.0, 10.0]
            assert info["final_obs"][row].tolist() == [20.0, 20.0]
    assert ended.min() >= 2


# Observations.


def test_theory_shows_length_and_ones_and_theory_scaled_the_share_of_zeros():
    env = small("onemax:40-start:25", observation="theory+theory-scaled")
    observation, _ = env.reset(seed=0)
    expected = [40, 25, 15 / 40, math.log(40 / 15)]
    np.testing.assert_allclose(observation, expected, rtol=1e-6)
    _, (observation, *_) = finish(env)
    np.testing.assert_allclose(observation, [40, 40, 0, math.log(40)], rtol=1e-6)


def test_observations_of_the_longest_strings_are_in_the_space():
    for layout in OF_BITS:
        for start in (0, 99_999, 100_000):
            env = small(f"onemax:100000-start:{start}", observation=layout, iterations=1)
            observation, _ = env.reset(seed=0)
            assert observation in env.observation_space
            raw = OBSERVATIONS[layout].observe(env.simulation)[0]
            np.testing.assert_allclose(raw, observation, rtol=1e-6)  # nothing is cut off


@pytest.mark.parametrize("layout", OF_BITS)
@pytest.mark.parametrize("scenario", ["case1", "rooms:0", "function:rastrigin-2"])
def test_layouts_of_bits_refuse_other_scenarios_by_name(layout, scenario):
    with pytest.raises(SettingError, match=rf"'{layout}'.*{scenario}.*onemax:100"):
        SwarmEnv(scenario=scenario, observation=layout)


# Actions.


@pytest.mark.parametrize("layout", ["natural", "extended"])
def test_a_repair_degree_is_refused_by_name_in_natural_layouts(layout):
    env = small(action=layout)
    env.reset(seed=0)
    more = [2.0, 1.0, 1.0] if layout == "extended" else []
    with pytest.raises(ActionError, match=r"repair degree must lie in \[0, 0\], got 0.5"):
        env.step(np.array([3.0, 0.5, *more]))
    env.step(np.array([3.0, 0.0, *more]))


@pytest.mark.parametrize("layout", ["normalised", "extended-normalised"])
def test_a_repair_degree_has_no_effect_in_scaled_layouts(layout):
    steps = []
    for repair in (-1.0, 0.3, 1.0):
        env = small(action=layout)
        env.reset(seed=0)
        more = [0.1, 0.2, 0.3] if layout.startswith("extended") else []
        steps.append([env.step(np.array([-0.2, repair, *more], dtype=np.float32)) for _ in range(20)])
        assert (env.simulation.history[0, :21, env.simulation.columns.index("repair_degree")] == 0.0).all()
    for other in steps[1:]:
        for one, two in zip(steps[0], other, strict=True):
            np.testing.assert_array_equal(one[0], two[0])
            assert one[1] == two[1]


def test_actions_of_other_layouts_are_read():
    """Check that each layout which needs no source has a valid middle action."""
    for name in ACTIONS:
        if name.startswith("sourced"):
            with pytest.raises(SettingError, match="sourced"):
                small(action=name)
            continue
        env = small(action=name, max_evaluations=5000)
        env.reset(seed=0)
        space = env.action_space
        _, reward, *_ = env.step((space.low + space.high) / 2)
        assert reward < 0.0


def test_decided_parameters_are_those_of_the_published_action():
    env = small(action="extended")
    assert list(get_optimizer(OPTIMIZER).decided_parameters()) == ["children", "strength", "bias"]
    assert env.action_space.shape == (5,)


# Rewards and gaps.


def test_the_reward_runtime_is_refused_without_bits():
    for scenario in ("case1", "function:booth-2"):
        with pytest.raises(SettingError, match=rf"'runtime'.*onemax:100.*{scenario}"):
            SwarmEnv(scenario=scenario, reward="runtime")


@pytest.mark.parametrize("reward", REWARDS)
def test_rewards_that_need_an_optimum_of_fitness_or_robots_are_refused(reward):
    if reward in NEED_AN_OPTIMUM + NEED_ROBOTS:
        with pytest.raises(SettingError, match=f"'{reward}'.*onemax:100"):
            small("onemax:100", reward=reward)
        return
    budget = {"max_evaluations": 10_000} if reward in NEED_A_BUDGET else {}
    _, (_, paid, *_) = finish(small("onemax:100", reward=reward, **budget))
    assert np.isfinite(paid)
    assert (reward in NEED_BITS) == (reward == "runtime")


def test_the_gap_is_that_of_evaluations_to_the_optimum():
    env = small("onemax:100")
    env.simulation.worlds.optima[:] = 532.0
    _, (*_, info) = finish(env)
    assert info["optimality_gap"] == pytest.approx((info["evaluations"] - 532.0) / 532.0, rel=1e-12)


def test_a_run_without_all_ones_is_infinitely_far_from_the_optimum():
    env = small("onemax:100", max_evaluations=60)
    env.simulation.worlds.optima[:] = 532.0
    _, (*_, info) = finish(env)
    assert info["optimality_gap"] == math.inf


def test_without_a_known_optimum_there_is_no_gap():
    _, (*_, info) = finish(small("onemax:37"))
    assert "optimality_gap" not in info
