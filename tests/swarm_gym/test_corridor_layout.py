"""The observation layout `corridors`: recent newcomers, and corridors that the population is in."""

import copy
import math
import pickle

import numpy as np
import pytest
from test_dynamic_environments import BUSY, BUSY_GRID

from helpers.layouts import OF_SWARMS
from helpers.refusals import refused
from oracles import naive_corridors
from swarm_gym.corridors import obstacle_posts, posts_of
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.features import RECENT
from swarm_gym.observation import OBSERVATIONS, make_observation
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes
from swarm_gym.scenarios import Circle, Scenario
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation
from swarm_gym.sources import BECAME_BEST, BEST_SMOOTH, begin_arrivals, note_arrival
from swarm_gym.vector_env import SwarmVectorEnv

SMALL = {"initial_population_size": 8, "max_population_size": 20, "iterations": 8}
NAMES = [feature.name for feature in OBSERVATIONS["corridors"].features]
SMOOTH, BECAME, NUMBER = range(4, 7)  # columns of the layout
TWO_CIRCLES = Scenario(
    "two-circles",
    (0.0, 50.0),
    (100.0, 50.0),
    (Circle(30, 50, 5), Circle(70, 50, 5)),
    (0.0, 0.0, 100.0, 100.0),
)


def small(observation="corridors", **options):
    return SwarmEnv(**{**SMALL, "observation": observation, **options})


def expected_number(env):
    """Return the scaled number of corridors of an environment by the oracle."""
    simulation = env.simulation
    problem = simulation.problem_of(0)
    paths = problem.points(simulation.positions(0))
    if paths.shape[1] == 1000:
        paths = paths[:, [*range(0, 999, 16), 999]]
    axes = RotatedAxes.of(problem.scenario)
    number = naive_corridors.count(paths.tolist(), posts_of(problem).points.tolist(), axes)
    return math.log(number) / math.log(20)


def play(env, sizes=(12, 20, 5, 5, 9, 17, 17, 3), seed=4):
    """Yield the observations of an episode, in which the population grows and shrinks."""
    yield env.reset(seed=seed)[0]
    for size in sizes:
        observation, _, ended, _, _ = env.step(np.array([size, 0.5]))
        yield observation
        if ended:
            return


def test_the_layout_has_seven_numbers_with_unique_names():
    space = small().observation_space
    assert len(set(NAMES)) == 7
    assert space.shape == (7,)
    assert space.dtype == np.float32
    assert space.low[4:].tolist() == [0.0, 0.0, 0.0]
    assert space.high[4:].tolist() == [4.0, 1.0, 1.0]


@pytest.mark.parametrize("name", [*OF_SWARMS, "rich+corridors", "corridors+paper", "paper+rich"])
def test_newcomers_are_recorded_for_this_layout_only(name):
    window = RECENT if "corridors" in name else 0
    assert make_observation(name).arrival_window == window
    assert small(name).simulation.swarms.arrivals.shape == (1, 2, window)


def test_newcomers_of_the_last_iterations_are_observed():
    env = small()
    env.reset(seed=0)
    simulation, swarms = env.simulation, env.simulation.swarms
    observe = env._batch.observe
    bound, best = simulation.worlds.lower_bounds[0], float(swarms.best_fitness[0])
    gap = best - bound
    # For each iteration, newcomers: whether they are smooth, their gap, and whether they become the best.
    newcomers = [
        [(True, 1.5, True)],
        [(True, 3.0, False), (True, 2.0, True), (False, 1.2, True)],
        [],
        [(True, 4.0, False), (False, 1.1, False)],
        [],
        [(True, 6.0, True)],
        [],
        [(False, 1.0, True)],
    ]
    for g, coming in enumerate(newcomers):
        swarms.iteration[0] = g
        begin_arrivals(swarms.arrivals[0], swarms.iteration[0])
        for smooth, gaps, becomes in coming:
            fitness = bound + gaps * gap
            note_arrival(
                swarms.arrivals[0], swarms.iteration[0], smooth, fitness, np.inf if becomes else fitness
            )
        swarms.iteration[0] = g + 1
        watched = [one for some in newcomers[max(g + 1 - RECENT, 0) : g + 1] for one in some]
        smooth_gaps = [gaps for smooth, gaps, _ in watched if smooth]
        count = sum(becomes for _, _, becomes in watched)
        seen = observe()[0]
        assert seen[SMOOTH] == pytest.approx(math.log(min(smooth_gaps)) if smooth_gaps else 4.0, rel=1e-5)
        assert seen[BECAME] == pytest.approx(count / (1 + count))


@pytest.mark.parametrize(("ratio", "expected"), [(0.5, 0.0), (1.0, 0.0), (math.e, 1.0), (1e9, 4.0)])
def test_the_gap_of_a_newcomer_is_observed_up_to_a_bound(ratio, expected):
    env = small()
    env.reset(seed=0)
    swarms, bound = env.simulation.swarms, env.simulation.worlds.lower_bounds[0]
    swarms.arrivals[0, BEST_SMOOTH, 2] = bound + ratio * (swarms.best_fitness[0] - bound)
    assert env._batch.observe()[0, SMOOTH] == pytest.approx(expected, abs=1e-6)


