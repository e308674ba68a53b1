"""The weight of nearness to blocked cells in the fitness on grid maps."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from helpers.builders import small_grid_problem
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.planning.wishes import integral
from swarm_gym.problem.grid.nearness import nearness
from swarm_gym.reference import ensure_optima
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem

WEIGHT = 2.5


def pair(encoding, num_points, seed, **geometry):
    """Return a problem without the weight, and the same problem with it."""
    plain = small_grid_problem(encoding, num_points, seed=seed, **geometry)
    return plain, dataclasses.replace(plain, distance_weight=WEIGHT)


def added(plain, weighted, vector):
    """Return what the weight adds to the fitness, in map units; the rest must be equal, bit for bit."""
    fitness, collision = plain.evaluate(vector)
    more, same = weighted.evaluate(vector)
    assert same == collision
    return more - fitness


def vectors_of(problem, count, seed=1):
    rng = np.random.default_rng(seed)
    low, high = problem.bounds
    return rng.uniform(low, high, size=(count, len(low)))


def polyline(problem, vector):
    """Return the path as the fitness measures it, in cells."""
    points = problem.points(vector) if problem.encoding == "waypoints" else problem.curve.samples(vector)
    return problem.scenario.map.to_cells(points)


@pytest.mark.parametrize("geometry", [{}, {"resolution": 0.05, "origin": (-3.2, 7.1), "y_up": True}])
@pytest.mark.parametrize(("encoding", "num_points"), [("bezier", 3), ("waypoints", 7), ("waypoints", 1)])
def test_the_weight_adds_the_integral_that_plain_python_finds(encoding, num_points, geometry):
    plain, weighted = pair(encoding, num_points, num_points, **geometry)
    grid = plain.scenario.map
    costs = np.pad(nearness(grid, 0.0), 60)  # free of cost outside
    for vector in vectors_of(plain, 6):
        expected = WEIGHT * integral(costs, polyline(plain, vector) + 60.0) * grid.resolution
        assert added(plain, weighted, vector) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("slope", [(1.0, 0.0), (0.0, 1.0), (3.0, 1.0), (-1.0, -2.0), (1.0, 1.0)])
def test_the_cost_of_a_straight_path_is_the_mean_over_fine_samples(slope):
    plain, weighted = pair("waypoints", 1, 4)
    grid = plain.scenario.map
    middle = np.array(grid.blocked.shape[::-1]) / 2.0 - 0.5
    way = np.array(slope) / np.hypot(*slope) * 4.3
    ends = [grid.to_map(middle + sign * way + (0.013, 0.021)) for sign in (-1.0, 1.0)]
    free = dataclasses.replace(grid, blocked=grid.blocked & (np.arange(grid.blocked.shape[1]) < 2))
    scenario = dataclasses.replace(plain.scenario, map=free, start=tuple(ends[0]), target=tuple(ends[1]))
    plain, weighted = (dataclasses.replace(one, scenario=scenario) for one in (plain, weighted))
    shares = (np.arange(200_000) + 0.5) / 200_000
    columns, rows = np.rint(free.to_cells(ends[0] + shares[:, None] * (np.subtract(*ends[::-1])))).T.astype(
        int
    )
    expected = WEIGHT * nearness(free, 0.0)[rows, columns].mean() * math.dist(*ends)
    assert added(plain, weighted, np.zeros(1)) == pytest.approx(expected, rel=1e-4)


def test_nearness_is_one_beside_obstacles_and_falls_with_distance():
    grid = small_grid_problem("bezier", 3, seed=2).scenario.map
    near = nearness(grid, 0.0)
    assert (near[grid.blocked] == 0.0).all()
    for row, column in itertools.product(*map(range, grid.blocked.shape)):
        if grid.blocked[row, column]:
            continue
        # The nearest point of a blocked cell's square, from the middle of this one.
        rows, columns = np.nonzero(grid.blocked)
        gaps = np.maximum(np.abs(np.stack([rows - row, columns - column])) - 0.5, 0.0)
        assert near[row, column] == pytest.approx(math.exp(-np.hypot(*gaps).min() / 3.0), rel=1e-9)


def test_a_swarm_with_the_weight_keeps_more_distance():
    def mean_nearness(weight):
        env = SwarmEnv(
            "particle-swarm",
            scenario="rooms:0",
            encoding="bezier",
            distance_weight=weight,
            source="guided",
            iterations=30,
        )
        found = []
        for seed in range(4):
            env.reset(seed=seed)
            for _ in range(30):
                env.step(np.array([40.0, 0.0]))
            problem = make_problem("rooms:0", encoding="bezier")
            path = polyline(problem, env.simulation.best_position(0))
            found.append(integral(nearness(problem.scenario.map, 0.0), path))
        return np.mean(found)

    assert mean_nearness(20.0) < 0.95 * mean_nearness(0.0)


def test_names_of_problems_differ_by_the_weight_and_old_names_stay():
    plain, weighted = pair("bezier", 3, 5)
    assert plain.identity != weighted.identity
    assert len(plain.identity) == 5  # as in versions without the weight
    assert weighted.lower_bound == plain.lower_bound


def test_bad_weights_and_what_needs_optima_are_refused():
    for value in (-1.0, math.nan, "2"):
        with pytest.raises(SettingError, match="distance_weight must"):
            make_problem("rooms:0", distance_weight=value)
    with pytest.raises(SettingError, match=r"'distance_weight' has no effect on analytic maps"):
        make_problem("case1", distance_weight=1.0)
    with pytest.raises(SettingError, match="distance_weight 2: the least fitness on map"):
        ensure_optima([make_problem("rooms:0", distance_weight=2.0)])
    with pytest.raises(SettingError, match="not known"):
        SwarmEnv("firefly", scenario="rooms:0", encoding="bezier", distance_weight=2.0, reward="optimality")
    assert Settings().distance_weight == 0.0
