import itertools
import json
import math
import subprocess
import sys

import numpy as np
import pytest
import scipy.sparse.csgraph
import shapely
from builders import CASES, make_problem, random_scenario, turned
from hypothesis import given, settings
from hypothesis import strategies as st

from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError
from swarm_gym.problem import Problem
from swarm_gym.problem.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import known_optimum, optimum, shortest_path
from swarm_gym.reference.optima import digest
from swarm_gym.reference.visibility import SAMPLING_ANGLE
from swarm_gym.reference.waypoint_optimum import best_path, write_optima
from swarm_gym.scenarios import SCENARIOS, Circle, Polygon, Scenario, make_scenario

SEEDS = st.integers(0, 2**32 - 1)
ANGLES = st.floats(-math.pi, math.pi)


def scenario(*obstacles, length=10.0):
    return Scenario("made", (0.0, 0.0), (length, 0.0), obstacles, (-20.0, -20.0, 30.0, 20.0))


def polyline_length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def sag(radius):
    """How far the polyline of an arc lies inside the circle at most."""
    return radius * (1.0 - math.cos(SAMPLING_ANGLE / 2.0))


# Shortest paths in closed form.


def test_without_obstacles_the_shortest_path_is_the_straight_line():
    length, points = shortest_path(scenario())
    assert length == 10.0
    assert points.tolist() == [[0.0, 0.0], [10.0, 0.0]]


@pytest.mark.parametrize("radius", [1e-3, 0.5, 2.0, 4.999])
def test_around_a_circle_it_is_tangent_arc_tangent(radius):
    length, points = shortest_path(scenario(Circle(5.0, 0.0, radius)))
    expected = 2.0 * math.sqrt(25.0 - radius**2) + 2.0 * radius * math.asin(radius / 5.0)
    assert length == pytest.approx(expected, rel=1e-12)
    assert polyline_length(points) == pytest.approx(length, rel=2e-5)
    assert points[0].tolist() == [0.0, 0.0]
    assert points[-1].tolist() == [10.0, 0.0]


def test_from_a_start_on_a_circle_it_begins_with_an_arc():
    length, _ = shortest_path(scenario(Circle(1.0, 0.0, 1.0)))
    expected = math.sqrt(81.0 - 1.0) + math.pi - math.acos(1.0 / 9.0)
    assert length == pytest.approx(expected, rel=1e-12)


def test_around_a_rectangle_it_passes_the_corners_of_the_near_side():
    length, points = shortest_path(scenario(Polygon.rectangle(4.0, -1.0, 7.0, 2.0)))
    assert length == pytest.approx(math.sqrt(17.0) + 3.0 + math.sqrt(10.0), rel=1e-12)
    assert points.tolist() == [[0.0, 0.0], [4.0, -1.0], [7.0, -1.0], [10.0, 0.0]]


def test_between_two_circles_it_changes_sides_along_the_inner_tangent():
    circles = Circle(3.0, -0.5, 1.5), Circle(9.0, 0.5, 1.5)
    length, points = shortest_path(scenario(*circles, length=12.0))
    # Symmetric about (6, 0): twice the way from the start over the first circle to there.
    distance = math.hypot(3.0, 0.5)
    arc = math.pi - 2.0 * math.atan2(0.5, 3.0) - 2.0 * math.acos(1.5 / distance)
    expected = 2.0 * (2.0 * math.sqrt(distance**2 - 1.5**2) + 1.5 * arc)
    assert length == pytest.approx(expected, rel=1e-12)
    assert points[:, 1].max() == pytest.approx(1.0, abs=sag(1.5))
    assert points[:, 1].min() == pytest.approx(-1.0, abs=sag(1.5))


def test_over_overlapping_circles_it_follows_the_outer_tangent():
    length, _ = shortest_path(scenario(Circle(4.0, 0.0, 1.5), Circle(6.0, 0.0, 1.5)))
    expected = 2.0 * (math.sqrt(16.0 - 1.5**2) + 1.5 * math.asin(1.5 / 4.0)) + 2.0
    assert length == pytest.approx(expected, rel=1e-12)