def test_growth_from_smooth_bends_is_seen_for_five_iterations():
    env = small(source="smooth", iterations=9)
    seen = list(play(env, (14, 14, 14, 14, 14, 14, 16)))
    assert seen[0][[SMOOTH, BECAME]].tolist() == [4.0, 0.0]  # the first population is no newcomer
    assert all(0.0 <= one[SMOOTH] < 4.0 for one in seen[1:6])
    assert seen[6][[SMOOTH, BECAME]].tolist() == [4.0, 0.0]
    assert seen[7][SMOOTH] < 4.0


def test_uniform_newcomers_are_not_smooth():
    env = small(source="uniform")
    assert [one[SMOOTH] for one in play(env)] == [4.0] * 9
    assert (env.simulation.swarms.arrivals[0, BECAME_BEST] >= 0.0).all()


def test_the_number_of_corridors_is_that_of_a_population_made_by_hand():
    env = small(scenario=TWO_CIRCLES, num_waypoints=2, max_population_size=8)
    left, right, slalom = [9.0, 8.0], [-20.0, -2.0], [9.0, -9.0]
    for members, number in (([left, left], 1), ([left, right, left], 2), ([slalom, right, left], 3)):
        seen, _ = env.reset(seed=0, options={"initial_population": np.array(members)})
        assert seen[NUMBER] == pytest.approx(math.log(number) / math.log(8))


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"optimizer": "particle-swarm", "source": "mixed"},
        {"scenario": "random-fields:train:3"},
        {"scenario": "rooms:0"},
        {"scenario": "rooms:0", "encoding": "bezier"},
        {"scenario": BUSY},
        {"scenario": BUSY_GRID, "encoding": "bezier"},
        {"scenario": "dynamic:case3-drive@2,every=2,distance=80"},
    ],
    ids=["analytic", "mixed", "field", "waypoints", "bezier", "events", "events-grid", "drive"],
)
def test_episodes_tell_the_number_of_corridors_on_every_kind_of_map(options):
    env = small(**options)
    for observation in play(env):
        assert observation in env.observation_space
        assert observation[NUMBER] == pytest.approx(expected_number(env), abs=1e-6)


def test_posts_are_those_of_the_world_in_force():
    env = small(scenario=BUSY)
    posts = []
    for _ in play(env):
        problem = env.simulation.problem_of(0)
        posts.append(posts_of(problem).points.tolist())
        assert posts[-1] == [
            list(post) for post in obstacle_posts(problem.scenario.obstacles, problem.scenario.tolerance)
        ]
    assert posts[0] != posts[1] != posts[2] != posts[3]


def test_joined_layouts_have_the_numbers_of_both():
    envs = [small(name) for name in ("rich+corridors", "rich", "corridors")]
    for joined, rich, corridors in zip(*map(play, envs), strict=True):
        np.testing.assert_array_equal(joined, np.concatenate([rich, corridors]))
        assert joined.dtype == np.float32


@pytest.mark.parametrize("source", ["uniform", "mixed"])
def test_the_layout_changes_no_bit_of_an_episode(source):
    histories = []
    for name in ("rich", "rich+corridors"):
        env = small(name, source=source)
        list(play(env))
        histories.append(env.simulation.history.copy())
    np.testing.assert_array_equal(*histories)


def test_copies_observe_the_same_numbers():
    env = small(scenario="dynamic:case3-drive@2,every=2,distance=80")
    for _ in play(env, (12, 9, 14)):
        pass
    copies = copy.deepcopy(env), pickle.loads(pickle.dumps(env))
    expected = env.step(np.array([15, 0.0]))[0]
    for other in copies:
        np.testing.assert_array_equal(other.step(np.array([15, 0.0]))[0], expected)


def test_every_swarm_of_a_vector_sees_its_own_corridors():
    scenarios = ["case1", "case2", "case3"]
    env = SwarmVectorEnv(5, scenario=scenarios, observation="corridors", **SMALL)
    seen, infos = env.reset(seed=7)
    alone = small(scenario=scenarios)
    generators = [alone.reset(seed=7 + row) for row in range(5)]
    assert len(set(infos["scenario"])) > 1
    np.testing.assert_array_equal(seen, [observation for observation, _ in generators])


def test_one_member_is_in_one_corridor_even_if_no_population_is_larger():
    limits = {"initial_population_size": 1, "min_population_size": 1, "max_population_size": 1}
    env = SwarmEnv("generational-firefly", observation="corridors", iterations=2, **limits)
    assert env.reset(seed=0)[0][NUMBER] == 0.0


@pytest.mark.parametrize("name", ["corridors", "rich+corridors"])
@pytest.mark.parametrize(
    "options",
    [
        {"scenario": "function:rastrigin-2"},
        {"optimizer": "ant-colony", "scenario": "case1"},
        {"optimizer": "glowworm", "scenario": "rooms:0"},
    ],
    ids=["function", "ants", "glowworms"],
)
def test_members_that_are_not_whole_paths_are_refused(name, options):
    refused(lambda: small(name, **options), repr(name), "whole paths", error=SettingError)


@pytest.mark.parametrize("window", [0, RECENT - 1, RECENT + 1])
def test_a_simulation_with_other_records_of_newcomers_is_refused(window):
    layout = make_observation("rich+corridors")
    simulation = Simulation(Firefly, Settings(**SMALL), 1, arrival_window=window)
    for call in (layout.space, layout.observe):
        refused(lambda call=call: call(simulation), "rich+corridors", "arrival_window=5", error=SettingError)
