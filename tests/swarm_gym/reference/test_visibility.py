"""The exact planner among circles and polygons, compared with the whole visibility graph in Python."""

import math
import os
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.builders import random_scenario
from oracles import naive_visibility
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, Polygon, Scenario, grown

SEEDS = st.integers(0, 2**32 - 1)
WIDE = (-50.0, -50.0, 60.0, 60.0)


def length_of(planner, scenario):
    try:
        return planner(scenario)[0]
    except NoPathError:
        return math.inf


def lattice(seed, walled=False, away=0.0):
    """Squares, triangles and circles at whole coordinates: they touch, overlap, share edges and corners.

    So do the ends, unless they are a distance away.
    """
    rng = np.random.default_rng(seed)
    start, target = (-1.0 - away, 3.0), (12.0 + away, 5.0)
    obstacles = []
    for _ in range(rng.integers(3, 14)):
        (x, y), (width, height) = rng.integers(0, 10, 2).tolist(), rng.integers(1, 4, 2).tolist()
        made = (
            Circle(x, y, int(rng.integers(1, 3))),
            Polygon.rectangle(x, y, x + width, y + height),
            Polygon(((x, y), (x + width, y), (x, y + height))),
        )[rng.integers(3)]
        if not made.contains(start) and not made.contains(target):
            obstacles.append(made)
    if walled:  # around the start, with a gap that may be closed
        walls = [(-3, -2, 20, -1), (-3, -1, -2, 10), (-3, 10, 20, 11)]
        obstacles += [Polygon.rectangle(*wall) for wall in walls]
        obstacles += [Polygon.rectangle(5, y, 6, y + 1) for y in range(-1, 10) if rng.random() < 0.9]
    return Scenario("lattice", start, target, tuple(obstacles), WIDE)


def with_slabs(scenario, seed):
    """Return a scenario with thin slabs along some edges of its polygons."""
    rng = np.random.default_rng(seed)
    slabs = []
    for polygon in (o for o in scenario.obstacles if isinstance(o, Polygon)):
        for (x0, y0), (x1, y1) in polygon.edges():
            half = 10.0 ** rng.integers(-9, -3) / math.dist((x0, y0), (x1, y1))
            out_x, out_y = half * (y1 - y0), half * (x0 - x1)
            if rng.random() < 0.5:
                corners = ((x0, y0, 1), (x1, y1, 1), (x1, y1, -1), (x0, y0, -1))
                slabs.append(Polygon(tuple((x + s * out_x, y + s * out_y) for x, y, s in corners)))
    return Scenario("slabs", scenario.start, scenario.target, (*scenario.obstacles, *slabs), WIDE)


def moved(scenario, by=(0.0, 0.0), factor=1.0):
    def at(point):
        return point[0] * factor + by[0], point[1] * factor + by[1]

    obstacles = tuple(
        Circle(*at((o.x, o.y)), o.radius * factor)
        if isinstance(o, Circle)
        else Polygon(tuple(map(at, o.vertices)))
        for o in scenario.obstacles
    )
    low, high = at(scenario.workspace[:2]), at(scenario.workspace[2:])
    return Scenario("moved", at(scenario.start), at(scenario.target), obstacles, (*low, *high))


def assert_as_the_whole_graph(scenario):
    expected = length_of(naive_visibility.shortest_path, scenario)
    found = length_of(shortest_path, scenario)
    assert found == expected or found == pytest.approx(expected, rel=1e-9)


def assert_it_enters_nothing(scenario, depth=1e-9):
    length, points = shortest_path(scenario)
    path = shapely.LineString(points)
    assert length - 1e-9 <= path.length <= length * (1.0 + 1e-5)
    np.testing.assert_array_equal(points[[0, -1]], [scenario.start, scenario.target])
    for obstacle in scenario.obstacles:
        if isinstance(obstacle, Circle):
            assert path.distance(shapely.Point(obstacle.x, obstacle.y)) >= obstacle.radius - depth
        else:
            core = shapely.Polygon(obstacle.vertices).buffer(-depth, join_style="mitre")
            assert not path.intersects(core)


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, num_obstacles=st.integers(1, 16))
def test_among_random_obstacles_that_overlap_it_is_as_long_as_in_the_whole_graph(seed, num_obstacles):
    assert_as_the_whole_graph(random_scenario(np.random.default_rng(seed), num_obstacles))


