"""The reward `detour`: how far a robot drove above the shortest way, in per cent, and the price."""

import numpy as np
import pytest

from helpers.refusals import refused
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.history import HISTORY
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Appear, Circle, Drive, DynamicScenario, Polygon, Scenario
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import worlds_for

SPENT = HISTORY.index("evaluations")
ITERATIONS = 8
FREE = Scenario("free", (20.0, 300.0), (980.0, 300.0), (Circle(500, 560, 30),), initial_range=(-90.0, 90.0))
BLOCK = Polygon.rectangle(700, 200, 720, 330)
FAR, NEAR = Drive(2, 1, 250.0), Drive(2, 1, 50.0)  # the first arrives in the episode, the second does not


def options_of(drive, **options):
    scenario = DynamicScenario("on-the-way", FREE, [Appear(3, BLOCK)], drive)
    return {
        "scenario": scenario,
        "reward": "detour",
        "price": 0.0,
        "initial_population_size": 20,
        "iterations": ITERATIONS,
        **options,
    }


def play(env, seed):
    """Return the rewards of an episode."""
    env.reset(seed=seed)
    rewards, ended = [], False
    while not ended:
        _, reward, ended, _, _ = env.step(np.array([20, 0.5]))
        rewards.append(reward)
    return np.array(rewards)


@pytest.mark.parametrize("seed", range(4))
def test_the_detour_is_the_way_driven_above_the_shortest_one_on_the_last_map(seed):
    env = SwarmEnv(**options_of(FAR))
    rewards = play(env, seed)
    way = env.simulation.trajectory(0)
    assert tuple(way[-1]) == FREE.target
    shortest = shortest_path(worlds_for(env.settings)[-1].scenario)[0]
    assert shortest > 960.0
    assert rewards[-1] == pytest.approx(-100.0 * (length_of(way) / shortest - 1.0), rel=1e-9)
    assert rewards[-1] < 0.0
    assert (rewards[:-1] == 0.0).all()


def test_a_robot_that_does_not_arrive_counts_as_one_that_drives_twice_the_way():
    env = SwarmEnv(**options_of(NEAR))
    assert play(env, 0).tolist() == [0.0] * (ITERATIONS - 1) + [-100.0]
    assert np.isinf(env.simulation.detours()).all()


def test_a_way_of_more_than_twice_the_shortest_one_counts_as_twice_that_way():
    env = SwarmEnv(**options_of(FAR))
    env.reset(seed=0)
    env.simulation.robots.driven[0] = 5000.0
    reward, ended = 0.0, False
    while not ended:
        _, reward, ended, _, _ = env.step(np.array([20, 0.5]))
    assert env.simulation.robots.arrived.all()
    assert reward == -100.0


def test_evaluations_cost_as_with_every_reward():
    free, priced = (play(SwarmEnv(**options_of(FAR, price=price)), 1) for price in (0.0, 3.0))
    env = SwarmEnv(**options_of(FAR))
    play(env, 1)
    spent = np.diff(env.simulation.history[0, : len(free) + 1, SPENT])
    assert free - priced == pytest.approx(3.0 * spent / env.settings.reference_evaluations, rel=1e-9)


def test_copies_have_arrived_as_the_swarms_that_they_are_copies_of():
    swarms = SwarmVectorEnv(3, autoreset_mode="Disabled", **options_of(FAR))
    swarms.reset(seed=0)
    actions, first = np.tile([20, 0.5], (3, 1)), np.array([True, False, False])
    while not swarms.step_running(actions, first)[2][0]:
        pass
    assert np.isfinite(swarms.simulation.detours()).tolist() == [True, False, False]
    swarms.copy_swarms(np.array([0, 0, 2]))
    detours = swarms.simulation.detours()
    assert detours[0] == detours[1]
    assert np.isinf(detours[2])
    swarms.reset(seed=1)
    assert np.isinf(swarms.simulation.detours()).all()


def test_the_detour_needs_a_robot_that_drives_in_every_scenario():
    mixed = [options_of(FAR)["scenario"], DynamicScenario("still", FREE, [Appear(3, BLOCK)])]
    words = ("'detour'", "'still'", "drive@40")
    refused(lambda: SwarmEnv(**{**options_of(FAR), "scenario": mixed}), *words, error=SettingError)
