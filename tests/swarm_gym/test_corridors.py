"""Corridors: posts of obstacles, signatures of paths and their number."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from helpers.builders import random_grid_scenario, random_scenario
from helpers.grids import grid
from helpers.loops import looped
from helpers.refusals import refused
from helpers.shapes import shape
from oracles import naive_corridors
from swarm_gym.corridors import (
    MOST_GRID_POSTS,
    Corridors,
    KnownCorridors,
    Posts,
    count_corridors,
    grid_posts,
    obstacle_posts,
    posts_of,
    signatures,
)
from swarm_gym.errors import SettingError
from swarm_gym.problem import AnalyticProblem, FunctionProblem, GridProblem, WalkProblem
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Polygon, Scenario, make_scenario
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for

RAY = 1e5  # length of a ray that leaves every map


def axes_of(posts):
    return RotatedAxes((0.0, 0.0), *posts.forward.tolist())


def random_case(seed, num_paths=8, num_points=7, num_posts=9):
    """Return wild paths with the same ends, which cross themselves, and posts around a line at any angle."""
    rng = np.random.default_rng(seed)
    paths = rng.uniform(0.0, 100.0, (num_paths, num_points, 2))
    paths[:, 0], paths[:, -1] = paths[0, 0], paths[0, -1]
    line = paths[0, -1] - paths[0, 0]
    return paths, Posts(rng.uniform(0.0, 100.0, (num_posts, 2)), line / np.hypot(*line))


def straight_case(*obstacles):
    return Scenario("drawn", (0.0, 50.0), (100.0, 50.0), obstacles, (0.0, 0.0, 100.0, 100.0))


@looped("seed", range(20))
def test_signatures_and_their_number_are_those_of_the_oracle(seed):
    paths, posts = random_case(seed)
    paths = np.concatenate([paths, paths[:3]])
    expected = [naive_corridors.signature(path, posts.points, axes_of(posts)) for path in paths]
    np.testing.assert_array_equal(signatures(paths, posts), expected)
    assert count_corridors(paths, posts) == naive_corridors.count(paths, posts.points, axes_of(posts))


@looped("seed", range(20))
def test_signatures_differ_by_the_winding_number_of_the_closed_curve(seed):
    paths, posts = random_case(seed)
    found = signatures(paths, posts)
    for path, own in zip(paths[1:], found[1:], strict=True):
        closed = [*paths[0].tolist(), *path[-2:0:-1].tolist()]
        turns = [naive_corridors.winding_number(closed, post) for post in posts.points.tolist()]
        # The curve leads forward along the first path: it is clockwise if that one is on the left.
        np.testing.assert_array_equal(own - found[0], turns)


@looped("seed", range(20))
def test_signatures_are_odd_where_shapely_finds_an_odd_number_of_crossings(seed):
    paths, posts = random_case(seed)
    left = np.array([-posts.forward[1], posts.forward[0]])
    for path, found in zip(paths, signatures(paths, posts), strict=True):
        for post, number in zip(posts.points, found, strict=True):
            crossings = shapely.LineString(path).intersection(shapely.LineString([post, post + RAY * left]))
            count = 0 if crossings.is_empty else len(shapely.get_parts(crossings))
            assert count % 2 == abs(number) % 2


@looped("seed", range(10))
def test_paths_of_waypoints_differ_exactly_at_the_posts_between_them(seed):
    problem = AnalyticProblem(random_scenario(np.random.default_rng(seed)), 9)
    corridors = Corridors.of(problem)
    rng = np.random.default_rng(100 + seed)
    vectors = np.sort(rng.uniform(*problem.bounds, (2, 9)), axis=0)
    right, left = problem.points(vectors)
    between = shapely.Polygon([*right, *left[-2:0:-1]])
    inside = [between.contains(shapely.Point(post)) for post in corridors.posts.points]
    found = corridors.signatures(vectors)
    np.testing.assert_array_equal(found[1] - found[0], inside)
    assert corridors.count(vectors) == 1 + any(inside)


def test_a_signature_is_1_on_the_left_0_on_the_right_and_counts_loops():
    posts = Posts(np.array([[5.0, 0.0]]), np.array([1.0, 0.0]))
    left = [[0, 0], [5, 2], [10, 0]]
    right = [[0, 0], [5, -2], [10, 0]]
    loop = [[0, 0], [7, 2], [7, -2], [3, -2], [3, 2], [7, 3], [10, 0]]  # once around, clockwise
    back = [[0, 0], [4, -2], [7, -2], [7, 3], [3, 3], [3, -3], [10, 0]]  # once around, the other way
    for path, expected in ((left, 1), (right, 0), (loop, 2), (back, -1)):
        assert signatures([path], posts).tolist() == [[expected]]


def test_hand_made_populations_are_counted():
    posts = posts_of(AnalyticProblem(straight_case(Circle(30, 50, 5), Circle(70, 50, 5))))
    above, below = [(30, 60), (70, 60)], [(30, 40), (70, 40)]
    slalom, wider = [(30, 60), (70, 40)], [(30, 90), (70, 80)]
    paths = np.array([[(0, 50), *middle, (100, 50)] for middle in (above, below, wider, slalom, below)])
    assert signatures(paths, posts).tolist() == [[1, 1], [0, 0], [1, 1], [1, 0], [0, 0]]
    for members, expected in (((0,), 1), ((0, 2), 1), ((0, 1), 2), ((0, 1, 2, 3, 4), 3), ((), 0)):
        assert count_corridors(paths[list(members)].reshape(-1, 4, 2), posts) == expected


def test_without_obstacles_there_is_one_corridor():
    problem = AnalyticProblem(straight_case(), 5)
    assert posts_of(problem).points.shape == (0, 2)
    vectors = np.random.default_rng(0).uniform(-40, 40, (6, 5))
    assert Corridors.of(problem).signatures(vectors).shape == (6, 0)
    assert Corridors.of(problem).count(vectors) == 1


TRIANGLE = Polygon(((0.0, 0.0), (4.0, 0.0), (2.0, 3.0)))


@pytest.mark.parametrize(
    ("one", "other", "merged"),
    [
        (Circle(0, 0, 2), Circle(3, 4, 3), True),  # they touch
        (Circle(0, 0, 2), Circle(3, 4, 2.99), False),
        (Circle(0, 0, 9), Circle(1, 1, 1), True),  # one inside the other
        (TRIANGLE, Circle(2, 1, 0.1), True),
        (Circle(2, 1, 0.1), TRIANGLE, True),
        (TRIANGLE, Circle(2, 4, 1), True),
        (TRIANGLE, Circle(2, 4.001, 1), False),
        (TRIANGLE, Circle(5, -1, 1.4), False),  # beside a corner, behind which no side separates them
        (TRIANGLE, Circle(5, -1, 1.42), True),
        (Polygon.rectangle(0, 4, 9, 5), Polygon.rectangle(4, 0, 5, 9), True),  # a cross: no corner inside
        (Polygon.rectangle(0, 0, 1, 1), Polygon.rectangle(1, 1, 2, 2), True),  # they share a corner
        (Polygon.rectangle(0, 0, 1, 1), Polygon.rectangle(1, 0.5, 2, 2), True),  # and part of a side
        (Polygon.rectangle(0, 0, 1, 1), Polygon.rectangle(1.001, 0, 2, 1), False),
        (Polygon.rectangle(0, 0, 9, 9), Polygon.rectangle(1, 1, 2, 2), True),
    ],
)
def test_obstacles_that_overlap_or_touch_have_one_post(one, other, merged):
    posts = obstacle_posts((one, other), 1e-8)
    assert len(posts) == (1 if merged else 2)
    assert one.contains(posts[0])
    assert merged or other.contains(posts[1])


def test_obstacles_are_merged_over_others():
    circles = tuple(Circle(x, 0, 0.6) for x in (0, 3, 1, 5, 2))  # 0-1-2-3 is a chain
    assert obstacle_posts(circles, 1e-8) == ((0.0, 0.0), (5.0, 0.0))


@looped("seed", range(0, 30, 3))
def test_groups_of_obstacles_are_the_parts_of_their_union(seed):
    obstacles = random_scenario(np.random.default_rng(seed), 3 + seed).obstacles
    parts = shapely.get_parts(shapely.union_all([shape(obstacle, quad_segs=4000) for obstacle in obstacles]))
    posts = [shapely.Point(post) for post in obstacle_posts(obstacles, 1e-8)]
    assert [sum(part.contains(post) for post in posts) for part in parts] == [1] * len(parts)
    assert len(posts) == len(parts)


DRAWN = (
    "#.........",
    "..##...#..",
    "..#...#..#",
    "....#.....",
    "...###....",
    "....#..#..",
    ".......###",
    "..........",
)


def test_obstacles_of_a_grid_are_components_off_the_border_the_largest_first():
    drawn = GridMap("drawn", grid(*DRAWN))
    # The component at the right border and the corner do not count; those that touch diagonally are one.
    assert grid_posts(drawn)[0] == (4.0, 4.0)
    assert len(grid_posts(drawn)) == 3
    assert grid_posts(drawn)[1] in ((2.0, 1.0), (3.0, 1.0), (2.0, 2.0))
    assert grid_posts(drawn)[2] in ((7.0, 1.0), (6.0, 2.0))
    scaled = GridMap("scaled", grid(*DRAWN), 0.5, (10.0, 20.0), y_up=True)
    assert grid_posts(scaled)[0] == (12.0, 18.0)


def test_grids_without_inner_obstacles_have_no_posts():
    for rows in (("...", "...", "..."), ("###", "###", "###"), ("#.#", "...", "..."), ("...",)):
        assert grid_posts(GridMap("drawn", grid(*rows))) == ()


def test_only_the_largest_components_of_a_grid_count():
    blocked = np.zeros((40, 40), dtype=np.bool_)
    blocked[1:39:2, 1:39:2] = True  # 361 single cells
    blocked[20, 20] = True  # connects four of them
    posts = grid_posts(GridMap("many", blocked))
    assert len(posts) == MOST_GRID_POSTS
    assert posts[0] == (20.0, 20.0) or blocked[int(posts[0][1]), int(posts[0][0])]
    assert len(set(posts)) == MOST_GRID_POSTS


@looped("seed", range(10))
def test_posts_of_random_grids_are_blocked_and_separate(seed):
    scenario = random_grid_scenario(seed, rock=0.25, resolution=0.5, origin=(3.0, -2.0), y_up=seed % 2 == 0)
    cells = [scenario.map.cell_of(post) for post in grid_posts(scenario.map)]
    rows, columns = np.nonzero(scenario.map.blocked)
    # Boxes that are slightly too large join at corners, too.
    area = shapely.union_all(shapely.box(columns - 0.51, rows - 0.51, columns + 0.51, rows + 0.51))
    inner = shapely.box(0.45, 0.45, scenario.map.width - 1.45, scenario.map.height - 1.45)
    parts = [part for part in shapely.get_parts(area) if inner.contains(part)]
    assert all(scenario.map.blocked[row, column] for column, row in cells)
    assert [sum(part.contains(shapely.Point(cell)) for cell in cells) for part in parts] == [1] * len(parts)
    assert len(cells) == len(parts)


@pytest.mark.parametrize("scenario", ["rooms:0", "caves:0"])
def test_curves_are_classified_by_a_few_samples(scenario):
    problem = problems_for(Settings(scenario=scenario, encoding="bezier"))[0]
    corridors = Corridors.of(problem)
    vectors = np.random.default_rng(3).uniform(*problem.initial_bounds, (60, problem.dimension))
    few, all_samples = corridors.points(vectors), problem.points(vectors)
    assert few.shape == (60, 64, 2)
    np.testing.assert_array_equal(few, all_samples[:, [*range(0, 999, 16), 999]])
    same = corridors.signatures(vectors) == signatures(all_samples, corridors.posts)
    assert same.mean() > 0.99


def test_waypoints_of_a_grid_are_classified_as_they_are():
    scenario = GridScenario("drawn", GridMap("drawn", grid(*DRAWN)), (0.0, 4.0), (9.0, 4.0))
    corridors = Corridors.of(GridProblem(scenario, "waypoints", 8))
    left, right = np.full(8, 3.0), np.full(8, -3.0)  # y grows downwards: left is below in the drawing
    post = corridors.posts.points.tolist().index([4.0, 4.0])
    assert corridors.signatures(np.stack([left, right]))[:, post].tolist() == [1, 0]
    assert corridors.count(np.stack([left, right, left])) == 2


def test_known_corridors_are_kept_until_the_problem_is_another():
    known, problem = KnownCorridors(), AnalyticProblem(make_scenario("case1"))
    first = known.of(0, problem)
    assert known.of(0, problem) is first
    other = replace(problem, scenario=straight_case(Circle(50, 50, 9)))
    assert known.of(0, other).posts.points.tolist() == [[50.0, 50.0]]
    assert known.of(1, problem) is not first


@pytest.mark.parametrize(
    "problem",
    [FunctionProblem(make_scenario("function:rastrigin-2")), WalkProblem(random_grid_scenario(0))],
    ids=["function", "walk"],
)
def test_problems_without_whole_paths_have_no_posts(problem):
    refused(lambda: posts_of(problem), type(problem).__name__, problem.scenario.name, error=SettingError)
