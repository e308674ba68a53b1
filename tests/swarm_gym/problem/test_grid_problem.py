"""Problems on grid maps: kernels against plain Python, and what must hold of any path."""

import dataclasses
import math

import numpy as np
import pytest

from helpers.builders import random_grid_scenario, small_grid_problem
from helpers.compiled import compiled
from helpers.loops import looped
from helpers.refusals import refused as assert_refused
from helpers.slow import slow_but
from oracles import naive_grid
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem import GridProblem
from swarm_gym.problem.tables import evaluate_entry, repair_entry, select, stack
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem, problems_for

GEOMETRIES = {
    "cells": {},
    "ros": {"resolution": 0.05, "origin": (-3.2, 7.1), "y_up": True},
    "coarse": {"resolution": 3.0, "origin": (100.0, -50.0)},
}
ENCODINGS = [("bezier", n) for n in range(1, 7)] + [("waypoints", n) for n in (1, 2, 3, 7, 8, 31)]
LONG = [("bezier", number) for number in (4, 5, 6)]  # for plain Python
all_encodings = pytest.mark.parametrize(("encoding", "num_points"), ENCODINGS)
all_geometries = looped("geometry", GEOMETRIES.values())


def random_vectors(problem, count, seed=0):
    """Inside the bounds, near the straight line, and far outside the map."""
    rng = np.random.default_rng(seed)
    low, high = problem.bounds
    middle = (low + high) / 2
    return [middle + rng.choice([0.2, 1.0, 3.0]) * (rng.uniform(low, high) - middle) for _ in range(count)]


def empty_map(height=20, width=30, **geometry):
    return GridMap("empty", np.zeros((height, width), dtype=np.bool_), **geometry)


def straight(problem):
    """The vector whose path is the straight line."""
    if problem.encoding == "waypoints":
        return np.zeros(problem.dimension)
    share = np.arange(1, problem.num_points + 1) / (problem.num_points + 1)
    start, target = np.array(problem.scenario.start), np.array(problem.scenario.target)
    return (start[:, None] + (target - start)[:, None] * share).ravel()


# Against plain Python.


@all_geometries
@pytest.mark.parametrize(
    ("encoding", "num_points"), slow_but([one for one in ENCODINGS if one not in LONG], ENCODINGS)
)
def test_fitness_collision_samples_and_bounds_are_the_naive_ones(encoding, num_points, geometry):
    problem = small_grid_problem(encoding, num_points, seed=num_points, **geometry)
    oracle = naive_grid.Problem(problem)
    assert problem.dimension == oracle.dimension
    np.testing.assert_allclose(problem.bounds, [oracle.lower, oracle.upper], rtol=1e-10, atol=1e-9)
    for vector in random_vectors(problem, 6):
        assert problem.evaluate(vector) == pytest.approx(oracle.cost(vector), rel=1e-10)
        np.testing.assert_allclose(problem.curve.samples(vector), oracle.path.samples(vector), rtol=1e-10)


