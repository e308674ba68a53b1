"""Obstacles as cells, compared with shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import random_circle, random_polygon, random_scenario
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
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


GEOMETRIES = [
    (1.0, (0, 0), False), (0.7, (-3.0, 4.0), True), (0.3, (-1.0, 5.0), False), (2.0, (-1.0, 5.0), True),
]  # fmt: skip
SHAPES = (random_circle, random_polygon)


@pytest.mark.parametrize(
    ("make", "resolution", "origin", "y_up"),
    slow_but(
        [(SHAPES[0], *GEOMETRIES[1]), (SHAPES[1], *GEOMETRIES[1]), (SHAPES[1], *GEOMETRIES[2])],
        [(make, *geometry) for geometry in GEOMETRIES for make in SHAPES],
    ),
)
@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_covered_are_the_cells_that_an_obstacle_reaches_into(make, resolution, origin, y_up, seed):
    grid, rng = empty_map(resolution, origin, y_up, (7, 9)), np.random.default_rng(seed)
    low, high = np.reshape(grid.extent, (2, 2))
    obstacle = make(rng, rng.uniform(low, high), rng.uniform(0.2, 6))
    covered = cells_of(obstacle, grid)
    for (row, column), is_covered in np.ndenumerate(covered):
        deep = depth(obstacle, square(grid, column, row))
        # A sliver may be deeper than the tolerance of kernels, though its area is small.
        assert (deep > 1e-9) <= is_covered <= (deep > 0.0), (row, column, deep)


@pytest.mark.parametrize("y_up", [False, True])
def test_a_rectangle_along_edges_of_cells_covers_those_inside_in_spite_of_rounding(y_up):
    grid = empty_map(0.05, (-1.3, 0.7), y_up, (40, 40))
    corners = grid.to_map([(3.5, 6.5), (11.5, 30.5)])
    expected = np.zeros((40, 40), dtype=np.bool_)
    expected[7:31, 4:12] = True
    rectangle = Polygon.rectangle(*corners.min(axis=0), *corners.max(axis=0))
    np.testing.assert_array_equal(cells_of(rectangle, grid), expected)


def test_a_circle_covers_the_cells_that_it_reaches_into_but_not_those_that_it_touches():
    assert np.argwhere(cells_of(Circle(3.0, 3.0, 1.5), empty_map())).tolist() == [
        [row, column] for row in (2, 3, 4) for column in (2, 3, 4)
    ]
    covered = cells_of(Circle(4.0, 4.0, math.hypot(0.5, 0.5)), empty_map())  # touches corners
    assert covered.sum() == 5
    assert not covered[3, 3]


@pytest.mark.parametrize("cell_size", slow_but([7.3], [1.0, 2.0, 7.3]))
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


@pytest.mark.parametrize(
    "end", [(0, 0), (5, 0), (10, 0), (10, 5), (10, 9), (10, 10), (0, 10), (0, 5), (5, 10)]
)
@pytest.mark.parametrize("cell_size", [1.0, 0.7])
def test_ends_may_lie_on_any_edge_of_the_workspace(end, cell_size):
    scenario = Scenario("box", (3.3, 4.4), end, (Circle(6.0, 6.0, 1.5),), (0.0, 0.0, 10.0, 10.0))
    grid = rasterised(scenario, cell_size)
    assert grid.target == end
    assert grid.map.is_free(grid.map.cell_of(end))
    beyond = grid.map.to_map(np.argwhere(~grid.map.blocked)[:, ::-1])
    outside = ((beyond < 0.0) | (beyond > 10.0 + cell_size)).any(axis=1)
    assert outside.sum() <= 2  # the cells of the end alone
    _, way = shortest_path(grid)
    assert np.allclose([way[0], way[-1]], [grid.start, grid.target])
    _, info = SwarmEnv("ant-colony", scenario=scenario, iterations=1, cell_size=cell_size).reset(seed=0)
    assert np.isfinite(info["best_fitness"])


def test_a_cell_beyond_an_edge_is_blocked_by_obstacles_that_reach_there():
    wall = Polygon(((9.2, 4.95), (12.0, 4.95), (12.0, 5.05), (9.2, 5.05)))
    scenario = Scenario("box", (10.0, 4.5), (10.0, 5.5), (wall,), (0.0, 0.0, 10.0, 10.0))
    with pytest.raises(ScenarioError, match="which is not free"):
        rasterised(scenario, 1.0)


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