@pytest.mark.parametrize("examples", [10, pytest.param(60, marks=pytest.mark.slow)])
def test_among_obstacles_that_touch_it_is_as_long_as_in_the_whole_graph(examples):
    @settings(max_examples=examples, deadline=None)
    @given(seed=SEEDS, walled=st.booleans())
    def check(seed, walled):
        assert_as_the_whole_graph(lattice(seed, walled))

    check()


@pytest.mark.parametrize("examples", [8, pytest.param(25, marks=pytest.mark.slow)])
def test_beside_thin_slabs_it_is_as_long_as_in_the_whole_graph(examples):
    @settings(max_examples=examples, deadline=None)
    @given(seed=SEEDS)
    def check(seed):
        assert_as_the_whole_graph(with_slabs(lattice(seed, away=1.0), seed))

    check()


@settings(max_examples=15, deadline=None)
@given(seed=SEEDS, margin=st.sampled_from([0.1, 0.25, 1.0 / 3.0, 0.5]))
def test_among_grown_obstacles_it_is_as_long_as_in_the_whole_graph(seed, margin):
    assert_as_the_whole_graph(grown(lattice(seed, away=2.0), margin))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 2000, 250))
def test_in_thousands_of_scenes_it_is_as_long_as_in_the_whole_graph(first):
    for seed in range(first, first + 250):
        assert_as_the_whole_graph(lattice(seed, seed % 2 == 0))
        assert_as_the_whole_graph(random_scenario(np.random.default_rng(seed), 1 + seed % 20))


PLACES = [
    ((388096.5, 3948996.25), 1.0),
    ((1e7, -1e7), 1.0),
    ((9.99e8, -9.99e8), 1.0),
    ((0.0, 0.0), 1e-3),
    ((0.0, 0.0), 1e6),
]


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, walled=st.booleans(), place=st.sampled_from(PLACES))
def test_the_length_is_the_same_anywhere_and_at_any_scale(seed, walled, place):
    here, (by, factor) = lattice(seed, walled), place
    expected, found = length_of(shortest_path, here), length_of(shortest_path, moved(here, by, factor))
    assert found == expected or found / factor == pytest.approx(expected, rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, by=st.sampled_from([(388096.5, 3948996.25), (1e7, -1e7), (9.99e8, 9.99e8)]))
def test_among_coordinates_that_are_rounded_the_length_moves_as_little_as_they(seed, by):
    here = random_scenario(np.random.default_rng(seed), 8)
    rounding = float(np.spacing(max(map(abs, by))))
    try:
        there = moved(here, by)
    except ScenarioError:  # a corner is straight, or an end inside, after rounding
        assume(False)
    lengths = [shortest_path(moved(here, factor=f))[0] / f for f in (1.0 - 1e-5, 1.0 + 1e-5)]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-9)
    assert shortest_path(there)[0] == pytest.approx(lengths[0], rel=1e-9, abs=500.0 * rounding)


def test_corners_that_rounding_puts_onto_each_other_count_once():
    """Coordinates around the start hold fewer digits than those near the origin."""
    tiny = 1e-20
    box = Polygon(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-tiny, 1.0), (-tiny, tiny)))
    dust = Polygon(((0.0, 0.0), (tiny, 0.0), (0.0, tiny)))
    made = Scenario("tiny", (-3.0, 0.5), (4.0, 0.5), (box, dust), WIDE)
    assert shortest_path(made)[0] == pytest.approx(2.0 * math.hypot(3.0, 0.5) + 1.0, rel=1e-12)


UTM = [
    [(388102.5, 3948991.25), (388104.5, 3948991.25), (388104.5, 3948997.25), (388102.5, 3948997.25)],
    [(388107.5, 3948995.85), (388110.5, 3948994.25), (388111.5, 3949002.25), (388108.5, 3949003.25)],
    [(388105.5, 3948988.25), (388106.9, 3948988.25), (388106.9, 3948993.85), (388105.5, 3948993.85)],
]


def test_the_shortest_path_between_houses_in_utm_coordinates_is_exact():
    houses = tuple(Polygon(tuple(house)) for house in UTM)
    ends = (388096.5, 3948996.25), (388116.5, 3948996.25)
    made = Scenario("utm", *ends, houses, (388e3, 3948e3, 389e3, 395e4))
    length, points = shortest_path(made)
    # Over the first house, below the second.
    corners = [ends[0], (388102.5, 3948997.25), (388104.5, 3948997.25), (388110.5, 3948994.25), ends[1]]
    assert length == pytest.approx(sum(math.dist(*pair) for pair in pairwise(corners)), rel=1e-12)
    assert length == pytest.approx(21.115521783, abs=1e-8)
    np.testing.assert_array_equal(points, corners)


