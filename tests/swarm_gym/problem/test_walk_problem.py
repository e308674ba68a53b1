"""Walks: what is left of the way from a point, against shapely; which options say something about them."""

import numpy as np
import pytest
import shapely

from helpers.builders import METRES, random_grid_scenario
from helpers.compiled import compiled
from helpers.grids import area_of
from helpers.loops import looped
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.problem import WalkProblem
from swarm_gym.problem.tables import select, stack
from swarm_gym.scenarios import GridScenario
from swarm_gym.worlds import make_problem

GEOMETRIES = ({}, METRES)


def walk_problem(seed, **geometry):
    return WalkProblem(random_grid_scenario(seed, **geometry), penalty=20.0)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@looped("seed", range(6))
def test_fitness_is_the_way_to_the_target_and_a_penalty_for_what_is_blocked(seed, geometry):
    problem = walk_problem(seed, **geometry)
    grid, rng = problem.scenario.map, np.random.default_rng(seed)
    obstacles = area_of(grid.blocked)
    target = problem.scenario.target
    for _ in range(30):
        point = rng.uniform(*problem.bounds)
        fitness, collision = problem.evaluate(point)
        in_cells = shapely.LineString(grid.to_cells([point, target]))
        blocked = in_cells.intersection(obstacles).length
        assert collision == pytest.approx(blocked * grid.resolution, abs=1e-9)
        assert fitness == pytest.approx(np.hypot(*(point - target)) + 20.0 * blocked, rel=1e-9)
        assert collision <= problem.collision_bound
        assert fitness >= problem.lower_bound - np.hypot(*(point - problem.scenario.start)) - 1e-9


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_repair_moves_a_point_out_of_a_blocked_cell_by_its_degree(geometry):
    problem = walk_problem(1, **geometry)
    grid = problem.scenario.map
    for row, column in np.argwhere(grid.blocked)[::5]:
        point = grid.to_map((column + 0.2, row - 0.3))
        assert problem.repaired(point, 0.0) == pytest.approx(point, rel=1e-12)
        out = problem.repaired(point, 1.0)
        assert grid.is_free(grid.cell_of(out))
        assert problem.repaired(point, 0.5) == pytest.approx((point + out) / 2.0)
        # No free cell is nearer to the middle of the blocked one.
        distances = np.hypot(*(np.argwhere(~grid.blocked)[:, ::-1] - (column, row)).T)
        assert np.hypot(*(grid.to_cells(out) - (column, row))) == pytest.approx(distances.min())
    start = np.array(problem.scenario.start)
    assert problem.repaired(start, 1.0).tolist() == start.tolist()


def test_problems_of_maps_of_different_sizes_are_stacked_and_selected_again():
    problems = [walk_problem(3), walk_problem(4, shape=(30, 11))]
    tables = stack([problem.table for problem in problems])
    for index, problem in enumerate(problems):
        chosen = compiled(select)(tables, index)
        for name, value in problem.table._asdict().items():
            found = getattr(chosen, name)
            found = found[: problem.table.num_free] if name == "free" else found
            assert np.array_equal(found, value), name


def test_points_of_a_walk_go_on_straight_to_the_target():
    problem = walk_problem(0)
    assert problem.points([[1.0, 2.0], [3.0, 4.0]]).tolist() == [
        [[1.0, 2.0], list(problem.scenario.target)],
        [[3.0, 4.0], list(problem.scenario.target)],
    ]


def test_analytic_maps_are_walked_on_as_cells():
    problem = make_problem("case1", encoding="walk", cell_size=4.0)
    assert isinstance(problem.scenario, GridScenario)
    assert problem.scenario.map.blocked.shape == (150, 250)
    assert make_problem("case1", encoding="walk").scenario.map.resolution == 2.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"scenario": "case1", "encoding": "bezier"},
            "encoding 'bezier' needs grid maps, but scenario 'case1' is one of the analytic maps",
        ),
        ({"scenario": "function:booth-2", "encoding": "walk"}, "'encoding' has no effect on test functions"),
        ({"scenario": "case1", "cell_size": 3.0}, "'cell_size' has no effect with encoding 'waypoints'"),
        (
            {"scenario": "block:50", "encoding": "walk", "cell_size": 1.0},
            "'cell_size' has no effect on grid maps",
        ),
        (
            {"scenario": "block:50", "encoding": "walk", "num_waypoints": 5},
            "'num_waypoints' has no effect with encoding 'walk'",
        ),
        ({"scenario": "case1", "encoding": "walk", "cell_size": 0.0}, "cell_size must lie in"),
        ({"scenario": "case1", "encoding": "walk", "penalty": -1.0}, "penalty must lie in"),
    ],
)
def test_options_that_say_nothing_about_walks_are_refused(options, message):
    with pytest.raises(SettingError, match=message):
        make_problem(**options)


def test_an_unknown_encoding_is_refused():
    with pytest.raises(
        UnknownNameError,
        match="unknown encoding 'spline'; valid: bezier, ones, shifted, spherical, walk, waypoints",
    ):
        make_problem("case1", encoding="spline")
