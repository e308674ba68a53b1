"""Rules of the population size from the literature, against what they say, read from the swarm itself."""

import math
from itertools import pairwise

import numpy as np
import pytest

from agents import SizeLimits, make_controller
from swarm_gym.controllers.rule import BEST_FITNESS, column
from swarm_gym.controllers.size_rules import DIVERSITY
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.observation import make_observation

FAMILIES = ["linear-reduction", "lpsr", "nlpsr", "diversity-ladder", "status-monitor"]
ITERATIONS = 40


def sizes_and_swarms(name, scenario="case3", seed=0):
    """Sizes of the iterations 1, 2, ..., and what is there to see before each: best fitness and diversity."""
    controller = make_controller(name)
    env = SwarmEnv(scenario=scenario, iterations=ITERATIONS, **controller.env_options())
    controller.reset(1)
    observation, _ = env.reset(seed=seed)
    ended, sizes, best, diversity = False, [], [], []
    while not ended:
        simulation = env.simulation
        best.append(simulation.swarms.best_fitness[0] / simulation.worlds.lower_bounds[0])
        positions = simulation.positions(0)
        squares = ((positions - positions.mean(axis=0)) ** 2).sum(axis=1)
        diversity.append(math.sqrt(squares.mean()))
        observation, _, ended, _, _ = env.step(controller.act(observation[None])[0])
        sizes.append(int(simulation.history[0, len(sizes) + 1, 1]))
    return sizes, best, diversity


