"""The clearing shifts and the table of pairs, against shapely and against plain loops."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import shapely

from helpers.builders import (
    CASES,
    make_problem,
    random_circle,
    random_path,
    random_polygon,
    random_scenario,
    turned,
)
from helpers.compiled import compiled
from helpers.loops import looped, named_case
from helpers.slow import slow_but
from oracles import naive
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.cost import clearing_shifts
from swarm_gym.problem.analytic.table import PRESENCE
from swarm_gym.scenarios import Circle, Polygon, Scenario, make_scenario

# Two waypoints: the middle one of three segments spans x in [0, 100], far above the line from start
# to target, so that obstacles may reach over its ends.
SPACING = 100.0
CLOSE = 1e-9


def middle_segment(obstacles):
    """The problem in which segments between (0, y) and (100, y) are the middle ones."""
    ends, workspace = ((-SPACING, 0.0), (2 * SPACING, 0.0)), (-1e4, -1e4, 1e4, 1e4)
    return AnalyticProblem(Scenario("middle", *ends, tuple(obstacles), workspace, (0.0, 1000.0)), 2)


def kernel_shifts(problem, y0, y1):
    """(up, down) of the pairs of the middle segment."""
    table = problem.table
    tiles = range(table.first_tile[0], table.first_tile[1])
    present = table.rows[table.first_row[tiles.start : tiles.stop] + PRESENCE, 1]
    length = math.hypot(SPACING, y1 - y0)
    return [
        compiled(clearing_shifts)(table, tile, 1, y0, y1 - y0, length)
        for tile in tiles
        if present[tile] > -math.inf
    ]


def kernel_shift(obstacle, y0, y1):
    """(up, down) of one obstacle; None where the table has no pair or there is no contact."""
    found = kernel_shifts(middle_segment([obstacle]), y0, y1)
    assert len(found) <= 1
    return found[0] if found and min(found[0]) > 0 else None


def segment(y0, y1, shift=0.0):
    return (0.0, y0 + shift), (SPACING, y1 + shift)


def depth(obstacle, ends):
    """Return the depth to which a segment meets the open obstacle; negative if it stays off it.

    For a polygon the depth is that of the part of the segment inside.
    """
    line = shapely.LineString(ends)
    if isinstance(obstacle, Circle):
        return obstacle.radius - shapely.Point(obstacle.x, obstacle.y).distance(line)
    polygon = shapely.Polygon(obstacle.vertices)
    if line.relate_pattern(polygon, "T********"):
        inside = line.intersection(polygon)
        return inside.interpolate(0.5, normalized=True).distance(polygon.exterior)
    return -line.distance(polygon)


def random_rectangle(rng, centre, size):
    """With two vertical edges."""
    half = rng.uniform(0.1, 1.0, 2) * size
    return Polygon.rectangle(*(centre - half).tolist(), *(centre + half).tolist())


def random_triangle(rng, centre, size):
    while True:
        corners = rng.uniform(-size, size, (3, 2)) + centre
        if shapely.Polygon(corners).area > 0.01 * size**2:
            return Polygon(tuple(map(tuple, corners.tolist())))


KINDS = {
    "circle": random_circle,
    "hull": random_polygon,
    "rectangle": random_rectangle,
    "triangle": random_triangle,
}


def random_meetings(kind, seed, num_obstacles, per_obstacle=8):
    """(obstacle, y0, y1, kernel shifts or None) of random segments near an obstacle."""
    rng = np.random.default_rng(seed)
    for _ in range(num_obstacles):
        size = rng.choice([2.0, 20.0, 150.0])
        centre = np.array([rng.uniform(-size, SPACING + size), rng.uniform(400.0, 600.0)])
        obstacle = KINDS[kind](rng, centre, size)
        problem = middle_segment([obstacle])
        for _ in range(per_obstacle):
            slope = rng.choice([0.0, 0.1, 1.0, 10.0]) * rng.normal()
            y_at_centre = centre[1] + 0.7 * size * rng.normal()
            y0 = y_at_centre - slope * min(max(centre[0], 0.0), SPACING)
            y1 = y0 + slope * SPACING
            found = kernel_shifts(problem, y0, y1)
            yield obstacle, y0, y1, found[0] if found and min(found[0]) > 0 else None


@pytest.mark.parametrize(
    ("seed", "num_obstacles"),
    slow_but([(0, 125)], [(0, 125), (1, 125), *((seed, 2000) for seed in range(100, 120))]),
)
@pytest.mark.parametrize("kind", KINDS)
def test_contact_and_clearing_shifts_are_those_of_shapely(kind, seed, num_obstacles):
    met = missed = doubtful = 0
    for obstacle, y0, y1, found in random_meetings(kind, seed, num_obstacles):
        clearly = depth(obstacle, segment(y0, y1))
        if abs(clearly) < CLOSE:
            doubtful += 1
            continue
        assert (found is not None) == (clearly > 0), (obstacle, y0, y1)
        if found is None:
            missed += 1
            continue
        met += 1
        for direction, shift in ((1, found[0]), (-1, found[1])):
            small = 1e-6 * (1 + shift)
            cleared = depth(obstacle, segment(y0, y1, direction * (shift + small)))
            assert cleared <= CLOSE, (obstacle, y0, y1, direction)
            if small < shift:
                short = depth(obstacle, segment(y0, y1, direction * (shift - small)))
                assert short > -CLOSE, (obstacle, y0, y1, direction)
    total = met + missed
    assert doubtful < 0.01 * total
    assert met > 0.2 * total
    assert missed > 0.1 * total


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_clearing_shifts_are_the_naive_ones(kind, seed):
    compared = 0
    for obstacle, y0, y1, found in random_meetings(kind, seed + 50, 80):
        expected = naive.shifts(obstacle, segment(y0, y1))
        if found is None or expected is None:
            # One rounding apart at most: a contact that is seen once only is no deeper.
            assert min(found or expected or (0.0,)) < CLOSE
        else:
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
            compared += 1
    assert compared > 100


@looped("seed", range(1))
@pytest.mark.parametrize("kind", KINDS)
def test_the_naive_shifts_are_the_largest_gap_over_the_segment(kind, seed):
    """The oracle of the other tests, against a search that knows no closed form."""

    def chord(obstacle, x):
        if isinstance(obstacle, Circle):
            half = math.sqrt(max(obstacle.radius**2 - (x - obstacle.x) ** 2, 0.0))
            return obstacle.y - half, obstacle.y + half
        column = shapely.LineString([(x, -2e3), (x, 2e3)])
        _, low, _, high = column.intersection(shapely.Polygon(obstacle.vertices)).bounds
        return low, high

    def largest(function, low, high):
        """The maximum of a concave function by ternary search."""
        for _ in range(45):
            third = (high - low) / 3
            if function(low + third) < function(high - third):
                low += third
            else:
                high -= third
        return function((low + high) / 2)

    compared = 0
    for obstacle, y0, y1, _ in random_meetings(kind, seed + 80, 15, per_obstacle=4):
        expected = naive.shifts(obstacle, segment(y0, y1))
        if expected is None:
            continue
        compared += 1
        if isinstance(obstacle, Circle):
            xs = obstacle.x - obstacle.radius, obstacle.x + obstacle.radius
        else:
            xs = [x for x, _ in obstacle.vertices]
        begin, end = max(0.0, min(xs)), min(SPACING, max(xs))
        slope = (y1 - y0) / SPACING
        up = largest(lambda x, o=obstacle: chord(o, x)[1] - (y0 + slope * x), begin, end)  # noqa: B023
        down = largest(lambda x, o=obstacle: (y0 + slope * x) - chord(o, x)[0], begin, end)  # noqa: B023
        # The chord of a circle has infinite slope at its ends, where the search is least sharp.
        assert (up, down) == pytest.approx(expected, rel=1e-5, abs=1e-4)
    assert compared > 8


SQUARE = Polygon.rectangle(20, 480, 80, 520)
DIAMOND = Polygon(((100, 400), (150, 500), (100, 600), (50, 500)))


@pytest.mark.parametrize(
    ("obstacle", "y0", "y1"),
    [
        pytest.param(Circle(50, 480, 20), 500, 500, id="tangent from above"),
        pytest.param(Circle(50, 520, 20), 500, 500, id="tangent from below"),
        pytest.param(Circle(120, 500, 20), 500, 500, id="right end on the circle"),
        pytest.param(Circle(-20, 500, 20), 500, 500, id="left end on the circle"),
        pytest.param(Circle(120, 500, 20), 400, 600, id="passes beside the circle"),
        pytest.param(SQUARE, 520, 520, id="along the top edge"),
        pytest.param(SQUARE, 480, 480, id="along the bottom edge"),
        pytest.param(SQUARE, 540, 515, id="through the upper right corner"),
        pytest.param(SQUARE, 485, 460, id="through the lower left corner"),
        pytest.param(Polygon.rectangle(100, 400, 130, 600), 500, 500, id="end on a left edge"),
        pytest.param(Polygon.rectangle(-30, 400, 0, 600), 500, 480, id="begins on a right edge"),
        pytest.param(Polygon.rectangle(100, 500, 130, 600), 500, 500, id="end on a corner"),
        pytest.param(Polygon(((20, 400), (80, 400), (50, 500))), 500, 500, id="apex below"),
        pytest.param(Polygon(((20, 600), (50, 500), (80, 600))), 500, 500, id="apex above"),
        pytest.param(Polygon(((100, 500), (150, 450), (150, 550))), 500, 500, id="end on an apex"),
    ],
)
def test_touching_is_no_contact(obstacle, y0, y1):
    assert depth(obstacle, segment(y0, y1)) <= 0
    assert kernel_shift(obstacle, y0, y1) is None


@pytest.mark.parametrize(
    ("obstacle", "y0", "y1", "up", "down"),
    [
        pytest.param(Circle(50, 480, 20), 500 - 1e-6, 500 - 1e-6, 1e-6, 40 - 1e-6, id="just below"),
        pytest.param(Circle(50, 500, 20), 500, 500, 20, 20, id="through the centre"),
        # The tangents of slope 3/4 are a vertical 20 / 0.8 off the centre.
        pytest.param(Circle(50, 500, 20), 462.5, 537.5, 25, 25, id="through the centre, sloped"),
        pytest.param(Circle(50, 500, 20), 537.5, 462.5, 25, 25, id="through the centre, falling"),
        # The circle spans more than the segment: the shift ends over one of its ends.
        pytest.param(Circle(50, 500, 130), 500, 500, 130, 130, id="fully inside a circle"),
        pytest.param(Circle(0, 500, 100), 440, 540, 160, 100 * math.sqrt(2) - 60, id="half inside"),
        pytest.param(Circle(100, 500, 30), 500, 500, 30, 30, id="end at the centre"),
        pytest.param(Circle(124, 500, 25), 500, 500, 7, 7, id="end just inside"),
        pytest.param(SQUARE, 510, 510, 10, 30, id="through a rectangle"),
        pytest.param(SQUARE, 450, 550, 50, 50, id="across a rectangle"),
        pytest.param(Polygon.rectangle(-50, 400, 150, 700), 450, 600, 250, 200, id="fully inside"),
        pytest.param(Polygon.rectangle(90, 400, 130, 700), 500, 500, 200, 100, id="end inside"),
        pytest.param(Polygon.rectangle(0, 400, 100, 700), 500, 500, 200, 100, id="same extent"),
        pytest.param(Polygon(((20, 400), (80, 400), (50, 500))), 490, 490, 10, 90, id="in an apex"),
        pytest.param(DIAMOND, 500, 500, 100, 100, id="diamond"),
    ],
)
def test_shifts_are_those_computed_by_hand(obstacle, y0, y1, up, down):
    assert kernel_shift(obstacle, y0, y1) == pytest.approx((up, down), rel=1e-12, abs=1e-9)


def test_an_obstacle_between_two_waypoint_lines_pairs_with_that_segment_only():
    def segments(obstacle):
        return [pair.segment for pair in middle_segment([obstacle]).pairs]

    wall = Polygon.rectangle(0, 400, 100, 600)
    assert segments(wall) == [1]
    assert segments(Circle(50, 500, 50)) == [1]
    wider = Polygon.rectangle(-0.001, 400, 100.001, 600)
    assert segments(wider) == [0, 1, 2]


def test_each_of_overlapping_obstacles_counts():
    disc, square = Circle(50, 500, 30), Polygon.rectangle(40, 450, 70, 530)
    offsets = [495.0, 510.0]
    parts = [middle_segment([o]).evaluate(offsets)[1] for o in (disc, square)]
    assert all(part > 1 for part in parts)
    assert middle_segment([disc, square]).evaluate(offsets)[1] == pytest.approx(sum(parts))
    assert middle_segment([disc, disc]).evaluate(offsets)[1] == pytest.approx(2 * parts[0])


@pytest.mark.parametrize("kind", KINDS)
def test_the_degree_of_collision_is_the_distance_to_the_cleared_parallel(kind):
    rng = np.random.default_rng(5)
    for _ in range(100):
        # Narrower than the segment, so that no other one can be in contact.
        obstacle = KINDS[kind](rng, np.array([50.0, 500.0]), 45.0)
        y0, y1 = rng.normal(500.0, 40.0, 2)
        collision = middle_segment([obstacle]).evaluate([y0, y1])[1]
        found = naive.shifts(obstacle, segment(y0, y1))
        if found is None:
            assert collision < CLOSE
            continue
        up, down = found
        # A long segment stands in for the parallel line.
        shift = up if up < down else -down
        slope = (y1 - y0) / SPACING
        parallel = shapely.LineString([(-1e5, y0 - 1e5 * slope + shift), (1e5, y0 + 1e5 * slope + shift)])
        assert collision == pytest.approx(shapely.Point(0, y0).distance(parallel), abs=1e-7)
        cosine = SPACING / math.hypot(SPACING, y1 - y0)
        assert collision == pytest.approx(min(up, down) * cosine, rel=1e-9)


# The table of pairs loses no contact, as test_problem.py shows for the cases.


@looped("num_waypoints", range(1, 121))
@pytest.mark.parametrize("case", slow_but(["case1"], CASES))
def test_the_pairs_of_a_case_are_those_of_exact_arithmetic(case, num_waypoints):
    # Many an edge stands on the line of a waypoint, exactly: no rounding may pair it with both sides.
    problem = make_problem(case, num_waypoints)
    spacing = Fraction(960, num_waypoints + 1)
    expected = []
    for j in range(num_waypoints + 1):
        overlaps = 0
        for obstacle in problem.scenario.obstacles:
            if isinstance(obstacle, Circle):
                xs = [int(obstacle.x - obstacle.radius), int(obstacle.x + obstacle.radius)]
            else:
                xs = [int(x) for x, _ in obstacle.vertices]
            overlaps += max(j * spacing, min(xs) - 20) < min((j + 1) * spacing, max(xs) - 20)
        expected.append(overlaps)
    found = np.bincount([pair.segment for pair in problem.pairs], minlength=num_waypoints + 1)
    assert found.tolist() == expected


@looped("seed", range(60))
def test_the_table_of_a_random_scenario_loses_no_contact(seed):
    assert_no_contact_lost(seed, 6)


@pytest.mark.slow
@pytest.mark.parametrize("first_seed", range(1000, 3000, 100))
def test_the_tables_of_2000_random_scenarios_lose_no_contact(first_seed):
    for seed in range(first_seed, first_seed + 100):
        with named_case(f"seed={seed}"):
            assert_no_contact_lost(seed, 20)


def assert_no_contact_lost(seed, num_paths):
    """Compare with the oracle, which loops over all segments and all obstacles."""
    rng = np.random.default_rng(seed)
    problem = AnalyticProblem(random_scenario(rng), int(rng.choice([1, 2, 5, 13, 31, 40])))
    deepest = 0.0
    for _ in range(num_paths):
        offsets = random_path(rng, problem)
        expected = naive.evaluate(problem.scenario, offsets, problem.length_weight)
        assert problem.evaluate(offsets) == pytest.approx(expected, rel=1e-9, abs=1e-9)
        deepest = max(deepest, expected[1])
    assert deepest > 1


# What must not change the fitness.


def assert_same_fitness(problem, other, rng, changed=lambda offsets: offsets):
    for _ in range(10):
        path = random_path(rng, problem)
        assert other.evaluate(changed(path)) == pytest.approx(problem.evaluate(path), rel=1e-9, abs=1e-7)


def scenario_of(source, rng):
    return random_scenario(rng) if source == "random" else make_scenario(source)


@looped("seed", range(10))
@pytest.mark.parametrize("source", [*CASES, "random"])
def test_turning_and_shifting_the_whole_map_changes_nothing(source, seed):
    rng = np.random.default_rng(seed)
    # 40 waypoints: in no case does an edge stand exactly on the line of one.
    problem = AnalyticProblem(scenario_of(source, rng), 40)
    moved = turned(problem.scenario, rng.uniform(0, math.tau), tuple(rng.uniform(-500, 500, 2)))
    assert_same_fitness(problem, AnalyticProblem(moved, 40), rng)


@pytest.mark.parametrize(
    ("case", "num_waypoints", "angles"),
    [
        *((case, 40, (math.pi / 2, math.pi, -math.pi / 2)) for case in CASES),  # rectangles stay upright
        # Edges are on the lines of waypoints.
        *((case, 31, np.linspace(0.1, 6.2, 20)) for case in ("case2", "case3")),
    ],
)
def test_turning_a_map_by_a_quarter_or_with_edges_on_waypoint_lines_changes_nothing(
    case, num_waypoints, angles
):
    problem = make_problem(case, num_waypoints)
    for angle in angles:
        other = AnalyticProblem(turned(problem.scenario, angle), num_waypoints)
        assert_same_fitness(problem, other, np.random.default_rng(0))


@looped("seed", range(10))
@pytest.mark.parametrize("source", [*CASES, "random"])
def test_going_back_from_target_to_start_costs_the_same(source, seed):
    rng = np.random.default_rng(seed)
    forth = scenario_of(source, rng)
    low, high = forth.initial_range
    back = replace(forth, start=forth.target, target=forth.start, initial_range=(-high, -low))
    # Left of the way back is right of the way there.
    problems = (AnalyticProblem(scenario, 23) for scenario in (forth, back))
    assert_same_fitness(*problems, rng, lambda offsets: -offsets[::-1])


@looped("seed", range(5))
@pytest.mark.parametrize("case", CASES)
def test_the_order_of_the_obstacles_does_not_change_the_fitness(case, seed):
    rng = np.random.default_rng(seed)
    problem = make_problem(case)
    obstacles = problem.scenario.obstacles
    shuffled = tuple(obstacles[k] for k in rng.permutation(len(obstacles)))
    assert_same_fitness(problem, AnalyticProblem(replace(problem.scenario, obstacles=shuffled)), rng)


def test_a_scenario_that_was_accepted_can_be_turned_into_its_frame():
    rng = np.random.default_rng(0)
    barely_convex = Polygon(((100, 100), (150, math.nextafter(100, 0)), (200, 100), (150, 150)))
    for _ in range(300):
        target = tuple(rng.uniform(500.0, 590.0, 2))
        scenario = Scenario("flat corner", (10.0, 10.0), target, (barely_convex,))
        assert AnalyticProblem(scenario).table.spacing > 0
