"""Obstacles as cells, compared with shapely."""

import math

import numpy as np
import pytest
import shapely

from helpers.builders import random_circle, random_polygon, random_scenario
from swarm_gym.errors import ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, GridMap, Polygon, Scenario, make_scenario, rasterised
from swarm_gym.scenarios.raster import cells_of


def empty_map(resolution=1.0, origin=(0.0, 0.0), y_up=False, shape=(14, 17)):
    return GridMap("empty", np.zeros(shape, np.bool_), resolution, origin, y_up)


def square(grid, column, row):
    x, y = grid.to_map((column, row)).tolist()
    half = grid.resolution / 2.0
    return shapely.box(x - half, y - half, x + half, y + half)


def depth(obstacle, shape):
    """Return how far a shape reaches into an obstacle; it is negative if they are apart."""
    if isinstance(obstacle, Circle):
        return obstacle.radius - shapely.Point(obstacle.x, obstacle.y).distance(shape)
    polygon = shapely.Polygon(obstacle.vertices)
    return -polygon.distance(shape) or polygon.intersection(shape).area


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("make", [random_circle, random_polygon])
@pytest.mark.parametrize("geometry", [{}, {"resolution": 0.7, "origin": (-3.0, 4.0), "y_up": True}])
def test_covered_are_the_cells_that_an_obstacle_reaches_into(make, seed, geometry):
    grid, rng = empty_map(**geometry), np.random.default_rng(seed)
    x_min, y_min, x_max, y_max = grid.extent
    obstacle = make(rng, np.array([rng.uniform(x_min, x_max), rng.uniform(y_min, y_max)]), rng.uniform(1, 6))
    covered = cells_of(obstacle, grid)
    for (row, column), given in np.ndenumerate(covered):
        deep = depth(obstacle, square(grid, column, row))
        # Rounding may decide either way on a cell that is hardly touched.
        assert deep > -1e-9 if given else deep < 1e-9


def test_an_obstacle_along_grid_lines_covers_no_cell_beside_it():
    grid = empty_map()
    covered = cells_of(Polygon.rectangle(2.5, 3.5, 5.5, 4.5), grid)
    assert np.argwhere(covered).tolist() == [[4, 3], [4, 4], [4, 5]]


def test_a_circle_that_touches_a_corner_of_a_cell_does_not_cover_it():
    covered = cells_of(Circle(4.0, 4.0, math.hypot(0.5, 0.5)), empty_map())
    assert covered.sum() == 5
    assert not covered[3, 3]


@pytest.mark.parametrize("cell_size", [1.0, 2.0, 7.3])
@pytest.mark.parametrize("case", ["case1", "case2", "case3"])
def test_a_free_path_over_cells_enters_no_obstacle(case, cell_size):
    scenario = make_scenario(case)
    cells = rasterised(scenario, cell_size)
    assert (cells.name, cells.start, cells.target) == (case, scenario.start, scenario.target)
    length, points = shortest_path(cells)
    path = shapely.LineString(points)
    for obstacle in scenario.obstacles:
        if isinstance(obstacle, Circle):
            assert depth(obstacle, path) < 1e-9
        else:
            assert not shapely.Polygon(obstacle.vertices).buffer(-1e-6).intersects(path)
    # Cells make passages narrower, but small cells only a little.
    optimum = shortest_path(scenario)[0]
    assert optimum - 1e-6 < length < optimum * (1.01 if cell_size < 3.0 else 1.2)


@pytest.mark.parametrize("seed", range(5))
def test_cells_cover_the_workspace(seed):
    scenario = random_scenario(np.random.default_rng(seed), 3)
    grid = rasterised(scenario, 30.0).map
    x_min, y_min, x_max, y_max = scenario.workspace
    assert grid.extent[:2] == (x_min, y_min)
    assert x_max <= grid.extent[2] < x_max + 30.0
    assert y_max <= grid.extent[3] < y_max + 30.0


def test_too_many_cells_are_refused():
    with pytest.raises(ScenarioError, match=r"cells of 0\.1 make a map of 10000 x 6000"):
        rasterised(make_scenario("case1"), 0.1)


def test_a_start_in_a_blocked_cell_is_refused():
    wall = Polygon.rectangle(21.0, 0.0, 25.0, 600.0)
    scenario = Scenario("close", (20.0, 300.0), (980.0, 300.0), (wall,))
    with pytest.raises(ScenarioError, match=r"'close'.*start .* lies in cell .* which is not free"):
        rasterised(scenario, 10.0)


def test_the_scene_of_one_block_keeps_its_proportions():
    for side in (50, 100, 500, 2000):
        scene = make_scenario(f"block:{side}")
        assert scene.map.blocked.shape == (side, side)
        assert shortest_path(scene)[0] == pytest.approx(0.8625 * side, rel=0.02)


@pytest.mark.parametrize("name", ["block", "block:", "block:19", "block:4001", "block:50-60", "block:050"])
def test_other_names_of_blocks_are_refused(name):
    with pytest.raises(ScenarioError, match=r"expected block:<side>, a number of cells from 20 to 4000"):
        make_scenario(name)
