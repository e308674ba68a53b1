"""The layouts `jumps` and `told`: what a change of the map does, and when it comes."""

import numpy as np
import pytest

from swarm_gym.env import SwarmEnv
from swarm_gym.features import JUMPS, TOLD
from swarm_gym.history import HISTORY
from swarm_gym.scenarios import Appear, Circle, DynamicScenario, Polygon, make_scenario
from swarm_gym.vector_env import SwarmVectorEnv

ITERATIONS = 12
BASE = make_scenario("case1")
# The first is far from all paths, the second on the best ones.
TWICE = DynamicScenario(
    "twice", BASE, [Appear(4, Circle(60, 570, 8)), Appear(7, Polygon.rectangle(560, 100, 640, 400))]
)
BEST, COLLISION = HISTORY.index("best_fitness"), HISTORY.index("population_collision")


def episode(observation, scenario=TWICE):
    """Return the observations of an episode, (iterations + 1, features), and its history."""
    env = SwarmEnv(
        scenario=scenario, iterations=ITERATIONS, observation=observation, initial_population_size=12
    )
    seen = [env.reset(seed=3)[0]]
    seen += [env.step(np.array([12, 0.0]))[0] for _ in range(ITERATIONS)]
    assert all(one in env.observation_space for one in seen)
    return np.array(seen), env.simulation.history[0]


def share(count):
    return np.log1p(count) / np.log1p(ITERATIONS)


def test_a_rise_of_the_best_fitness_is_seen_from_the_event_on():
    seen, history = episode("jumps")
    best, collision = history[:, BEST], history[:, COLLISION]
    assert (np.diff(best)[:6] <= 0.0).all()
    assert best[7] > best[6]
    since = [k if k < 7 else k - 7 for k in range(ITERATIONS + 1)]
    jump, clock, rise = len(JUMPS) - 3, len(JUMPS) - 2, len(JUMPS) - 1
    assert seen[:, clock] == pytest.approx([share(k) for k in since], rel=1e-6)
    assert (seen[:7, rise] == 0.0).all()
    assert seen[7:, rise] == pytest.approx(np.log(best[7] / best[6]), rel=1e-5)
    expected = np.log((1 + collision[1:]) / (1 + collision[:-1])) / 8.0
    assert seen[0, jump] == 0.0
    assert seen[1:, jump] == pytest.approx(expected, abs=1e-6)
    assert seen[7, jump] == seen[:, jump].max() > 0.01


def test_times_of_events_are_told_exactly():
    seen, _ = episode("told")
    since = [k if k < 4 else k - 4 if k < 7 else k - 7 for k in range(ITERATIONS + 1)]
    until = [4 - k if k < 4 else 7 - k if k < 7 else ITERATIONS for k in range(ITERATIONS + 1)]
    assert seen[:, len(TOLD) - 2] == pytest.approx([share(k) for k in since], rel=1e-6)
    assert seen[:, len(TOLD) - 1] == pytest.approx([share(k) for k in until], rel=1e-6)


@pytest.mark.parametrize("layout", ["jumps", "told"])
def test_swarms_of_a_vector_see_what_single_ones_do(layout):
    seen, _ = episode(layout)
    options = {"iterations": ITERATIONS, "observation": layout, "initial_population_size": 12}
    envs = SwarmVectorEnv(num_envs=3, scenario=TWICE, **options)
    assert (envs.reset(seed=[1, 3, 5])[0][1] == seen[0]).all()
    for expected in seen[1:ITERATIONS]:
        observations, *_ = envs.step(np.tile([12, 0.0], (3, 1)))
        assert (observations[1] == expected).all()


def test_without_events_the_clocks_run_from_the_beginning():
    jumps, told = episode("jumps", BASE)[0], episode("told", BASE)[0]
    clock = [share(k) for k in range(ITERATIONS + 1)]
    assert jumps[:, len(JUMPS) - 2] == pytest.approx(clock, rel=1e-6)
    assert told[:, len(TOLD) - 2] == pytest.approx(clock, rel=1e-6)
    assert (told[:, len(TOLD) - 1] == 1.0).all()
    assert (jumps[:, len(JUMPS) - 1] == 0.0).all()