def test_an_arc_inside_another_obstacle_is_not_used():
    circle = Circle(5.0, 0.0, 1.0)
    free, _ = shortest_path(scenario(circle))
    fin_above = Polygon.rectangle(4.5, 0.0, 5.5, 3.0)
    length, points = shortest_path(scenario(circle, fin_above))
    assert length == pytest.approx(free, rel=1e-12)
    assert points[:, 1].min() == pytest.approx(-1.0, abs=sag(1.0))
    assert points[:, 1].max() <= 0.0
    pins = Circle(5.0, 1.0, 0.5), Circle(5.0, -1.0, 0.5)
    assert shortest_path(scenario(circle, *pins))[0] > free + 0.1


def test_a_doubled_or_contained_obstacle_changes_nothing():
    circle, box = Circle(5.0, 0.0, 1.0), Polygon.rectangle(7.0, -2.0, 8.0, 1.0)
    once, _ = shortest_path(scenario(circle, box))
    inside = Circle(5.0, 0.0, 0.5), Circle(4.9, 0.0, 0.9), Polygon.rectangle(7.2, -1.0, 7.5, 0.0)
    assert shortest_path(scenario(circle, box, circle, box, *inside))[0] == pytest.approx(once)


def test_it_may_pass_between_obstacles_that_touch_but_not_that_overlap():
    touching = Circle(5.0, 1.0, 1.0), Circle(5.0, -1.0, 1.0)
    assert shortest_path(scenario(*touching))[0] == pytest.approx(10.0, rel=1e-12)
    overlapping = Circle(5.0, 1.0, 1.0), Circle(5.0, -1.0, 1.0 + 1e-6)
    assert shortest_path(scenario(*overlapping))[0] > 10.5


def test_obstacles_that_separate_start_and_target_are_refused():
    ring = [Circle(3.0 * math.cos(angle), 3.0 * math.sin(angle), 1.5) for angle in range(7)]
    with pytest.raises(ScenarioError, match="'made': the obstacles separate"):
        shortest_path(scenario(*ring))
    assert shortest_path(scenario(*ring[1:]))[0] > 10.0


# Shortest paths in general.


@pytest.mark.parametrize(("case", "length"), [("case1", 994.234), ("case2", 1053.551), ("case3", 997.455)])
def test_shortest_paths_of_the_cases(case, length):
    assert shortest_path(make_scenario(case))[0] == pytest.approx(length, abs=1e-3)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, num_obstacles=st.integers(0, 12))
def test_the_shortest_path_enters_no_obstacle(seed, num_obstacles):
    made = random_scenario(np.random.default_rng(seed), num_obstacles)
    length, points = shortest_path(made)
    assert made.straight_line <= length + 1e-9
    assert polyline_length(points) == pytest.approx(length, rel=2e-5)
    np.testing.assert_array_equal(points[[0, -1]], [made.start, made.target])
    deepest = 1e-6 + max((sag(o.radius) for o in made.obstacles if isinstance(o, Circle)), default=0.0)
    path = shapely.LineString(points)
    for obstacle in made.obstacles:
        if isinstance(obstacle, Circle):
            distance = path.distance(shapely.Point(obstacle.x, obstacle.y))
            assert distance >= obstacle.radius - deepest
        else:
            core = shapely.Polygon(obstacle.vertices).buffer(-deepest, join_style="mitre")
            assert not path.intersects(core)


def as_polygon(obstacle, sides, outside, margin):
    """A polygon inside (outside) an obstacle, grown by a margin."""
    if isinstance(obstacle, Polygon):
        return shapely.Polygon(obstacle.vertices).buffer(margin, join_style="mitre")
    radius = obstacle.radius / (math.cos(math.pi / sides) if outside else 1.0) + margin
    angles = np.arange(sides) * math.tau / sides
    around = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return shapely.Polygon((obstacle.x, obstacle.y) + radius * around)


