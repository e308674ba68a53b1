import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from helpers.builders import CASES, as_path, make_problem, problem_of, random_path
from helpers.compiled import compiled
from helpers.loops import looped, named_case
from helpers.refusals import refused
from helpers.slow import slow_but
from oracles import naive
from swarm_gym.errors import SettingError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.tables import evaluate_entry, repair_entry, select, stack
from swarm_gym.scenarios import Circle, Polygon, Scenario, make_scenario

NUMS = (1, 2, 5, 7, 31, 40, 51)
SCENARIOS = (*CASES, "random")


def one_obstacle(obstacle, num_waypoints=31, workspace=(0.0, 0.0, 1000.0, 600.0)):
    """The start, target and waypoints of the cases: a line every 30 units from x = 50."""
    scenario = Scenario("one", (20.0, 300.0), (980.0, 300.0), (obstacle,), workspace, (-180, 180))
    return AnalyticProblem(scenario, num_waypoints)


# Fitness.


@looped("length_weight", [0.1, 0.3, 1.0])
@looped("num_waypoints", NUMS)
@pytest.mark.parametrize("source", SCENARIOS)
def test_fitness_and_collision_are_the_naive_ones(source, num_waypoints, length_weight):
    rng = np.random.default_rng(num_waypoints)
    problem = problem_of(source, num_waypoints, 4, length_weight)
    deepest = 0.0
    for _ in range(15):
        offsets = random_path(rng, problem)
        expected = naive.evaluate(problem.scenario, offsets, length_weight)
        assert problem.evaluate(offsets) == pytest.approx(expected, rel=1e-10, abs=1e-9)
        deepest = max(deepest, expected[1])
    assert deepest > 10


def path_values(problem):
    """Offsets in the workspace; hypothesis prefers round numbers, ties and extremes."""
    lower, upper = problem.bounds
    low, high = float(lower.max()), float(upper.min())
    return arrays(np.float64, problem.num_waypoints, elements=st.floats(low, high))


CASE3, CASE2_FEW = make_problem("case3"), make_problem("case2", 5)


@pytest.mark.parametrize("problem", [CASE3, CASE2_FEW], ids=["case3", "case2 with few waypoints"])
@given(data=st.data())
@settings(deadline=None, derandomize=True, max_examples=80)
def test_fitness_of_awkward_paths_is_the_naive_one(problem, data):
    offsets = data.draw(path_values(problem))
    expected = naive.evaluate(problem.scenario, offsets, 0.3)
    assert problem.evaluate(offsets) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("num_waypoints", NUMS)
def test_the_straight_path_on_an_empty_map_costs_the_lower_bound(num_waypoints):
    scenario = Scenario("empty", (20.0, 300.0), (980.0, 300.0), ())
    problem = AnalyticProblem(scenario, num_waypoints)
    fitness, collision = problem.evaluate(np.zeros(num_waypoints))
    assert collision == 0
    assert fitness == pytest.approx(0.3 * 960, rel=1e-14)
    assert problem.lower_bound == 0.3 * 960
    assert problem.collision_bound == 0


def test_the_weight_of_the_length_weighs_length_against_collision():
    offsets = random_path(np.random.default_rng(0), make_problem("case1"))
    length, collision = make_problem("case1", length_weight=1.0).evaluate(offsets)
    assert collision > 10
    for weight in (0.1, 0.3, 0.9):
        fitness, same = make_problem("case1", length_weight=weight).evaluate(offsets)
        assert same == collision
        assert fitness == pytest.approx(weight * length + (1 - weight) * collision, rel=1e-14)


@looped("seed", range(20))
@pytest.mark.parametrize("source", SCENARIOS)
def test_no_path_in_the_workspace_is_below_or_above_the_bounds(source, seed):
    rng = np.random.default_rng(seed)
    problem = problem_of(source, int(rng.choice(NUMS)), seed)
    for _ in range(50):
        extreme = np.where(rng.random(problem.num_waypoints) < 0.5, *problem.bounds)
        for offsets in (random_path(rng, problem), extreme):
            fitness, collision = problem.evaluate(offsets)
            assert fitness >= problem.lower_bound
            assert 0 <= collision <= problem.collision_bound


def test_the_collision_bound_is_no_bound_for_everything():
    # A wall across the whole workspace: half its height is what the best of two ways out costs.
    problem = one_obstacle(Polygon.rectangle(500, 0, 530, 600))
    collision = problem.evaluate(np.zeros(31))[1]
    assert collision == pytest.approx(300)
    assert problem.collision_bound == pytest.approx(600)


