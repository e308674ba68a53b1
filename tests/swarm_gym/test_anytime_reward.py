"""The rewards `anytime` and `anytime-and-end`: minus the mean of log10 of the gap over the budget."""

import numpy as np
import pytest

from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.history import COLUMN
from swarm_gym.reward import LEAST_GAP
from swarm_gym.vector_env import SwarmVectorEnv


def episode(budget, sizes, iterations=80, optimizer="cma-es", reward="anytime"):
    """Return the rewards of an episode with these sizes in turn, and its history."""
    env = SwarmEnv(
        optimizer, scenario="metabox-bbob:1-10", iterations=iterations, reward=reward,
        max_evaluations=budget, initial_population_size=sizes[0],
    )  # fmt: skip
    env.reset(seed=1)
    rewards, ended = [], False
    while not ended:
        _, paid, done, cut, _ = env.step(np.array([sizes[len(rewards) % len(sizes)], 0.0]))
        rewards.append(paid)
        ended = done or cut
    return np.array(rewards), env.simulation.history[0, : len(rewards) + 1]


def mean_over_the_budget(history, budget):
    """Return the mean of log10 of the gap, one evaluation at a time."""
    best = np.maximum(history[:, COLUMN.best_fitness], LEAST_GAP)
    ends = history[:, COLUMN.evaluations].astype(int)
    gaps = np.empty(budget)
    for begin, end, gap in zip([0, *ends[:-1]], ends, best, strict=True):
        gaps[begin:end] = np.log10(gap)
    gaps[ends[-1] :] = np.log10(best[-1])
    return gaps.mean()


@pytest.mark.parametrize("sizes", [(6,), (6, 25, 11)])
def test_the_sum_is_minus_the_mean_over_the_budget(sizes):
    rewards, history = episode(400, sizes)
    assert history[-1, COLUMN.evaluations] == 400
    assert rewards.sum() == pytest.approx(-mean_over_the_budget(history, 400), rel=1e-9)
    gap = np.log10(history[2, COLUMN.best_fitness])
    assert rewards[1] == pytest.approx(-gap * sizes[1 % len(sizes)] / 400, rel=1e-9)


def test_an_episode_that_stops_early_keeps_its_last_gap_for_the_rest():
    rewards, history = episode(5000, (10,), iterations=20)
    assert history[-1, COLUMN.evaluations] == 10 * 21
    assert rewards.sum() == pytest.approx(-mean_over_the_budget(history, 5000), rel=1e-9)
    assert abs(rewards[-1]) > 50 * abs(rewards[-2])


def test_gaps_below_the_least_one_count_as_that():
    rewards, history = episode(4000, (10,), iterations=500)
    assert history[-1, COLUMN.best_fitness] < 0.1 * LEAST_GAP
    assert rewards[-1] == pytest.approx(8.0 * 10 / 4000)
    assert rewards.sum() == pytest.approx(-mean_over_the_budget(history, 4000), rel=1e-9)


@pytest.mark.parametrize(("budget", "iterations"), [(400, 80), (5000, 20), (4000, 500)])
def test_the_final_gap_counts_once_more_at_the_end(budget, iterations):
    plain, _ = episode(budget, (10,), iterations)
    rewards, history = episode(budget, (10,), iterations, reward="anytime-and-end")
    np.testing.assert_array_equal(rewards[:-1], plain[:-1])
    final = max(history[-1, COLUMN.best_fitness], LEAST_GAP)
    assert rewards[-1] - plain[-1] == pytest.approx(-np.log10(final), rel=1e-9)


def test_swarms_of_a_vector_are_paid_for_their_own_iterations():
    swarms = SwarmVectorEnv(
        3, "particle-swarm", scenario="metabox-bbob:3-10", iterations=30, reward="anytime",
        max_evaluations=600, initial_population_size=20, autoreset_mode="Disabled",
    )  # fmt: skip
    swarms.reset(seed=2)
    total, ended = np.zeros(3), np.zeros(3, dtype=bool)
    while not ended.all():
        _, paid, ended = swarms.step_running(np.array([[20.0, 0.0], [8.0, 0.0], [40.0, 0.0]]))
        total += paid
    for row, history in enumerate(swarms.simulation.history):
        known = history[np.isfinite(history[:, COLUMN.evaluations])]
        assert total[row] == pytest.approx(-mean_over_the_budget(known, 600), rel=1e-9)


@pytest.mark.parametrize("reward", ["anytime", "anytime-and-end"])
def test_without_a_budget_they_are_refused(reward):
    with pytest.raises(SettingError, match=rf"'{reward}'.*max_evaluations"):
        SwarmEnv("cma-es", scenario="metabox-bbob:1-10", reward=reward)