def visibility_length(made, sides, outside):
    """Shortest path from corner to corner among polygons inside (outside) the obstacles.

    Corners lie on, and lines are tested against, polygons that differ by a margin, so that a line
    along an outline is free: the length is a lower (upper) bound of the true one up to the margin.
    """
    on, against = (1e-6, 0.0) if outside else (0.0, -1e-6)
    corners = [shapely.get_coordinates(as_polygon(o, sides, outside, on))[:-1] for o in made.obstacles]
    nodes = np.concatenate([[made.start, made.target], *corners])
    blocks = shapely.union_all([as_polygon(o, sides, outside, against) for o in made.obstacles])
    shapely.prepare(blocks)
    i, j = np.triu_indices(len(nodes), 1)
    free = ~shapely.intersects(blocks, shapely.linestrings(np.stack([nodes[i], nodes[j]], axis=1)))
    lengths = np.zeros((len(nodes), len(nodes)))  # 0 is no edge
    lengths[i[free], j[free]] = np.linalg.norm(nodes[i[free]] - nodes[j[free]], axis=1)
    return scipy.sparse.csgraph.dijkstra(lengths, directed=False, indices=0)[1]


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS, num_obstacles=st.integers(1, 8))
def test_the_length_lies_between_those_around_inner_and_outer_polygons(seed, num_obstacles):
    made = random_scenario(np.random.default_rng(seed), num_obstacles)
    length, _ = shortest_path(made)
    assert visibility_length(made, 32, outside=False) <= length + 1e-6
    assert length <= visibility_length(made, 32, outside=True) + 1e-6


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, angle=ANGLES)
def test_turning_and_shifting_the_map_keeps_the_length(seed, angle):
    made = random_scenario(np.random.default_rng(seed))
    length, _ = shortest_path(made)
    assert shortest_path(turned(made, angle, (30.0, -70.0)))[0] == pytest.approx(length, rel=1e-9)


# The optimum among waypoint paths.


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_the_best_path_on_a_grid_is_the_best_of_all_its_paths(seed):
    rng = np.random.default_rng(seed)
    problem = Problem(random_scenario(rng), 4, rng.uniform(0.05, 1.0))
    grid = np.zeros((6, 5))
    grid[1:-1] = rng.uniform(-100.0, 100.0, (4, 5))
    path = best_path(problem.table, grid)
    all_fitness = [problem.evaluate(offsets)[0] for offsets in itertools.product(*grid[1:-1])]
    assert (path[[0, -1]] == 0.0).all()
    assert problem.evaluate(path[1:-1])[0] == pytest.approx(min(all_fitness), rel=1e-12)


@pytest.mark.parametrize("length_weight", [0.05, 0.3, 0.9])
def test_one_waypoint_is_put_where_a_scan_of_all_offsets_has_its_minimum(length_weight):
    made = scenario(Circle(4.0, 0.5, 2.0), Polygon.rectangle(6.0, -4.0, 7.0, 1.5))
    problem = Problem(made, 1, length_weight)
    fitness, offsets = optimum(problem, coarse_step=0.5)
    scan = min(problem.evaluate([y])[0] for y in np.linspace(-20.0, 20.0, 40001))
    assert problem.evaluate(offsets)[0] == fitness
    assert scan - 1e-3 <= fitness <= scan


@pytest.mark.parametrize(("obstacles", "length_weight"), [((), 0.3), ((Circle(5, 0.3, 1),), 1.0)])
def test_without_obstacles_or_weight_on_them_it_is_the_straight_line(obstacles, length_weight):
    fitness, offsets = optimum(Problem(scenario(*obstacles), 3, length_weight))
    assert fitness == pytest.approx(10.0 * length_weight, rel=1e-12)
    np.testing.assert_allclose(offsets, 0.0, atol=1e-6)