# Repair.


def repaired_like_naive(problem, offsets, repair_degree):
    """Check a repair, which leaves its argument alone; return whether it changes anything."""
    expected, before = naive.repaired(problem.scenario, offsets, repair_degree), offsets.copy()
    actual = problem.repaired(offsets, repair_degree)
    assert offsets.tolist() == before.tolist() == problem.repaired(offsets, 0.0).tolist()
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-9)
    return not np.allclose(actual, offsets)


@looped("repair_degree", [0.25, 0.7, 1.0])
@looped("num_waypoints", NUMS)
@pytest.mark.parametrize("source", slow_but(["case3", "random"], SCENARIOS))
def test_a_repair_pass_is_the_naive_one(source, num_waypoints, repair_degree):
    rng = np.random.default_rng(num_waypoints)
    problem = problem_of(source, num_waypoints, 1)
    changes = [repaired_like_naive(problem, random_path(rng, problem), repair_degree) for _ in range(4)]
    assert any(changes)


@pytest.mark.slow
@pytest.mark.parametrize("first_seed", range(0, 500, 50))
def test_a_repair_pass_on_many_random_scenarios_is_the_naive_one(first_seed):
    for seed in range(first_seed, first_seed + 50):
        rng = np.random.default_rng(seed)
        problem = problem_of("random", int(rng.choice(NUMS)), seed)
        with named_case(f"seed={seed}"):
            for _ in range(10):
                repaired_like_naive(problem, random_path(rng, problem), rng.random())


@pytest.mark.parametrize("source", CASES)
def test_repair_leaves_a_feasible_path_alone(source):
    problem = make_problem(source)
    above_everything = np.full(31, 250.0)
    assert problem.evaluate(above_everything)[1] == 0
    assert problem.repaired(above_everything, 1.0).tolist() == above_everything.tolist()


@pytest.mark.parametrize("source", SCENARIOS)
def test_start_and_target_never_move(source):
    rng = np.random.default_rng(0)
    problem = problem_of(source, 2, 3)
    for _ in range(20):
        path = as_path(random_path(rng, problem))
        repair_entry(problem.table, path, 1.0)
        assert path[0] == 0.0
        assert (path[3:] == 0.0).all()


# An obstacle between two waypoint lines, off the ends of its segment by more than nothing.
NARROW = {
    "circle": Circle(515, 310, 13),
    "rectangle": Polygon.rectangle(502, 270, 526, 320),
    "diamond": Polygon(((501, 300), (515, 250), (529, 300), (515, 350))),
}


@looped("repair_degree", [0.1, 0.5, 0.9, 1.0])
@looped("seed", range(10))
@pytest.mark.parametrize("shape", NARROW)
def test_repair_takes_its_degree_off_a_single_contact(shape, seed, repair_degree):
    rng = np.random.default_rng(seed)
    problem = one_obstacle(NARROW[shape])
    offsets = rng.uniform(-3.0, 12.0, 31)
    before = problem.evaluate(offsets)[1]
    assert before > 0
    repaired = problem.repaired(offsets, repair_degree)
    assert problem.evaluate(repaired)[1] == pytest.approx((1 - repair_degree) * before, abs=1e-9)
    # Both ends of segment 16, from x = 500 to 530, move by the same; no other waypoint does.
    moved = repaired - offsets
    assert np.flatnonzero(moved).tolist() == [15, 16]
    assert moved[15] == pytest.approx(moved[16], rel=1e-9)


def test_repair_goes_to_the_nearer_side_and_up_where_both_are_equal():
    def first_move(obstacle):
        return one_obstacle(obstacle).repaired(np.zeros(31), 1.0)[15]

    assert first_move(Polygon.rectangle(502, 290, 526, 304)) == 4
    assert first_move(Polygon.rectangle(502, 297, 526, 310)) == -3
    assert first_move(Polygon.rectangle(502, 290, 526, 310)) == 10


def test_a_segment_at_the_start_moves_its_free_end_only():
    problem = one_obstacle(Polygon.rectangle(30, 290, 45, 302))
    assert problem.repaired(np.zeros(31), 1.0).tolist() == [2.0] + 30 * [0.0]
    problem = one_obstacle(Polygon.rectangle(955, 298, 970, 310))
    assert problem.repaired(np.zeros(31), 1.0).tolist() == 30 * [0.0] + [-2.0]


