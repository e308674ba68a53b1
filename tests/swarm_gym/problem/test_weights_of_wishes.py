"""The weights of nearness, ground and curvature in the fitness on grid maps."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from helpers.builders import small_grid_problem
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError, SettingError
from swarm_gym.planning.wishes import integral
from swarm_gym.problem import GridProblem
from swarm_gym.problem.grid.nearness import nearness
from swarm_gym.reference import ensure_optima
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.scenarios.graded_map import GradedMap
from swarm_gym.scenarios.growing import grown
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
    weights = {"distance_weight": WEIGHT, "ground_weight": WEIGHT, "curvature_weight": WEIGHT}
    ground = with_ground(plain)
    alone = [
        dataclasses.replace(ground, **(dict.fromkeys(weights, 0.0) | {name: weight}))
        for name, weight in weights.items()
    ]
    assert len({str(problem.identity) for problem in (*alone, with_ground(plain, 1), ground)}) == 5
    assert weighted.lower_bound == plain.lower_bound


GROUND_WEIGHT, CURVATURE_WEIGHT = 1.5, 0.7


def with_ground(problem, seed=0):
    """Return the problem on a scenario with random costs of ground, which have a weight."""
    scenario = problem.scenario
    costs = np.random.default_rng(seed).uniform(0.0, 3.0, scenario.map.blocked.shape)
    scenario = dataclasses.replace(scenario, ground=GradedMap(scenario.map, costs))
    return dataclasses.replace(problem, scenario=scenario, ground_weight=GROUND_WEIGHT)


@pytest.mark.parametrize(("encoding", "num_points"), [("bezier", 3), ("waypoints", 7)])
@pytest.mark.parametrize("distance_weight", [0.0, WEIGHT])
def test_the_costs_of_ground_add_the_integral_that_plain_python_finds(encoding, num_points, distance_weight):
    plain = small_grid_problem(encoding, num_points, seed=5, resolution=0.05, y_up=True)
    weighted = dataclasses.replace(with_ground(plain), distance_weight=distance_weight)
    grid, ground = plain.scenario.map, weighted.scenario.ground
    costs = np.pad(GROUND_WEIGHT * ground.costs + distance_weight * nearness(grid, 0.0), 60)
    for vector in vectors_of(plain, 6):
        expected = integral(costs, polyline(plain, vector) + 60.0) * grid.resolution
        assert added(plain, weighted, vector) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("encoding", "num_points"), [("bezier", 3), ("waypoints", 7), ("waypoints", 1)])
def test_the_weight_of_curvature_adds_the_sum_over_bends_that_plain_python_finds(encoding, num_points):
    plain = small_grid_problem(encoding, num_points, seed=6, resolution=0.05, origin=(-3.2, 7.1))
    curved = dataclasses.replace(plain, curvature_weight=CURVATURE_WEIGHT)
    for vector in vectors_of(plain, 6):
        points = plain.scenario.map.to_map(polyline(plain, vector))
        steps = np.diff(points, axis=0)
        lengths = np.hypot(*steps.T)
        units = steps[lengths > 0.0] / lengths[lengths > 0.0, None]
        between = (lengths[lengths > 0.0][1:] + lengths[lengths > 0.0][:-1]) / 2.0
        bends = (np.square(np.diff(units, axis=0)).sum(axis=1) / between).sum()
        assert added(plain, curved, vector) == pytest.approx(CURVATURE_WEIGHT * bends, rel=1e-6, abs=1e-9)


def test_the_curvature_of_a_smooth_curve_is_the_integral_along_it():
    # A Bezier curve with control points (0, 0), (w / 2, h) and (w, 0) is a parabola.
    width, height = 40.0, 9.0
    grid = GridMap("open", np.zeros((40, 60), dtype=bool))
    scenario = GridScenario("open", grid, (5.0, 20.0), (5.0 + width, 20.0))
    plain = GridProblem(scenario, "bezier", 1)
    curved = dataclasses.replace(plain, curvature_weight=2.0)
    t = (np.arange(100_000) + 0.5) / 100_000
    speed = np.hypot(width, 2.0 * height * (1.0 - 2.0 * t))
    curvature = 4.0 * height * width / speed**3
    expected = 2.0 * (curvature**2 * speed).mean()
    found = added(plain, curved, np.array([5.0 + width / 2.0, 20.0 + height]))
    assert found == pytest.approx(expected, rel=2e-3)


def test_a_straight_path_bends_nowhere_and_one_that_turns_back_costs_a_finite_sum():
    grid = GridMap("open", np.zeros((40, 60), dtype=bool))
    scenario = GridScenario("open", grid, (5.0, 20.0), (45.0, 20.0))
    for column, is_straight in ((25.0, True), (-100.0, False)):
        plain = GridProblem(scenario, "bezier", 1)
        curved = dataclasses.replace(plain, curvature_weight=1.0)
        bends = added(plain, curved, np.array([column, 20.0]))
        assert math.isfinite(bends)
        assert bends == pytest.approx(0.0, abs=1e-12) if is_straight else bends > 1.0


def test_a_swarm_goes_around_dear_ground():
    costs = np.zeros((40, 60))
    costs[10:30, 25:35] = 5.0
    graded = GradedMap(GridMap("swamp", np.zeros(costs.shape, dtype=bool)), costs)
    scenario = GridScenario("swamp", graded.grid, (5.0, 20.0), (55.0, 20.0), graded)
    inside = {}
    for weight in (0.0, 1.0):
        env = SwarmEnv(
            "differential-evolution", scenario=scenario, ground_weight=weight, num_waypoints=9, iterations=60
        )
        env.reset(seed=1)
        for _ in range(60):
            env.step(np.array([40.0, 0.0]))
        path = make_problem(scenario, num_waypoints=9).points(env.simulation.best_position(0))
        inside[weight] = integral(costs, path)
    assert inside[0.0] > 30.0
    assert inside[1.0] < 10.0


def test_ground_grows_and_changes_with_the_map():
    free = np.zeros((9, 14), dtype=bool)
    costs = np.arange(9.0 * 14.0).reshape(9, 14)
    walls = free.copy()
    walls[4, 7] = True
    graded = GradedMap(GridMap("walls", walls), costs)
    scenario = GridScenario("walls", graded.grid, (0.0, 4.0), (13.0, 4.0), graded)
    small = grown(scenario, 0.5)
    parts = small.map.height // 9
    assert parts > 1
    at = small.ground.costs[~small.map.blocked]
    rows, columns = np.nonzero(~small.map.blocked)
    np.testing.assert_array_equal(at, costs[rows // parts, columns // parts])
    moved = scenario.on(GridMap("other", free))
    np.testing.assert_array_equal(moved.ground.costs, graded.costs)
    assert moved != dataclasses.replace(moved, ground=None)
    assert moved == dataclasses.replace(moved, ground=GradedMap(moved.map, graded.costs))


def test_bad_weights_and_what_needs_optima_are_refused():
    for name in ("distance_weight", "ground_weight", "curvature_weight"):
        for value in (-1.0, math.nan, "2"):
            with pytest.raises(SettingError, match=f"{name} must"):
                make_problem("rooms:0", **{name: value})
    with pytest.raises(SettingError, match=r"ground_weight 1: map 'rooms:0' has no costs of ground"):
        make_problem("rooms:0", ground_weight=1.0)
    with pytest.raises(SettingError, match=r"curvature_weight 2: the least fitness on map"):
        ensure_optima([make_problem("rooms:0", curvature_weight=2.0)])
    with pytest.raises(ScenarioError, match="ground must be a GradedMap of this map"):
        dataclasses.replace(make_scenario("rooms:0"), ground=GradedMap(GridMap("a", [[False]]), [[1.0]]))
    with pytest.raises(SettingError, match=r"'distance_weight' has no effect on analytic maps"):
        make_problem("case1", distance_weight=1.0)
    with pytest.raises(SettingError, match="distance_weight 2: the least fitness on map"):
        ensure_optima([make_problem("rooms:0", distance_weight=2.0)])
    with pytest.raises(SettingError, match="needs optima, and none are known with distance_weight; choose"):
        SwarmEnv("firefly", scenario="rooms:0", encoding="bezier", distance_weight=2.0, reward="optimality")
    assert Settings().distance_weight == 0.0