@pytest.mark.parametrize(("start", "smallest"), [(30, 5), (12, 12), (50, 4)])
def test_linear_reduction_falls_from_start_to_smallest_with_the_iterations(start, smallest):
    sizes, _, _ = sizes_and_swarms(f"linear-reduction:start={start},smallest={smallest}")
    expected = []
    for iteration in range(ITERATIONS):  # in integers, a half up
        expected.append((2 * (start * ITERATIONS + (smallest - start) * iteration) + ITERATIONS)
                        // (2 * ITERATIONS))  # fmt: skip
    assert sizes == expected


@pytest.mark.parametrize("optimizer", ["particle-swarm", "differential-evolution"])
def test_published_reduction_falls_with_the_evaluations(optimizer):
    controller = make_controller("lpsr:start=50,smallest=4")
    options = {"scenario": "case3", "iterations": 900, "max_evaluations": 900, **controller.env_options()}
    env = SwarmEnv(optimizer, **options)
    controller.reset(1)
    observation, info = env.reset(seed=3)
    ended, sizes, expected = False, [], []
    while not ended:
        spent = info["evaluations"]
        expected.append(math.floor(50 - 46 * spent / 900 + 0.5) if sizes else 50)
        action = controller.act(observation[None])[0]
        sizes.append(int(action[0]))
        observation, _, ended, _, info = env.step(action)
    assert sizes == expected
    assert info["evaluations"] == 900
    assert sizes[-1] <= 5


def test_published_reduction_knows_a_budget_of_which_hardly_anything_is_spent():
    controller = make_controller("lpsr:start=100,smallest=4")
    seen = np.zeros((1, len(make_observation("rich").features)))
    controller.reset(1)
    controller.act(seen)
    seen[0, column("rich", "share of the evaluation budget spent")] = 1e-7
    seen[0, column("rich", "share of the iterations done")] = 0.5
    seen[0, 3] = 10.0
    assert controller.act(seen)[0, 0] == 100


def test_published_reduction_falls_with_the_iterations_without_a_budget():
    sizes, _, _ = sizes_and_swarms("lpsr:start=30,smallest=5")
    assert sizes == sizes_and_swarms("linear-reduction:start=30,smallest=5")[0]


@pytest.mark.parametrize(("start", "smallest"), [(30, 5), (12, 12), (50, 4)])
def test_non_linear_reduction_falls_as_printed_and_never_behind_the_linear_one(start, smallest):
    sizes, _, _ = sizes_and_swarms(f"nlpsr:start={start},smallest={smallest}")
    linear, _, _ = sizes_and_swarms(f"linear-reduction:start={start},smallest={smallest}")
    shares = [iteration / ITERATIONS for iteration in range(ITERATIONS)]
    assert sizes == [math.floor((smallest - start) * r ** (1 - r) + start + 0.5) for r in shares]
    assert all(ours <= theirs for ours, theirs in zip(sizes, linear, strict=True))
    assert (sizes == linear) == (start == smallest)


@pytest.mark.parametrize("seed", range(3))
def test_diversity_ladder_keeps_the_relative_diversity_near_the_falling_line(seed):
    sizes, _, diversity = sizes_and_swarms("diversity-ladder:start=20,smallest=6,rung=2,band=0.2", seed=seed)
    size, expected = 20, [20]
    for iteration in range(1, ITERATIONS):
        relative, wanted = diversity[iteration] / diversity[0], 1.0 - iteration / ITERATIONS
        if relative < 0.8 * wanted:
            size += 2
        elif relative > 1.2 * wanted:
            size = max(size - 2, 6)
        expected.append(size)
    assert sizes == expected
    assert max(sizes) > 20 or min(sizes) < 20


@pytest.mark.parametrize("seed", range(3))
def test_status_monitor_grows_on_stagnation_and_shrinks_on_progress(seed):
    name = "status-monitor:start=20,smallest=6,patience=2,improvement=0.002,step=0.2"
    sizes, best, _ = sizes_and_swarms(name, seed=seed)
    size, progress, stagnation, expected = 20, 0, 0, [20]
    for before, now in pairwise(best):
        improved = math.log(before) - math.log(now) > 0.002
        progress, stagnation = (progress + 1, 0) if improved else (0, stagnation + 1)
        change = max(math.floor(0.2 * size + 0.5), 1)
        if progress == 2:
            size, progress = max(size - change, 6), 0
        if stagnation == 2:
            size, stagnation = size + change, 0
        expected.append(size)
    assert sizes == expected
    assert min(np.diff(sizes)) < 0 < max(np.diff(sizes))


@pytest.mark.parametrize("name", FAMILIES)
def test_sizes_and_phi_of_the_name(name):
    controller = make_controller(f"{name}:start=33,repair_degree=0.25")
    assert controller.initial_population_size == 33
    controller.reset(2)
    assert controller.act(np.zeros((2, 20))).tolist() == [[33, 0.25]] * 2


@pytest.mark.parametrize("name", FAMILIES)
def test_defaults_give_way_to_the_limits_and_given_values_do_not(name):
    narrow = make_controller(name, SizeLimits(20, 50))
    assert (narrow.start, narrow.smallest) == (50, 20)
    with pytest.raises(SettingError, match=r"start must lie in \[20, 50\], got 60"):
        make_controller(f"{name}:start=60", SizeLimits(20, 50))


@pytest.mark.parametrize("name", [*FAMILIES, "spsfa", "spsfa-tip"])
def test_swarms_are_independent_and_restart_at_iteration_0(name):
    together = make_controller(name)
    generator = np.random.default_rng(0)
    observations = generator.random((30, 5, 4 if name.startswith("spsfa") else 20))
    observations[..., :3] *= 80.0
    observations[[0, 12, 20], :, 3] = [[0.0] * 5, [0, 1, 0, 0, 1], [1, 0, 1, 1, 1]]
    together.reset(5)
    decisions = np.stack([together.act(step) for step in observations])
    for row in range(5):
        single = make_controller(name)
        single.reset(1)
        begin = 12 if observations[12, row, 3] == 0 else 0
        expected = np.stack([single.act(step[row : row + 1])[0] for step in observations[begin:]])
        np.testing.assert_array_equal(decisions[begin:, row], expected)
        assert decisions[begin, row].tolist() == [together.initial_population_size, 0.0]


def test_a_population_without_diversity_goes_up_while_diversity_is_wanted():
    controller = make_controller("diversity-ladder:start=20,rung=4")
    controller.reset(1)
    observation = np.zeros((1, 13))
    observation[0, column("rich", DIVERSITY)] = 0.7
    assert controller.act(observation)[0, 0] == 20
    observation[0, column("rich", DIVERSITY)], observation[0, 3] = 0.0, 0.5
    assert controller.act(observation)[0, 0] == 24
    observation[0, column("rich", DIVERSITY)] = 0.7
    assert controller.act(observation)[0, 0] == 20


def test_the_first_observation_is_no_progress():
    controller = make_controller("status-monitor:start=20,patience=1,step=0.5")
    controller.reset(1)
    observation = np.zeros((1, 9))
    observation[0, column("extended", BEST_FITNESS)] = -3.0
    assert controller.act(observation)[0, 0] == 20
    observation[0, 3] = 0.1
    assert controller.act(observation)[0, 0] == 30


def test_a_small_population_changes_by_one_member_at_least():
    controller = make_controller("status-monitor:start=4,smallest=2,patience=1,step=0.1")
    controller.reset(1)
    observation = np.zeros((1, 9))
    assert controller.act(observation)[0, 0] == 4
    observation[0, 3] = 0.1
    assert controller.act(observation)[0, 0] == 5


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("linear-reduction:growth=3", "unknown parameter 'growth'.*start integer in"),
        ("linear-reduction:start=201", "start must lie"),
        ("linear-reduction:repair_degree=1.5", "repair_degree must lie"),
        ("nlpsr:rung=2", "unknown parameter 'rung'.*start integer in"),
        ("nlpsr:smallest=1", "smallest must lie"),
        ("diversity-ladder:rung=0", "rung must lie"),
        ("diversity-ladder:band=-1", "band must lie"),
        ("status-monitor:patience=0", "patience must lie"),
        ("status-monitor:step=nan", "step must lie"),
        ("status-monitor:improvement=-1", "improvement must lie"),
    ],
)
def test_parameters_that_cannot_be_are_refused(name, message):
    with pytest.raises(SettingError, match=message):
        make_controller(name)
