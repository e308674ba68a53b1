"""The best paths so far: the best by fitness, and the best feasible one beside it."""

import numpy as np
import pytest
import shapely

from helpers.builders import is_walker, slow_if_alike
from helpers.shapes import shape
from swarm_gym.env import SwarmEnv
from swarm_gym.history import HISTORY
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.vector_env import SwarmVectorEnv

FITNESS, FEASIBLE = HISTORY.index("best_fitness"), HISTORY.index("feasible_fitness")


def inside(path, scenario):
    """Length of a path inside obstacles, in map units."""
    line = shapely.LineString(path)
    return max(
        (line.intersection(shape(each, 512).buffer(-1e-6)).length for each in scenario.obstacles), default=0.0
    )


@pytest.mark.parametrize("optimizer", [slow_if_alike(name) for name in OPTIMIZERS if not is_walker(name)])
def test_the_feasible_path_is_free_and_no_shorter_than_the_best_one_is_fit(optimizer):
    env = SwarmEnv(optimizer, scenario="random-fields:test:3", source="smooth", iterations=12)
    found = 0
    for seed in range(6):
        _, info = env.reset(seed=seed)
        for _ in range(12):
            if "feasible_path" in info:
                found += 1
                length = np.linalg.norm(np.diff(info["feasible_path"], axis=0), axis=1).sum()
                assert inside(info["feasible_path"], env.simulation.problem_of(0).scenario) == 0.0
                assert info["feasible_fitness"] == pytest.approx(0.3 * length)
                assert info["feasible_fitness"] >= info["best_fitness"]
            assert ("feasible_path" in info) == ("feasible_fitness" in info)
            if info["best_collision"] == 0.0:
                np.testing.assert_array_equal(info["feasible_path"], info["best_path"])
            _, _, _, _, info = env.step(np.array([20, 0.3]))
    assert found > 10


def test_a_walk_is_feasible_or_not_as_the_best_one():
    env = SwarmEnv("ant-colony", scenario="rooms:0", iterations=5)
    _, info = env.reset(seed=1)
    for _ in range(5):
        assert ("feasible_path" in info) == (info["best_collision"] == 0.0)
        if "feasible_path" in info:
            np.testing.assert_array_equal(info["feasible_path"], info["best_path"])
        _, _, _, _, info = env.step(np.array([20, 0.0]))
    assert "feasible_path" in info


def test_an_event_forgets_feasible_paths_that_it_blocks():
    env = SwarmEnv(scenario="dynamic:case1-gate@6", source="smooth", iterations=12)
    for seed in range(4):
        env.reset(seed=seed)
        for iteration in range(1, 13):
            _, _, _, _, info = env.step(np.array([60, 0.3]))
            if "feasible_path" in info:
                assert inside(info["feasible_path"], env.simulation.problem_of(0).scenario) == 0.0
            recorded = env.simulation.history[0, iteration, FEASIBLE]
            assert recorded == info["feasible_fitness"] if "feasible_fitness" in info else np.isnan(recorded)
    courses = env.simulation.history[0]
    assert (courses[:, FEASIBLE] >= courses[:, FITNESS])[np.isfinite(courses[:, FEASIBLE])].all()


def test_in_a_vector_the_swarms_without_a_feasible_path_are_masked():
    swarms = SwarmVectorEnv(16, scenario="random-fields:test:7", source="smooth", initial_population_size=8)
    _, info = swarms.reset(seed=3)
    there = np.isfinite(swarms.simulation.swarms.feasible_fitness)
    assert 0 < there.sum() < 16
    np.testing.assert_array_equal(info["_feasible_path"], there)
    np.testing.assert_array_equal(info["_feasible_fitness"], there)
    assert (info["feasible_fitness"][there] > 288.0).all()
    assert (info["feasible_path"][~there] == 0.0).all()