def test_a_path_runs_along_a_row_of_houses_that_rounding_moved_against_each_other():
    """Facades in a line at an angle: no corner sticks out further than coordinates are rounded."""
    angle, far = 0.3, np.array([388096.5, 3948996.25])
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    def at(points):
        return tuple(map(tuple, (np.array(points) @ turn + far).tolist()))

    houses = [((x, -2.0), (x + 7.0, -2.0), (x + 7.0, 3.0), (x, 3.0)) for x in range(0, 70, 7)]
    start, target = at([(-5.0, -2.0), (75.0, -2.0)])
    obstacles = tuple(Polygon(at(house)) for house in houses)
    made = Scenario("row", start, target, obstacles, (388e3, 3948e3, 389e3, 395e4))
    assert shortest_path(made)[0] == pytest.approx(80.0, abs=1e-8)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, margin=st.sampled_from([0.0, 0.2, 0.45]))
def test_the_polyline_enters_nothing(seed, margin):
    made = lattice(seed, away=2.0 if margin else 0.0)
    assert_it_enters_nothing(made if margin == 0.0 else grown(made, margin))


@pytest.mark.parametrize(("gap", "least", "most"), [(1e-3, 0.9, 1.0), (1e-8, 0.01, 0.1), (0.0, 0.0, 1e-3)])
def test_the_polyline_bends_more_finely_where_a_neighbour_is_close(gap, least, most):
    """The path winds between two discs: points outside the one lie in the other if they are far apart."""
    circles = Circle(0.0, -3.0, 3.0), Circle(0.0, 3.0 + gap, 3.0)
    walls = Polygon.rectangle(-0.5, -9.0, 0.5, -3.0), Polygon.rectangle(-0.5, 3.0, 0.5, 9.0)
    made = Scenario("narrow", (-4.0, -1.1), (4.0, -0.86), circles + walls, (-9.0, -9.0, 9.0, 9.0))
    assert_it_enters_nothing(made, 1e-10)
    points = shortest_path(made)[1]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)[1:-1]
    assert least <= steps.min() / steps.max() <= most
    assert len(points) < 500


def test_a_narrow_passage_is_open_and_one_of_no_width_or_less_is_closed():
    def around(overlap):
        boxes = Polygon.rectangle(4.0, 0.0, 6.0, 30.0), Polygon.rectangle(4.0, -30.0, 6.0, overlap)
        return Scenario("gap", (0.0, 0.0), (10.0, 0.0), boxes, WIDE)

    for factor in (1e-3, 1.0, 1e6):
        assert shortest_path(moved(around(-1e-6), factor=factor))[0] / factor == pytest.approx(10.0)
        for overlap in (0.0, 1e-9):
            assert shortest_path(moved(around(overlap), factor=factor))[0] / factor > 60.0


@pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)
@pytest.mark.slow
def test_five_hundred_grown_polygons_are_a_town_with_ways_and_walls():
    rng, obstacles, ends = np.random.default_rng(0), [], ((0.0, 0.0), (100.0, 100.0))
    while len(obstacles) < 500:
        angles = (np.arange(6) + rng.uniform(0.0, 0.6, 6)) * math.tau / 6
        centre, size = rng.uniform(0.0, 100.0, 2), rng.uniform(1.0, 2.5)
        corners = centre + size * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        if min(math.dist(centre, end) for end in ends) > 5.0:
            obstacles.append(Polygon(tuple(map(tuple, corners.tolist()))))
    made = grown(Scenario("town", *ends, tuple(obstacles), (-9.0, -9.0, 109.0, 109.0)), 0.3)
    assert len(made.obstacles) == 3500
    assert shortest_path(made)[0] > made.straight_line  # compiled
    walled = Scenario("walled", *ends, (*made.obstacles, *ring(ends[1], 4.0)), made.workspace)
    with pytest.raises(NoPathError):
        shortest_path(walled)


def ring(centre, radius):
    x, y = centre
    around = [(x + radius * math.cos(k), y + radius * math.sin(k)) for k in range(7)]
    return tuple(Circle(*point, 0.55 * radius) for point in around)