def test_the_optimum_stays_inside_the_workspace():
    wall = Polygon.rectangle(4.0, -1.0, 6.0, 3.0)
    made = Scenario("made", (0.0, 0.0), (10.0, 0.0), (wall,), (0.0, -0.5, 10.0, 6.0))
    problem = Problem(made, 3)
    offsets = optimum(problem)[1]
    assert (offsets >= problem.table.lower).all()
    assert (offsets <= problem.table.upper).all()
    wide = Problem(scenario(wall), 3)
    assert optimum(problem)[0] > optimum(wide)[0] + 0.1


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_no_feasible_waypoint_path_is_shorter_than_the_shortest_path(seed):
    made = random_scenario(np.random.default_rng(seed), 5)
    problem = Problem(made, 8, length_weight=0.05)
    offsets = optimum(problem, coarse_step=5.0)[1]
    if problem.evaluate(offsets)[1] <= FEASIBILITY_TOLERANCE:
        shortest, _ = shortest_path(made)
        assert polyline_length(problem.points(offsets)) >= shortest - 1e-6


@pytest.mark.parametrize(
    ("case", "fitness"), [("case1", 299.098012), ("case2", 316.525806), ("case3", 300.644023)]
)
def test_optima_of_the_cases_with_thirty_waypoints(case, fitness):
    problem = make_problem(case, 30)
    found, offsets = optimum(problem)
    assert found == pytest.approx(fitness, abs=2e-6)
    assert problem.evaluate(offsets)[1] <= FEASIBILITY_TOLERANCE
    shortest, _ = shortest_path(problem.scenario)
    assert polyline_length(problem.points(offsets)) > shortest


def test_a_finer_grid_finds_no_better_path():
    problem = make_problem("case1")
    assert optimum(problem, coarse_step=0.25)[0] == pytest.approx(optimum(problem)[0], abs=1e-6)


@pytest.mark.parametrize("case", CASES)
def test_a_swarm_that_begins_at_the_optimum_does_not_get_below_it(case):
    problem = make_problem(case)
    fitness, offsets = optimum(problem)
    noise = np.random.default_rng(1).normal(0.0, 0.5, (30, problem.num_waypoints))
    noise[0] = 0.0
    population = np.clip(offsets + noise, problem.table.lower, problem.table.upper)
    env = SwarmEnv(scenario=case, noise=0.1, iterations=10)
    _, info = env.reset(seed=0, options={"initial_population": population})
    assert info["best_fitness"] == pytest.approx(fitness, abs=1e-9)
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(np.array([30.0, 0.5]))
    assert info["best_fitness"] >= fitness - 1e-6
    assert info["optimality_gap"] == pytest.approx(0.0, abs=1e-8)


# The optima that ship with the package.


def test_the_shipped_optima_are_what_is_computed_for_every_registered_scenario(tmp_path):
    file = tmp_path / "optima.json"
    write_optima(file)
    assert list(tmp_path.iterdir()) == [file]
    entries = json.loads(file.read_text())
    assert [entry["name"] for entry in entries] == sorted(SCENARIOS)
    for entry in entries:
        problem = Problem(make_scenario(entry["name"]))
        assert known_optimum(problem) == pytest.approx(entry["fitness"], abs=2e-6)
        assert entry["shortest_path"] == pytest.approx(shortest_path(problem.scenario)[0], abs=1e-6)
        assert problem.length_weight * entry["shortest_path"] < entry["fitness"]


def test_the_optimum_of_another_problem_is_not_known():
    assert math.isnan(known_optimum(Problem(scenario())))
    assert math.isnan(known_optimum(make_problem("case1", 30)))
    assert math.isnan(known_optimum(make_problem("case1", length_weight=0.4)))


def test_equal_problems_have_one_digest_whatever_their_name_and_number_type():
    def made(name, number, radius=1):
        zero, five = number(0), number(5)
        circle, workspace = Circle(five, zero, number(radius)), (zero, -five, five + five, five)
        return Problem(Scenario(name, (zero, zero), (five + five, zero), (circle,), workspace))

    digests = {digest(made(str(number), number)) for number in (int, float, np.int64, np.float32)}
    assert len(digests) == 1
    assert digest(made("another radius", int, 2)) not in digests


def test_environments_do_not_import_what_computes_optima():
    code = "import sys, swarm_gym.env; print(*sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert "swarm_gym.reference" in loaded
    assert {f"swarm_gym.reference.{m}" for m in ("waypoint_optimum", "visibility")}.isdisjoint(loaded)
