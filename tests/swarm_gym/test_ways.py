"""Planned ways: free, in different corridors, the same in every call; and new members beside them."""

import itertools
import math

import numpy as np
import pytest
import shapely

from helpers.builders import make_problem, small_grid_problem
from helpers.plans import obstacles_of
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.problem.geometry.curves import nearest_curves
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import make_scenario
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.ways import NUM_WAYS, differ, planned_ways, with_ways

NAMES = ("case1", "case2", "case3", "random-fields:test:7", "rooms:0", "caves:3")


def winding(loop, point):
    """Return how often a closed polyline winds around a point, by the sum of its angles."""
    angles = [math.atan2(y - point[1], x - point[0]) for x, y in loop]
    turns = [math.remainder(b - a, math.tau) for a, b in itertools.pairwise(angles)]
    return round(math.fsum(turns) / math.tau)


@pytest.mark.parametrize("name", slow_but(NAMES[::2], NAMES))
def test_ways_are_free_and_pass_obstacles_on_different_sides(name):
    scenario = make_scenario(name)
    # Ways touch obstacles, so these are a little smaller.
    ways, core = planned_ways(scenario), obstacles_of(scenario).buffer(-0.01)
    assert 2 <= len(ways) <= NUM_WAYS
    for way, again in zip(ways, planned_ways(scenario), strict=True):
        np.testing.assert_array_equal(way, again)
        np.testing.assert_allclose(way[[0, -1]], [scenario.start, scenario.target], atol=1e-9)
        assert shapely.LineString(way).intersection(core).length == 0.0
    lengths = list(map(length_of, ways))
    assert lengths[0] <= 1.1 * shortest_path(scenario)[0]
    assert lengths[1:] == sorted(lengths[1:])


def test_ways_differ_if_their_loop_winds_around_an_obstacle():
    rng = np.random.default_rng(3)
    found = []
    for _ in range(200):
        ends = rng.uniform(0.0, 1.0, (2, 2))
        way, other = ([ends[0], *rng.uniform(0.0, 1.0, (k, 2)), ends[1]] for k in (3, 4))
        inside = rng.uniform(0.0, 1.0, (2, 2))
        expected = any(winding([*way, *other[-2::-1]], point) != 0 for point in inside)
        assert differ(np.array(way), np.array(other), inside) == expected
        found.append(expected)
    assert 20 < sum(found) < 180
    assert not differ(np.array(way), np.array(way), inside)


def test_a_way_that_a_curve_can_follow_is_followed():
    problem = small_grid_problem("bezier", 3, seed=4)
    low, high = problem.bounds
    vector = low + (high - low) * np.array([0.3, 0.4, 0.7, 0.2, 0.8, 0.4])
    (found,) = nearest_curves(problem.points(vector)[None], 3)
    # Even distances along the curve are not even in its parameter, so the fit is near but not the same.
    far = np.abs(problem.points(found) - problem.points(vector)).max()
    assert far < 0.1 * (high - low).max()


def test_where_there_are_few_ways_they_repeat():
    problem = with_ways(make_problem("case1", 9))
    assert problem.ways.shape == (NUM_WAYS, 9)
    number = len(planned_ways(problem.scenario))
    np.testing.assert_array_equal(problem.ways, problem.ways[np.arange(NUM_WAYS) % number])
    low, high = problem.bounds
    assert (low <= problem.ways).all()
    assert (problem.ways <= high).all()
    assert problem == make_problem("case1", 9)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("case2", {"num_waypoints": 31}),
        ("rooms:0", {"encoding": "bezier", "num_control_points": 8}),
        ("caves:3", {"encoding": "bezier", "num_control_points": 8}),
    ],
)
def test_guided_members_lie_near_ways_and_uniform_ones_do_not(name, options):
    def shortest_distance(source):
        env = SwarmEnv("particle-swarm", scenario=name, source=source, initial_population_size=30, **options)
        env.reset(seed=4)
        problem = env.simulation.problems[0]
        paths = problem.points(env.simulation.positions(0))
        ways = problem.points(with_ways(problem).ways)
        distances = np.abs(paths[:, None] - ways).mean(axis=(2, 3)).min(axis=1)
        return distances.mean() / problem.scenario.straight_line

    assert shortest_distance("guided") < 0.5 * shortest_distance("uniform")


def test_guided_members_are_the_same_alone_and_in_a_vector():
    options = {"scenario": "rooms:0", "encoding": "bezier", "source": "guided", "initial_population_size": 12}
    vector = SwarmVectorEnv(3, "multivariate", **options)
    together, _ = vector.reset(seed=[5, 6, 7])
    for _ in range(4):
        together, *_ = vector.step(np.tile([15.0, 0.5], (3, 1)))
    for k, seed in enumerate((5, 6, 7)):
        alone = SwarmEnv("multivariate", **options)
        observation, _ = alone.reset(seed=seed)
        for _ in range(4):
            observation, *_ = alone.step(np.array([15.0, 0.5]))
        np.testing.assert_array_equal(observation, together[k])


def test_every_map_of_an_episode_has_its_own_ways():
    env = SwarmEnv("firefly", scenario="dynamic:case1-gate@20", source="guided", initial_population_size=10)
    before, after = env.simulation.problems
    assert not np.array_equal(before.ways, after.ways)
    env.reset(seed=1)
    for _ in range(25):
        env.step(np.array([20.0, 0.5]))
    assert env.simulation.swarms.problem[0] == 1


@pytest.mark.parametrize(
    ("optimizer", "options", "message"),
    [
        ("ant-colony", {"scenario": "block:30"}, "guided.*points of a walk"),
        ("firefly", {"scenario": "function:rastrigin-5"}, "guided.*vectors of"),
        ("firefly", {"scenario": "dynamic:case3-drive@1,every=1,distance=80"}, "guided.*robot that drives"),
        ("firefly", {"scenario": "case1", "smooth_share": 0.5}, "smooth_share.*no effect.*guided"),
    ],
)
def test_guided_members_are_refused_where_there_are_no_ways(optimizer, options, message):
    with pytest.raises(SettingError, match=message):
        SwarmEnv(optimizer, source="guided", **options)
