"""Final repair: paths are pushed out of obstacles and pulled tight, and are free, as shapely sees it."""

import numpy as np
import pytest
import shapely

from helpers.builders import random_scenario, small_grid_problem
from helpers.loops import looped
from helpers.shapes import shape
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.final_repair import final_repair
from swarm_gym.final_repair.obstacles import MARGIN, contact, number_of, obstacles_of
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Polygon, Scenario
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import make_problem

START, TARGET = (20.0, 300.0), (980.0, 300.0)


def length_of(path):
    return np.hypot(*np.diff(path, axis=0).T).sum()


def depth_in(path, obstacle):
    """Length of a path inside an obstacle that is smaller by a little, in map units."""
    return shapely.LineString(path).intersection(shape(obstacle, 2048).buffer(-1e-3)).length


def problem_with(*obstacles):
    return AnalyticProblem(Scenario("made", START, TARGET, obstacles, initial_range=(-200.0, 200.0)))


def line(num=31):
    return np.stack([np.linspace(START[0], TARGET[0], num + 2), np.full(num + 2, 300.0)], axis=-1)


@looped("seed", range(2))
def test_depths_of_segments_are_the_least_shifts_out_of_obstacles(seed):
    """A segment that is shifted as a contact says touches the obstacle, and one shifted by less enters it."""
    rng = np.random.default_rng(seed)
    scenario = random_scenario(rng)
    obstacles = obstacles_of(scenario)
    in_order = sorted(scenario.obstacles, key=lambda each: isinstance(each, Polygon))
    assert number_of(obstacles) == len(in_order)
    entering = 0
    for _ in range(300):
        near = shape(in_order[rng.integers(len(in_order))]).centroid
        ends = rng.normal((near.x, near.y), 60.0, (2, 2))
        for i, obstacle in enumerate(in_order):
            found = contact(obstacles, i, *ends[0], *ends[1])
            area = shape(obstacle, 512)
            if not shapely.LineString(ends).intersects(area):
                assert found.depth <= 1e-3  # the area of a circle is a polygon inside of it
                continue
            assert found.depth > 0.0
            entering += 1
            shift = np.array([found.x, found.y])
            assert np.hypot(*shift) == pytest.approx(1.0)
            assert shapely.LineString(ends + (found.depth + 1e-9) * shift).distance(area) < 0.01
            assert not shapely.LineString(ends + (found.depth + 0.01) * shift).intersects(area)
            assert shapely.LineString(ends + max(found.depth - 0.01, 0.0) * shift).intersects(area)
    assert entering > 10


@pytest.mark.parametrize("case", slow_but(["case2"], ["case1", "case2", "case3"]))
def test_best_paths_of_runs_are_free_after_repair_and_no_longer(case):
    swarms = SwarmVectorEnv(12, scenario=case, iterations=60, initial_population_size=60)
    swarms.reset(seed=5)
    for _ in range(60):
        swarms.step(np.tile([60.0, 0.3], (12, 1)))
    problem, grazing = swarms.simulation.problem_of(0), 0
    for path in swarms.simulation.paths.best():
        found = final_repair(problem, path)
        assert found is not None
        assert problem.is_clear(found.path)
        assert sum(depth_in(found.path, obstacle) for obstacle in problem.scenario.obstacles) == 0.0
        np.testing.assert_array_equal(found.path[[0, -1]], path[[0, -1]])
        assert found.length == pytest.approx(length_of(found.path))
        assert found.length >= shortest_path(problem.scenario)[0] * (1.0 - 1e-4)
        grazing += not problem.is_clear(path)
        if found.planned == 0:
            assert found.length <= 1.003 * length_of(path)
    assert grazing > 0


def test_a_free_path_is_pulled_tight():
    problem = problem_with(Circle(500, 250, 60))
    path = line()
    path[1:-1, 1] += 150.0 * np.sin(np.linspace(0.0, np.pi, 33))[1:-1]
    found = final_repair(problem, path)
    shortest, _ = shortest_path(problem.scenario)
    assert shortest <= found.length < 1.001 * shortest < length_of(path)
    assert (found.planned, len(found.path) <= 33) == (0, True)
    assert found.path[:, 1].max() > 309.0  # on the side that it was on


