"""The reward `offline-error`: the gap on the map in force, averaged since the first event."""

import numpy as np
import pytest

from helpers.refusals import refused
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.history import HISTORY
from swarm_gym.reference import ensure_optima
from swarm_gym.scenarios import Appear, Circle, Disappear, DynamicScenario, Polygon, make_scenario
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for

ITERATIONS = 8
BEST, SPENT = HISTORY.index("best_fitness"), HISTORY.index("evaluations")
BASE = make_scenario("case1")
BLOCK = Polygon.rectangle(600, 100, 640, 270)  # on the best path
TWICE = DynamicScenario("twice", BASE, [Appear(3, BLOCK), Disappear(6, len(BASE.obstacles))])


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path_factory.getbasetemp() / "optima"))


def environment(scenario, **options):
    settings = {
        "scenario": scenario,
        "iterations": ITERATIONS,
        "num_waypoints": 9,
        "initial_population_size": 8,
    }
    ensure_optima(problems_for(Settings(**settings)))
    return SwarmEnv(reward="offline-error", **settings, **options)


def rewards_of(env, seed=0):
    env.reset(seed=seed)
    rewards, ended = [], False
    while not ended:
        _, reward, terminated, truncated, _ = env.step(np.array([8, 0.0]))
        ended = terminated or truncated
        rewards.append(reward)
    return np.array(rewards)


def gaps(env, worlds):
    """Return the gap in per cent after every iteration, on the map after the events that follow it."""
    best, optima = env.simulation.history[0, :, BEST], env.simulation.worlds.optima
    return 100.0 * (best / optima[worlds] - 1.0)


def test_the_sum_of_an_episode_is_the_mean_gap_since_the_first_event():
    env = environment(TWICE, price=0.0)
    rewards = rewards_of(env)
    worlds = np.repeat([0, 1, 2], [3, 3, 3])  # rows 0 to 2, 3 to 5, 6 to 8
    assert env.simulation.worlds.optima[1] > env.simulation.worlds.optima[0]
    expected = gaps(env, worlds)[3:]
    assert -rewards.sum() == pytest.approx(expected.mean(), rel=1e-12)
    assert (rewards[:2] == 0.0).all()
    assert -rewards[2:] == pytest.approx(expected / len(expected), rel=1e-12)


def test_without_events_the_average_is_over_all_iterations():
    env = environment(BASE, price=0.0)
    rewards = rewards_of(env)
    assert -rewards == pytest.approx(gaps(env, np.zeros(ITERATIONS + 1, int))[1:] / ITERATIONS, rel=1e-12)


def test_evaluations_cost_as_with_every_reward():
    free, priced = (rewards_of(environment(TWICE, price=price)) for price in (0.0, 3.0))
    env = environment(TWICE, price=3.0)
    rewards_of(env)
    spent = np.diff(env.simulation.history[0, :, SPENT])
    assert free - priced == pytest.approx(3.0 * spent / env.settings.reference_evaluations, rel=1e-9)


@pytest.mark.parametrize("budget", [60, 120, 230])
def test_the_gap_at_an_early_end_stays(budget):
    """Before the event, after the first and after the second."""
    env = environment(TWICE, price=0.0, max_evaluations=budget)
    rewards = rewards_of(env)
    assert len(rewards) < ITERATIONS
    (number,) = env.simulation.swarms.problem
    last = 100.0 * (
        env.simulation.history[0, len(rewards), BEST] / env.simulation.worlds.optima[number] - 1.0
    )
    if len(rewards) <= 3:
        assert -rewards.sum() == pytest.approx(last, rel=1e-12)
    else:
        left = ITERATIONS - len(rewards) + 1
        assert -rewards[-1] == pytest.approx(left * last / 6, rel=1e-12)


def test_the_offline_error_needs_the_optimum_of_every_world():
    unknown = DynamicScenario("odd", BASE, [Appear(2, Circle(333, 321, 12))])
    # With so many waypoints, it is not computed without being asked for.
    settings = {"scenario": unknown, "iterations": ITERATIONS, "num_waypoints": 500}
    words = ("offline-error", "needs the optimum of scenario 'odd'", "ensure_optima")
    refused(lambda: SwarmEnv(reward="offline-error", **settings), *words, error=SettingError)