@looped("repair_degree", [0.3, 1.0])
@all_geometries
@pytest.mark.parametrize(
    ("encoding", "num_points"), slow_but([one for one in ENCODINGS if one not in LONG], ENCODINGS)
)
def test_a_repair_is_the_naive_one(encoding, num_points, geometry, repair_degree):
    problem = small_grid_problem(encoding, num_points, seed=num_points + 1, **geometry)
    oracle = naive_grid.Problem(problem)
    for vector in random_vectors(problem, 5):
        expected = oracle.repaired(vector, repair_degree)
        # Offsets outside the workspace are taken into it where they move.
        np.testing.assert_allclose(problem.repaired(vector, repair_degree), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_table_leads_from_every_cell_to_a_nearest_free_one(seed):
    problem = small_grid_problem(seed=seed, rock=0.4)
    free = np.argwhere(~problem.scenario.map.blocked)
    height, width = problem.scenario.map.blocked.shape
    oracle = naive_grid.Problem(problem)
    for row in range(-1, height + 1):
        for column in range(-1, width + 1):
            found = oracle.nearest_free(column, row)[::-1]
            assert problem.scenario.map.is_free(found[::-1])
            squares = ((free - (row, column)) ** 2).sum(axis=1)
            assert ((np.array(found) - (row, column)) ** 2).sum() == squares.min()


# What must hold of any path.


@all_geometries
@all_encodings
def test_a_straight_path_on_an_empty_map_costs_the_straight_line(encoding, num_points, geometry):
    grid = empty_map(**geometry)
    start, target = (tuple(end) for end in grid.to_map([(2.2, 3.1), (26.7, 15.4)]).tolist())
    problem = GridProblem(GridScenario("empty", grid, start, target), encoding, num_points)
    fitness, collision = problem.evaluate(straight(problem))
    assert fitness == pytest.approx(problem.lower_bound, rel=1e-12)
    assert problem.lower_bound == pytest.approx(math.dist(start, target))
    assert collision == 0.0


@pytest.mark.parametrize("encoding", ["bezier", "waypoints"])
def test_stacked_problems_are_the_problems_themselves(encoding):
    shapes = ((19, 26), (30, 12), (9, 41))
    problems = [
        GridProblem(random_grid_scenario(seed, shape, resolution=1.0 + seed), encoding, 3)
        for seed, shape in enumerate(shapes)
    ]
    tables = stack([problem.table for problem in problems])
    for index, problem in enumerate(problems):
        table = compiled(select)(tables, index)
        for vector in random_vectors(problem, 5):
            path = problem._path(vector)
            assert evaluate_entry(table, path) == problem.evaluate(vector)
            repair_entry(table, path, 0.7)
            assert path[1 : problem.dimension + 1].tolist() == problem.repaired(vector, 0.7).tolist()


@all_geometries
@all_encodings
def test_fitness_and_collision_keep_to_their_bounds(encoding, num_points, geometry):
    problem = small_grid_problem(encoding, num_points, **geometry)
    rng, (low, high) = np.random.default_rng(0), problem.bounds
    corners = [np.where(rng.random(problem.dimension) < 0.5, low, high) for _ in range(20)]
    for vector in [*rng.uniform(low, high, (20, problem.dimension)), *corners, low, high]:
        fitness, collision = problem.evaluate(vector)
        assert fitness >= problem.lower_bound * (1 - 1e-12)
        assert 0.0 <= collision <= problem.collision_bound


@all_geometries
@all_encodings
def test_pictures_show_the_path_from_start_to_target(encoding, num_points, geometry):
    problem = small_grid_problem(encoding, num_points, **geometry)
    vectors = np.array(random_vectors(problem, 4))
    drawn = problem.points(vectors)
    ends = np.array([problem.scenario.start, problem.scenario.target])
    np.testing.assert_allclose(drawn[:, [0, -1]], np.broadcast_to(ends, (4, 2, 2)))
    for points, vector in zip(drawn, vectors, strict=True):
        np.testing.assert_array_equal(points, problem.points(vector))
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        samples = problem.curve.samples(vector)
        fitness, _ = dataclasses.replace(problem, penalty=0.0).evaluate(vector)
        # A polyline of fewer points than samples is shorter by little, never longer.
        assert lengths <= fitness * (1 + 1e-9)
        assert lengths == pytest.approx(np.linalg.norm(np.diff(samples, axis=0), axis=1).sum(), rel=0.01)


@pytest.mark.parametrize("number", [100, pytest.param(1000, marks=pytest.mark.slow)])
def test_curves_of_many_control_points_are_curves(number):
    scenario = random_grid_scenario(0)
    problem = GridProblem(scenario, "bezier", number)
    assert problem.curve.weights.dtype == np.float64
    assert problem.evaluate(straight(problem)) == pytest.approx(
        GridProblem(scenario, "waypoints", 1).evaluate(np.zeros(1)), rel=0.2
    )


def test_a_target_on_the_edge_of_its_cell_is_free_for_the_kernels_too():
    # 0.175 / 0.05 is 3.4999999999999996: with 1.5 added it would round up into the next cell.
    blocked = np.zeros((5, 9), dtype=np.bool_)
    blocked[:, 4:] = True
    scenario = GridScenario("edge", GridMap("edge", blocked, 0.05), (0.0, 0.1), (0.175, 0.1))
    for encoding in ("bezier", "waypoints"):
        problem = GridProblem(scenario, encoding, 3)
        assert problem.evaluate(straight(problem))[1] == 0.0


# Repair.


@all_encodings
def test_a_repair_stays_inside_the_bounds_and_leaves_what_needs_none_alone(encoding, num_points):
    problem = small_grid_problem(encoding, num_points, seed=2)
    low, high = problem.bounds
    for vector in np.random.default_rng(0).uniform(low, high, (30, problem.dimension)):
        assert problem.repaired(vector, 0.0).tolist() == vector.tolist()
        repaired = problem.repaired(vector, 1.0)
        assert (low <= repaired).all()
        assert (repaired <= high).all()
        assert (repaired.tolist() == vector.tolist()) >= (problem.evaluate(vector)[1] == 0.0)


@pytest.mark.parametrize(
    ("encoding", "num_points", "share_left"),
    [("bezier", 3, 0.0), ("waypoints", 7, 0.4), ("waypoints", 31, 0.4)],
)
def test_repairs_push_the_straight_line_off_a_block_in_its_way(encoding, num_points, share_left):
    """A curve clears it for good; waypoints come close, but one repair may undo what another did."""
    for first in range(12, 32):
        blocked = np.zeros((30, 50), dtype=np.bool_)
        blocked[11:16, first : first + 6] = True
        scenario = GridScenario("block", GridMap("block", blocked), (2.0, 14.2), (47.0, 15.3))
        problem = GridProblem(scenario, encoding, num_points)
        vector = straight(problem)
        collision = [problem.evaluate(vector)[1]]
        for _ in range(4):
            vector = problem.repaired(vector, 1.0)
            collision.append(problem.evaluate(vector)[1])
        assert collision[0] > 5.0
        assert collision[1] < collision[0]
        assert min(collision) <= share_left * collision[0]
        assert share_left > 0.0 or collision[-1] == 0.0


def test_one_full_repair_lessens_most_collisions_of_random_curves():
    mended = []
    for seed in range(10):
        problem = small_grid_problem(seed=seed, rock=0.1)
        for vector in np.random.default_rng(seed).uniform(*problem.bounds, (10, problem.dimension)):
            before, after = problem.evaluate(vector)[1], problem.evaluate(problem.repaired(vector, 1.0))[1]
            if before > 0.0:
                mended.append(after < before)
    assert len(mended) > 50
    assert np.mean(mended) > 0.7


# What is asked of problems.


def test_equal_maps_under_other_names_are_the_same_problem():
    scenario = random_grid_scenario(1)
    grid = GridMap("renamed", scenario.map.blocked)
    twin = GridScenario("other", grid, scenario.start, scenario.target)
    assert GridProblem(twin).identity == GridProblem(scenario).identity
    for other in (
        GridProblem(scenario, "waypoints"),
        GridProblem(scenario, num_points=3),
        GridProblem(scenario, penalty=10.0),
        GridProblem(random_grid_scenario(1, y_up=True)),
    ):
        assert other.identity != GridProblem(scenario).identity


def settings_of(**options):
    return problems_for(Settings.from_options(Firefly, options))


def refused(*words, error=SettingError, **options):
    assert_refused(lambda: settings_of(**options), *words, error=error)


def test_settings_make_the_problems_they_describe():
    (curve,) = settings_of(scenario="rooms:0", encoding="bezier", num_control_points=4, penalty=100.0)
    assert curve == GridProblem(make_scenario("rooms:0"), "bezier", 4, 100.0)
    first, second = settings_of(scenario="caves:0-1", num_waypoints=9)
    assert (first.encoding, first.num_points, second.dimension) == ("waypoints", 9, 9)
    assert make_problem("rooms:0", encoding="bezier") == GridProblem(make_scenario("rooms:0"))


def test_maps_of_two_kinds_and_a_curve_on_an_analytic_map_are_refused_by_name():
    refused("'case1'", "'rooms:0'", scenario=["case1", "rooms:0"])
    refused("'rooms:0'", "'case1'", scenario=["rooms:0", "case1"])
    refused("'bezier'", "'case1'", scenario="case1", encoding="bezier")


def test_an_unknown_encoding_is_refused_with_the_known_ones():
    for options in ({}, {"num_waypoints": 5}, {"num_control_points": 5}):
        words = ("'spline'", "bezier", "waypoints")
        refused(*words, error=UnknownNameError, scenario="rooms:0", encoding="spline", **options)


@pytest.mark.parametrize(
    ("option", "options"),
    [
        ("penalty", {"scenario": "case1"}),
        ("num_control_points", {"scenario": "case1"}),
        ("length_weight", {"scenario": "rooms:0"}),
        ("num_control_points", {"scenario": "rooms:0"}),
        ("num_waypoints", {"scenario": "rooms:0", "encoding": "bezier"}),
    ],
)
def test_options_that_would_change_nothing_are_refused_by_name(option, options):
    value = getattr(Settings, option)
    refused(repr(option), **options, **{option: value})
    with pytest.raises(SettingError, match=option):
        make_problem(**options, **{option: value})


@pytest.mark.parametrize("value", [0, -1, 2.5, 10**6])
@pytest.mark.parametrize(
    ("option", "encoding"), [("num_control_points", "bezier"), ("num_waypoints", "waypoints")]
)
def test_a_wrong_number_of_points_is_refused_by_the_name_of_its_option(option, encoding, value):
    refused(option, repr(value), scenario="rooms:0", encoding=encoding, **{option: value})
    assert settings_of(scenario="rooms:0", encoding=encoding, **{option: 1})


@pytest.mark.parametrize("value", [-1.0, math.inf, math.nan, "500"])
def test_a_wrong_penalty_is_refused(value):
    refused("penalty", repr(value), scenario="rooms:0", penalty=value)
    assert settings_of(scenario="rooms:0", penalty=0.0)