def test_a_straight_line_that_is_free_stays():
    found = final_repair(problem_with(Circle(500, 100, 60)), line())
    np.testing.assert_array_equal(found.path, [START, TARGET])


def test_the_least_change_is_made_when_pushed():
    problem = problem_with(Circle(500.0, 250.0, 50.0 + 0.2))
    found = final_repair(problem, line())
    assert found.planned == 0
    assert abs(found.path[:, 1] - 300.0).max() < 0.2 + 10 * MARGIN + 0.01


def test_a_path_through_the_middle_of_an_obstacle_is_planned_anew():
    """Two overlapping rectangles: out of one is into the other."""
    wall = (Polygon.rectangle(480, 100, 500, 330), Polygon.rectangle(490, 270, 510, 560))
    found = final_repair(problem_with(*wall), line())
    assert found.planned == 1
    assert found.length == pytest.approx(shortest_path(problem_with(*wall).scenario)[0], rel=0.02)


@pytest.mark.parametrize("seed", slow_but(range(3), range(8)))
def test_paths_on_grids_are_free_after_repair(seed):
    problem = small_grid_problem("bezier", 4, seed)
    rng = np.random.default_rng(seed)
    low, high = problem.bounds
    for _ in range(10):
        path = problem.points(rng.uniform(low, high))
        found = final_repair(problem, path)
        assert problem.is_clear(found.path)
        assert found.length >= shortest_path(problem.scenario)[0] * (1.0 - 1e-9)
        assert (found.planned > 0) or problem.is_clear(path)


def test_there_is_no_repair_between_separated_ends():
    wall = [[False, True, False]]
    grid = GridMap("walled", np.array([[False, False, False], *wall, [False, False, False]]))
    problem = make_problem(GridScenario("around", grid, (0.0, 0.0), (0.0, 2.0)), encoding="bezier")
    assert final_repair(problem, np.array([[0.0, 0.0], [1.0, 1.0], [0.0, 2.0]])) is not None
    walls = ((300, 100, 700, 120), (300, 480, 700, 500), (300, 100, 320, 500), (680, 100, 700, 500))
    ring = tuple(Polygon.rectangle(*corners) for corners in walls)
    caged = Scenario("caged", START, (500.0, 300.0), ring, initial_range=(-200.0, 200.0))
    path = np.array([START, (500.0, 300.0)])
    assert final_repair(AnalyticProblem(caged), path) is None


def test_info_has_the_repaired_path_at_the_end():
    env = SwarmEnv(scenario="case3", iterations=3, final_repair=True)
    _, info = env.reset(seed=2)
    assert "repaired_path" not in info
    for _ in range(3):
        _, _, ended, _, info = env.step(np.array([60, 0.3]))
        assert ("repaired_path" in info) == ended == ("repaired_length" in info)
    path = info["repaired_path"]
    assert path.shape == info["best_path"].shape
    assert env.simulation.problem_of(0).is_clear(path)
    assert info["repaired_length"] == pytest.approx(length_of(path))
    assert info["repair_evaluations"] >= 1.0
    plain = SwarmEnv(scenario="case3", iterations=3)
    plain.reset(seed=2)
    for _ in range(3):
        _, _, _, _, without = plain.step(np.array([60, 0.3]))
    np.testing.assert_array_equal(without["best_path"], info["best_path"])
    assert without["evaluations"] == info["evaluations"]


def test_an_option_that_is_no_flag_or_has_no_effect_is_refused():
    with pytest.raises(SettingError, match="final_repair must be True or False, got 'yes'"):
        SwarmEnv(final_repair="yes")
    with pytest.raises(SettingError, match="option 'final_repair' has no effect on test functions"):
        SwarmEnv(scenario="function:booth-2", final_repair=True)
