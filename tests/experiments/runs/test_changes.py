"""Measures of runs on maps that change."""

import numpy as np
import pytest

from experiments.runs.changes import Changes, iterations_to_feasible, offline_errors
from helpers.stored_runs import stored_run
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError

GATE = "dynamic:case3-gate@4"  # the optimum rises from 300.27 to 306.52


def runs_with(**courses):
    number = len(next(iter(courses.values())))
    of_each = [{name: np.array(values[k], float) for name, values in courses.items()} for k in range(number)]
    return [run_of(courses) for courses in of_each]


def run_of(courses):
    return stored_run(("fixed:60", GATE, 0), courses, final_fitness=0.0)


def test_gaps_are_to_the_optimum_of_the_map_in_force():
    changes = Changes.of(GATE)
    before, after = changes.optima
    assert after > 1.02 * before
    np.testing.assert_array_equal(changes.events, [4])
    far, near = [2 * before] * 4 + [2 * after] * 3, [before] * 4 + [after, 1.5 * after, after]
    runs = runs_with(best_fitness=[far, near])
    np.testing.assert_allclose(changes.gaps(runs), [[1.0] * 7, [0, 0, 0, 0, 0, 0.5, 0]], atol=1e-12)
    np.testing.assert_allclose(offline_errors(runs, GATE), [1.0, 0.5 / 3])


def test_without_events_the_first_population_does_not_count():
    (optimum,) = Changes.of("case1").optima
    runs = runs_with(best_fitness=[[9 * optimum, 2 * optimum, optimum]])
    np.testing.assert_allclose(offline_errors(runs, "case1"), [0.5])


def test_the_offline_error_is_what_the_reward_of_that_name_sums_to():
    name = "dynamic-fields:train:0"  # with events after iterations 74 and 78
    env = SwarmEnv(scenario=name, reward="offline-error", price=0.0)
    env.reset(seed=4)
    rewards = [env.step(np.array([12, 0.1]))[1] for _ in range(100)]
    (error,) = offline_errors([run_of(env.simulation.history[0])], name)
    assert -sum(rewards) / 100.0 == pytest.approx(error, rel=1e-12)


def test_feasible_again_is_counted_from_the_event():
    none = np.nan
    runs = runs_with(feasible_fitness=[[300, 300, none, none, 310], [300] * 5, [300, 300, none, none, none]])
    np.testing.assert_array_equal(iterations_to_feasible(runs, 2), [2, 0, np.inf])


def test_the_offline_error_needs_the_optimum_of_every_map(monkeypatch):
    monkeypatch.setattr(
        "experiments.runs.changes.Changes.of", lambda _: Changes(np.array([0, 1]), np.array([np.nan, 1.0]))
    )
    with pytest.raises(ScenarioError, match="needs the optimum after each of its events"):
        offline_errors(runs_with(best_fitness=[[1.0, 1.0, 1.0]]), GATE)