def test_each_repair_sees_what_the_ones_before_did():
    # Moved up by 4 out of the first, the segment meets the second, and goes down again.
    obstacles = (Polygon.rectangle(502, 280, 512, 304), Polygon.rectangle(514, 301, 526, 330))
    for order, expected in ((obstacles, 1), (obstacles[::-1], 4)):
        scenario = Scenario("two", (20.0, 300.0), (980.0, 300.0), order, initial_range=(-9, 9))
        assert AnalyticProblem(scenario).repaired(np.zeros(31), 1.0)[15] == expected


@looped("repair_degree", [0.5, 1.0])
@looped("seed", range(5))
@pytest.mark.parametrize("source", SCENARIOS)
def test_repair_stays_in_the_workspace(source, seed, repair_degree):
    rng = np.random.default_rng(seed)
    problem = problem_of(source, 31, seed)
    lower, upper = problem.bounds
    for _ in range(20):
        repaired = problem.repaired(rng.uniform(lower, upper), repair_degree)
        assert (repaired >= lower).all()
        assert (repaired <= upper).all()


def test_repair_ends_at_the_border_of_the_workspace():
    low, high = Polygon.rectangle(502, -40, 526, 60), Polygon.rectangle(502, 540, 526, 640)
    for obstacle, inside, border in ((low, -260.0, -300.0), (high, 260.0, 300.0)):
        offsets = np.full(31, inside)
        repaired = one_obstacle(obstacle).repaired(offsets, 1.0)
        # The nearer way out is 20 off on the free side.
        assert repaired[15] == math.copysign(240.0, inside)
        beyond = np.full(31, border)
        beyond[15:17] *= 0.99
        assert one_obstacle(obstacle).repaired(beyond, 1.0)[15] == border


# Points.


@looped("num_waypoints", NUMS)
@pytest.mark.parametrize("source", SCENARIOS)
def test_points_run_from_start_to_target_and_tell_offsets_and_length(source, num_waypoints):
    problem = problem_of(source, num_waypoints, 5, length_weight=1.0)
    offsets = random_path(np.random.default_rng(1), problem)
    points = problem.points(offsets)
    assert points.shape == (num_waypoints + 2, 2)
    (sx, sy), (tx, ty) = problem.scenario.start, problem.scenario.target
    np.testing.assert_allclose(points[0], (sx, sy), rtol=1e-14)
    np.testing.assert_allclose(points[-1], (tx, ty), rtol=1e-13)
    np.testing.assert_allclose(points, naive.map_points(problem.scenario, offsets), atol=1e-9)
    x, y = points[1:-1].T
    left = ((tx - sx) * (y - sy) - (ty - sy) * (x - sx)) / math.hypot(tx - sx, ty - sy)
    np.testing.assert_allclose(left, offsets, atol=1e-9)
    length = problem.evaluate(offsets)[0]
    assert length == pytest.approx(np.hypot(*np.diff(points, axis=0).T).sum(), rel=1e-12)


def test_points_of_a_whole_population_are_those_of_each_member():
    problem = problem_of("random", 5, 8)
    population = np.random.default_rng(0).normal(size=(2, 3, 5))
    points = problem.points(population)
    assert points.shape == (2, 3, 7, 2)
    for index in np.ndindex(2, 3):
        np.testing.assert_array_equal(points[index], problem.points(population[index]))


# Bounds.


@looped("seed", range(20))
def test_the_bounds_are_where_the_waypoint_lines_leave_the_workspace(seed):
    problem = problem_of("random", 7, seed)
    (lower, upper), (initial_lower, initial_upper) = problem.bounds, problem.initial_bounds
    np.testing.assert_allclose([lower, upper], naive.bounds(problem.scenario, 7), atol=1e-9)
    assert (lower <= initial_lower).all()
    assert (initial_lower < initial_upper).all()
    assert (initial_upper <= upper).all()


def test_the_cases_are_bounded_by_the_workspace_and_begin_in_their_initial_range():
    problem = make_problem("case1")
    assert problem.table.spacing == 30
    assert list(map(set, problem.bounds)) == [{-300}, {300}]
    assert list(map(set, problem.initial_bounds)) == [{-180}, {180}]


@pytest.mark.parametrize(
    ("y", "obstacles", "span"),
    [
        (300.0, (Circle(300, 250, 70), Polygon.rectangle(500, 310, 520, 415)), (-120, 115)),
        (200.0, (), (-200, 400)),  # the workspace where there is no obstacle
    ],
)
def test_the_first_population_spans_the_obstacles_where_no_range_is_given(y, obstacles, span):
    problem = AnalyticProblem(Scenario("free", (20.0, y), (980.0, y), obstacles))
    assert list(map(set, problem.initial_bounds)) == [{span[0]}, {span[1]}]


