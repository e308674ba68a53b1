"""Environments on test functions, where nothing collides and the lower bound is 0."""

import math
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from test_dynamic_environments import copied

from agents import make_controller
from helpers.layouts import OF_SWARMS
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.scenarios.function_scenario import FUNCTIONS
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.side_by_side import SideBySide
from swarm_gym.vector_env import SwarmVectorEnv

SMALL = {"initial_population_size": 6, "max_population_size": 12, "iterations": 5}
NAMES = [f"function:{function}-2" for function in FUNCTIONS]


def small(scenario="function:rastrigin-3-shifted:1", optimizer="firefly", **options):
    return SwarmEnv(optimizer, scenario=scenario, **{**SMALL, **options})


@pytest.mark.parametrize("observation", sorted(set(OF_SWARMS) - {"corridors"}))
def test_gymnasium_checker_passes(observation):
    env = gymnasium.make(
        "swarm_gym/Firefly-v0", scenario=NAMES, action="normalised", observation=observation, **SMALL
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env.unwrapped)
    assert [w for w in caught if "precision lowered" not in str(w.message)] == []


@pytest.mark.parametrize("name", [*NAMES, "function:sum-squares-1", "function:booth-1000-shifted:1"])
def test_observations_are_in_the_space_and_say_that_nothing_collides(name):
    env = small(name, observation="paper+priced", reward="final")
    observation, info = env.reset(seed=0)
    for size in (12, 2, 7, 7, 7):
        assert observation in env.observation_space
        assert (observation[:3] == 0.0).all()
        assert (info["feasible_share"], info["best_collision"]) == (1.0, 0.0)
        observation, reward, ended, _, info = env.step(np.array([size, 1.0]))
        assert np.isfinite(reward)
    assert ended
    assert info["optimality_gap"] == info["best_fitness"]
    assert info["best_path"].shape == (env.simulation.dimension, 2)
    assert env.simulation.problems[0].evaluate(info["best_path"][:, 1])[0] == info["best_fitness"]


def test_the_observed_fitness_is_log_1_plus_it():
    env = small("function:easom-2", observation="extended")
    observation, info = env.reset(seed=1)
    assert observation[6] == pytest.approx(math.log(1.0 + info["best_fitness"]), rel=1e-6)


def test_progress_is_paid_down_to_a_gap_of_a_billionth():
    env = small("function:booth-2", price=0.0)
    beside, there = [1.0, 3.0 + 1e-3], [1.0, 3.0]
    _, before = env.reset(options={"initial_population": [beside] * 4})
    assert before["best_fitness"] == pytest.approx(5e-6)
    assert env.simulation.gaps.now()[0] == before["best_fitness"]
    env.reset(options={"initial_population": [there] * 4})
    assert env.simulation.gaps.now()[0] == 1e-9
    _, reward, *_ = env.step(np.array([4.0, 0.0]))
    assert reward == 0.0


def test_the_optimality_reward_is_a_hundred_times_the_best_value():
    env = small(reward="optimality", price=0.0)
    env.reset(seed=1)
    rewards = [env.step(np.array([9.0, 0.0])) for _ in range(5)]
    assert rewards[-1][1] == pytest.approx(-100.0 * rewards[-1][4]["best_fitness"])


def test_given_populations_have_to_lie_in_the_domain():
    env = small("function:rastrigin-2")
    _, info = env.reset(options={"initial_population": [[5.12, -5.12], [0.0, 1.0]]})
    assert info["best_fitness"] == pytest.approx(1.0)
    with pytest.raises(SettingError, match="bounds"):
        env.reset(options={"initial_population": [[5.13, 0.0], [0.0, 1.0]]})


@pytest.mark.parametrize("controller", ["spsfa", "spsfa-tip"])
def test_the_schedule_of_the_paper_keeps_its_size(controller):
    schedule = make_controller(controller)
    env = small(**{"max_population_size": 200, **schedule.env_options()})
    schedule.reset(1, 0)
    observation, _ = env.reset(seed=2)
    ended = False
    while not ended:
        assert observation[0] == 0.0
        action = schedule.act(observation[None])[0]
        observation, _, ended, _, info = env.step(action)
        assert info["population_size"] == schedule.initial_population_size


def test_the_repair_degree_changes_nothing():
    paths = []
    for repair_degree in (0.0, 1.0):
        env = small()
        env.reset(seed=3)
        paths.append([env.step(np.array([8.0, repair_degree]))[4]["best_path"] for _ in range(4)])
    np.testing.assert_array_equal(*paths)


def decisions(seed):
    return np.random.default_rng(seed).integers(2, 13, (5, 1)) * [1.0, 0.0] + [0.0, 0.5]


@copied
def test_same_seed_same_bits_in_a_vector_and_after_copying(duplicate):
    width, scenarios = 4, ["function:rastrigin-3-shifted:0-2", "function:easom-3"]
    vector = SwarmVectorEnv(width, scenario=scenarios, autoreset_mode=AutoresetMode.DISABLED, **SMALL)
    vector.reset(seed=5)
    steps = [vector.step(np.stack([decisions(5 + b)[k] for b in range(width)])) for k in range(5)]
    for row in range(width):
        env = small(scenarios)
        env.reset(seed=5 + row)
        for k, action in enumerate(decisions(5 + row)):
            if k == 2:
                env = duplicate(env)
            observation, reward, *_, info = env.step(action)
            np.testing.assert_array_equal(observation, steps[k][0][row])
            assert reward == steps[k][1][row]
            for name in ("best_path", "best_fitness", "scenario"):
                np.testing.assert_array_equal(info[name], steps[k][4][name][row])


def test_tuning_measures_gaps_in_units_of_1():
    config = TuneConfig(scenarios=("function:sum-squares-2",), episodes=2, price=0.0, reward="final")
    controller = make_controller("fixed:20")
    outcomes = SideBySide(config, 1, controller.observation, controller.action).run([controller], 0)
    np.testing.assert_allclose(outcomes.losses, np.log(np.maximum(outcomes.final_fitness, 1e-9)), rtol=1e-12)