def test_an_initial_range_outside_the_workspace_is_refused():
    scenario = Scenario("off", (20.0, 300.0), (980.0, 300.0), (), initial_range=(400.0, 500.0))
    refused(lambda: AnalyticProblem(scenario).table, "'off'", "initial range (400.0, 500.0)")


def test_a_scenario_needs_no_initial_range_for_a_diagonal_across_the_workspace():
    scenario = Scenario("diagonal", (10.0, 10.0), (990.0, 590.0), (Circle(300, 400, 50),))
    initial_lower, initial_upper = AnalyticProblem(scenario).initial_bounds
    assert (initial_lower < initial_upper).all()


# Stacked tables.


@pytest.mark.parametrize("num_waypoints", [1, 5, 31])
def test_a_problem_out_of_a_stack_is_the_problem_itself(num_waypoints):
    rng = np.random.default_rng(0)
    empty = AnalyticProblem(Scenario("empty", (20.0, 300.0), (900.0, 300.0), ()), num_waypoints)
    problems = [
        empty,
        *(
            make_problem(case, num_waypoints, weight)
            for case, weight in zip(CASES, (0.1, 0.3, 0.5), strict=True)
        ),
        *(problem_of("random", num_waypoints, seed) for seed in range(5)),
        empty,
    ]
    stacked = stack([problem.table for problem in problems])
    assert len({len(problem.table.rows) for problem in problems}) > 3
    for index, problem in enumerate(problems):
        table = compiled(select)(stacked, index)
        for _ in range(10):
            offsets = random_path(rng, problem)
            path = as_path(offsets)
            assert evaluate_entry(table, path) == problem.evaluate(offsets)
            repair_entry(table, path, 0.6)
            assert path[1 : num_waypoints + 1].tolist() == problem.repaired(offsets, 0.6).tolist()


def test_a_stack_keeps_fractions_behind_a_whole_number():
    tables = [make_problem("case1", 5, weight).table for weight in (1, 0.3)]
    assert stack(tables).length_weight.tolist() == [1.0, 0.3]


# Refusals.


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("num_waypoints", value) for value in (0, -3, math.nan, 2.5, "3")),
        *(("length_weight", value) for value in (0.0, -0.1, 1.0000001, math.nan, math.inf, "0.3")),
    ],
)
def test_a_setting_that_cannot_be_is_refused_by_name_and_value(name, value):
    make = partial(AnalyticProblem, make_scenario("case1"), **{name: value})
    refused(make, name, repr(value), error=SettingError)
    assert getattr(AnalyticProblem(make_scenario("case1"), **{name: 1}), name) == 1


@pytest.mark.parametrize("shape", [(), (0,), (30,), (32,), (33,), (1, 31), (31, 1)])
@pytest.mark.parametrize("call", [AnalyticProblem.evaluate, lambda problem, o: problem.repaired(o, 0.5)])
def test_offsets_of_another_shape_are_refused(call, shape):
    wrong = partial(call, make_problem("case1"), np.zeros(shape))
    refused(wrong, "expected 31 components", str(shape), error=ValueError)


@pytest.mark.parametrize("shape", [(30,), (4, 33)])
def test_points_of_offsets_of_another_shape_are_refused(shape):
    with pytest.raises(ValueError, match=str(shape[-1])):
        make_problem("case1").points(np.zeros(shape))


def test_offsets_may_be_a_list_or_of_another_number_type():
    problem = make_problem("case1", 3)
    expected = problem.evaluate(np.array([10.0, -20.0, 30.0]))
    assert problem.evaluate([10, -20, 30]) == expected
    assert problem.evaluate(np.array([10, -20, 30], dtype=np.float32)) == expected
    assert problem.evaluate(np.array([10, 0, -20, 0, 30, 0])[::2]) == expected


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_offsets_that_are_not_finite_are_refused(value):
    with pytest.raises(ValueError, match="finite"):
        make_problem("case1", 5).evaluate([0.0, value, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("degree", [-0.1, 1.1, math.nan, "half"])
def test_a_repair_degree_out_of_range_is_refused(degree):
    with pytest.raises(SettingError, match="repair_degree"):
        make_problem("case1", 5).repaired(np.zeros(5), degree)
