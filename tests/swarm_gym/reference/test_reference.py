import itertools
import json
import math
import subprocess
import sys
from importlib import resources

import numpy as np
import pytest
import scipy.sparse.csgraph
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import swarm_gym.worlds
from helpers.builders import CASES, make_problem, random_scenario, turned
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import ensure_optima, known_optimum, optimum, shortest_path
from swarm_gym.reference.optima import FIELD_FILES, digest, packaged_fields, store_optimum
from swarm_gym.reference.waypoint_optimum import (
    PACKAGED_SCENARIOS,
    best_path,
    main,
    write_field_optima,
    write_optima,
)
from swarm_gym.scenarios import (
    Circle,
    Polygon,
    Scenario,
    expand_name,
    make_scenario,
    make_scenarios,
    worlds_of,
)

SEEDS = st.integers(0, 2**32 - 1)


def scenario(*obstacles):
    return Scenario("made", (0.0, 0.0), (10.0, 0.0), obstacles, (-20.0, -20.0, 30.0, 20.0))


def polyline_length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def as_polygon(obstacle, sides, outside, margin):
    """A polygon inside (outside) an obstacle, grown by a margin."""
    if isinstance(obstacle, Polygon):
        return shapely.Polygon(obstacle.vertices).buffer(margin, join_style="mitre")
    radius = obstacle.radius / (math.cos(math.pi / sides) if outside else 1.0) + margin
    angles = np.arange(sides) * math.tau / sides
    around = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return shapely.Polygon((obstacle.x, obstacle.y) + radius * around)


def passable_scenario(seed, num_obstacles):
    """A random scenario in which start and target are not separated."""
    made = random_scenario(np.random.default_rng(seed), num_obstacles)
    blocks = shapely.union_all([as_polygon(o, 64, True, 1e-6) for o in made.obstacles])
    rooms = shapely.get_parts(shapely.box(-1e3, -1e3, 2e3, 2e3).difference(blocks))
    assume(shapely.covers(rooms, shapely.MultiPoint([made.start, made.target])).any())
    return made


def tangent_and_arc(distance, radius):
    """From a point to the top of a circle whose centre is at that distance beside it."""
    return math.sqrt(distance**2 - radius**2) + radius * math.asin(radius / distance)


ARC = math.pi - 2.0 * math.atan2(0.5, 2.5) - 2.0 * math.acos(1.5 / math.sqrt(6.5))
CLOSED_FORMS = {
    "nothing": ([], 10.0),
    "beside": ([Circle(5.0, 2.0, 1.5), Polygon.rectangle(2.0, -3.0, 8.0, -1.0)], 10.0),
    "circle": ([Circle(5.0, 0.0, 2.0)], 2.0 * tangent_and_arc(5.0, 2.0)),
    "close to a circle": ([Circle(5.0, 0.0, 4.999)], 2.0 * tangent_and_arc(5.0, 4.999)),
    "on a circle": ([Circle(1.0, 0.0, 1.0)], math.pi / 2.0 + tangent_and_arc(9.0, 1.0)),
    "rectangle": ([Polygon.rectangle(4.0, -1.0, 7.0, 2.0)], math.sqrt(17.0) + 3.0 + math.sqrt(10.0)),
    "inside": ([Circle(5.0, 0.0, 1.0), Circle(5.0, 0.2, 0.5)], 2.0 * tangent_and_arc(5.0, 1.0)),
    "overlap": ([Circle(4.0, 0.0, 1.5), Circle(6.0, 0.0, 1.5)], 2.0 * tangent_and_arc(4.0, 1.5) + 2.0),
    # Symmetric about (5, 0): twice the way from the start over the first circle to there.
    "inner tangent": (
        [Circle(2.5, -0.5, 1.5), Circle(7.5, 0.5, 1.5)],
        2.0 * (2.0 * math.sqrt(6.5 - 1.5**2) + 1.5 * ARC),
    ),
    "touching": ([Circle(5.0, 1.0, 1.0), Circle(5.0, -1.0, 1.0)], 10.0),
}


@pytest.mark.parametrize(("obstacles", "expected"), CLOSED_FORMS.values(), ids=CLOSED_FORMS)
def test_shortest_paths_have_the_lengths_of_their_closed_forms(obstacles, expected):
    assert shortest_path(scenario(*obstacles))[0] == pytest.approx(expected, rel=1e-12)


def test_the_shortest_path_does_not_pass_between_circles_that_overlap():
    circles = Circle(5.0, 1.0, 1.0), Circle(5.0, -1.0, 1.0 + 1e-6)
    assert shortest_path(scenario(*circles))[0] > 10.5


def test_a_doubled_or_contained_obstacle_changes_nothing():
    circle, box = Circle(5.0, 0.0, 1.0), Polygon.rectangle(7.0, -2.0, 8.0, 1.0)
    once, _ = shortest_path(scenario(circle, box))
    inside = Circle(5.0, 0.0, 0.5), Circle(4.9, 0.0, 0.9), Polygon.rectangle(7.2, -1.0, 7.5, 0.0)
    assert shortest_path(scenario(circle, box, circle, box, *inside))[0] == pytest.approx(once)


def test_obstacles_that_separate_start_and_target_are_refused():
    ring = [Circle(3.0 * math.cos(angle), 3.0 * math.sin(angle), 1.5) for angle in range(7)]
    with pytest.raises(ScenarioError, match="'made': the obstacles separate"):
        shortest_path(scenario(*ring))
    assert shortest_path(scenario(*ring[1:]))[0] > 10.0


@pytest.mark.parametrize(("case", "length"), [("case1", 994.234), ("case2", 1053.551), ("case3", 997.455)])
def test_shortest_paths_of_the_cases_have_their_known_lengths(case, length):
    assert shortest_path(make_scenario(case))[0] == pytest.approx(length, abs=1e-3)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, num_obstacles=st.integers(1, 12))
def test_the_shortest_path_enters_no_obstacle(seed, num_obstacles):
    made = passable_scenario(seed, num_obstacles)
    length, points = shortest_path(made)
    assert made.straight_line <= length + 1e-9
    assert length - 1e-9 <= polyline_length(points) <= length * (1.0 + 1e-5)
    np.testing.assert_array_equal(points[[0, -1]], [made.start, made.target])
    path, deepest = shapely.LineString(points), 1e-9
    for obstacle in made.obstacles:
        if isinstance(obstacle, Circle):
            distance = path.distance(shapely.Point(obstacle.x, obstacle.y))
            assert distance >= obstacle.radius - deepest
        else:
            core = shapely.Polygon(obstacle.vertices).buffer(-deepest, join_style="mitre")
            assert not path.intersects(core)


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


@settings(max_examples=8, deadline=None)
@given(seed=SEEDS, num_obstacles=st.integers(1, 8))
def test_the_length_lies_between_those_around_inner_and_outer_polygons(seed, num_obstacles):
    made = passable_scenario(seed, num_obstacles)
    length, _ = shortest_path(made)
    assert visibility_length(made, 32, outside=False) <= length + 1e-6
    assert length <= visibility_length(made, 32, outside=True) + 1e-6


def spike(angle, height):
    corners = (4.5, angle - 0.05), (4.5, angle + 0.05), (height, angle)
    return Polygon(tuple((r * math.cos(a), r * math.sin(a)) for r, a in corners))


@pytest.mark.parametrize(
    "cover", [(Circle(4.95, 4.95, 2.2), Circle(2.8, 4.15, 0.6)), (spike(0.8, 9.0), spike(1.05, 7.0))]
)
def test_an_arc_that_others_cover_off_its_middle_is_not_used(cover):
    # On the large circle the nearest nodes are far before the first cover and close after the second.
    obstacles = Circle(0.0, 0.0, 5.0), *cover
    made = Scenario("made", (4.0, -3.3), (0.5, 5.3), obstacles, (-9.0, -9.0, 9.0, 9.0))
    assert shortest_path(made)[0] >= visibility_length(made, 32, outside=False)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, angle=st.floats(-4.0, 4.0))
def test_turning_and_shifting_the_map_keeps_the_length(seed, angle):
    made = passable_scenario(seed, 12)
    moved = turned(made, angle, (30.0, -70.0))
    assert shortest_path(moved)[0] == pytest.approx(shortest_path(made)[0], rel=1e-9)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_the_best_path_on_a_grid_is_the_best_of_all_its_paths(seed):
    rng = np.random.default_rng(seed)
    problem = AnalyticProblem(random_scenario(rng), 4, rng.uniform(0.05, 1.0))
    grid = np.zeros((6, 5))
    grid[1:-1] = rng.uniform(-100.0, 100.0, (4, 5))
    path = best_path(problem.table, grid)
    all_fitness = [problem.evaluate(offsets)[0] for offsets in itertools.product(*grid[1:-1])]
    assert problem.evaluate(path[1:-1])[0] == pytest.approx(min(all_fitness), rel=1e-12)


@pytest.mark.parametrize("length_weight", [0.05, 0.3, 0.9])
def test_one_waypoint_is_put_where_a_scan_of_all_offsets_has_its_minimum(length_weight):
    made = scenario(Circle(4.0, 0.5, 2.0), Polygon.rectangle(6.0, -4.0, 7.0, 1.5))
    problem = AnalyticProblem(made, 1, length_weight)
    fitness, offsets = optimum(problem, coarse_step=0.5)
    scan = min(problem.evaluate([y])[0] for y in np.linspace(-20.0, 20.0, 40001))
    assert problem.evaluate(offsets)[0] == fitness
    assert scan - 1e-3 <= fitness <= scan


@pytest.mark.parametrize(("obstacles", "length_weight"), [((), 0.3), ((Circle(5, 0.3, 1),), 1.0)])
def test_without_obstacles_or_weight_on_them_it_is_the_straight_line(obstacles, length_weight):
    fitness, offsets = optimum(AnalyticProblem(scenario(*obstacles), 3, length_weight))
    assert fitness == pytest.approx(10.0 * length_weight, rel=1e-12)
    np.testing.assert_allclose(offsets, 0.0, atol=1e-6)


def test_the_optimum_stays_inside_the_workspace():
    wall = Polygon.rectangle(4.0, -1.0, 6.0, 3.0)
    made = Scenario("made", (0.0, 0.0), (10.0, 0.0), (wall,), (0.0, -0.5, 10.0, 6.0))
    problem = AnalyticProblem(made, 3)
    offsets = optimum(problem)[1]
    np.testing.assert_array_equal(offsets, np.clip(offsets, *problem.bounds))
    assert optimum(problem)[0] > optimum(AnalyticProblem(scenario(wall), 3))[0] + 0.1


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_no_feasible_waypoint_path_is_shorter_than_the_shortest_path(seed):
    made = passable_scenario(seed, 12)
    problem = AnalyticProblem(made, 8, length_weight=0.05)
    offsets = optimum(problem, coarse_step=5.0)[1]
    assume(problem.evaluate(offsets)[1] <= FEASIBILITY_TOLERANCE)
    assert polyline_length(problem.points(offsets)) >= shortest_path(made)[0] - 1e-6


@pytest.mark.parametrize(
    ("case", "fitness"), [("case1", 299.098012), ("case2", 316.525806), ("case3", 300.644023)]
)
def test_optima_of_the_cases_with_thirty_waypoints_have_their_known_values(case, fitness):
    problem = make_problem(case, 30)
    found, offsets = optimum(problem)
    assert found == pytest.approx(fitness, abs=2e-6)
    assert problem.evaluate(offsets)[1] <= FEASIBILITY_TOLERANCE
    assert polyline_length(problem.points(offsets)) > shortest_path(problem.scenario)[0]


@pytest.mark.parametrize("case", CASES)
def test_a_swarm_that_begins_at_the_optimum_does_not_get_below_it(case):
    problem = make_problem(case)
    fitness, offsets = optimum(problem)
    noise = np.random.default_rng(1).normal(0.0, 0.5, (30, problem.num_waypoints))
    noise[0] = 0.0
    population = np.clip(offsets + noise, *problem.bounds)
    env = SwarmEnv(scenario=case, noise=0.1, iterations=10)
    _, info = env.reset(seed=0, options={"initial_population": population})
    assert info["best_fitness"] == pytest.approx(fitness, abs=1e-9)
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(np.array([30.0, 0.5]))
    assert info["best_fitness"] >= fitness - 1e-6
    assert info["optimality_gap"] == pytest.approx(0.0, abs=1e-8)


def test_the_packaged_optima_are_what_is_computed_for_every_registered_scenario(tmp_path):
    file = tmp_path / "optima.json"
    write_optima(file)
    assert list(tmp_path.iterdir()) == [file]
    packaged_entries = json.loads(resources.files("swarm_gym.reference").joinpath(file.name).read_text())
    assert tuple(entry["name"] for entry in packaged_entries) == PACKAGED_SCENARIOS
    for new, old in zip(json.loads(file.read_text()), packaged_entries, strict=True):
        assert new.keys() == old.keys()
        for length in ("fitness", "shortest_path"):
            assert new[length] == pytest.approx(old[length], abs=2e-6)
        assert known_optimum(swarm_gym.worlds.make_problem(old["name"])) == old["fitness"]
        assert old["length_weight"] * old["shortest_path"] < old["fitness"]


def test_optima_of_all_worlds_of_changing_fields_ship_and_are_known():
    worlds = packaged_fields("dynamic_fields.json")
    fields = list(itertools.chain.from_iterable(map(expand_name, FIELD_FILES["dynamic_fields.json"])))
    assert list(dict.fromkeys(name.rpartition("@")[0] for name in worlds)) == fields
    for field in fields[::60]:
        for world in make_scenario(field).worlds:
            problem = AnalyticProblem(world.scenario)
            assert worlds[f"{field}@{world.iteration}"][0] == digest(problem)
            assert known_optimum(problem) == worlds[f"{field}@{world.iteration}"][1]


def test_optima_of_fields_ship_under_their_names_and_are_known():
    fields = packaged_fields("random_fields.json")
    assert tuple(fields) == tuple(
        itertools.chain.from_iterable(map(expand_name, FIELD_FILES["random_fields.json"]))
    )
    for name in list(fields)[::50]:
        problem = AnalyticProblem(make_scenario(name))
        assert fields[name][0] == digest(problem)
        assert known_optimum(problem) == fields[name][1]


@pytest.mark.parametrize(
    ("file", "count", "least"), [("random_fields.json", 0, 1.0), ("dynamic_fields.json", 15, 0.967)]
)
def test_the_packaged_optima_of_fields_are_plausible_beside_their_shortest_paths(file, count, least):
    """Waypoints do not stand where corners are, which makes paths longer.

    Through a corner would be shorter, and is cheaper in a few worlds, where obstacles overlap.
    """
    ratios = {
        name: fitness / (0.3 * shortest) for name, (_, fitness, shortest) in packaged_fields(file).items()
    }
    assert min(ratios.values()) > least
    assert max(ratios.values()) < 1.05
    through = [name for name, ratio in ratios.items() if ratio < 1.0]
    assert len(through) == count
    for name in through:
        field, _, iteration = name.partition("@")
        (world,) = (w for w in worlds_of(make_scenario(field)) if w.iteration == int(iteration))
        obstacles = [as_polygon(o, 64, False, 0.0) for o in world.scenario.obstacles]
        assert any(one.intersects(other) for one, other in itertools.combinations(obstacles, 2)), name


@pytest.mark.slow
@pytest.mark.parametrize("file", FIELD_FILES)
def test_the_packaged_optima_of_fields_are_what_is_computed(tmp_path, file):
    calls = []
    names = [expand_name(name)[-1] for name in FIELD_FILES[file]]
    write_field_optima(tmp_path / "fields.json", names, lambda done, total: calls.append((done, total)))
    computed = json.loads((tmp_path / "fields.json").read_text())
    assert calls == [(k, len(computed)) for k in range(1, len(computed) + 1)]
    assert list(dict.fromkeys(name.partition("@")[0] for name in computed)) == names
    for name, (name_of_problem, *lengths) in computed.items():
        expected_name, *expected = packaged_fields(file)[name]
        assert name_of_problem == expected_name
        assert lengths == pytest.approx(expected, abs=2e-6)


FIELDS = [f"random-fields:{name}:300" for name in ("test", "denser", "narrow", "rotated")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "num_waypoints", "step"), [("case1", 31, 0.25), *((name, 20, 0.5) for name in FIELDS)]
)
def test_a_finer_grid_finds_no_better_path(name, num_waypoints, step):
    problem = AnalyticProblem(make_scenario(name), num_waypoints)
    assert optimum(problem, coarse_step=step)[0] == pytest.approx(optimum(problem)[0], abs=1e-6)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path))
    return tmp_path


def test_an_optimum_is_known_once_it_was_ensured(cache):
    problems = [AnalyticProblem(made, 8) for made in make_scenarios("random-fields:large-obstacles:0-2")]
    assert all(map(math.isnan, map(known_optimum, problems)))
    calls = []
    optima = ensure_optima(problems, 2, lambda done, total: calls.append((done, total)))
    assert optima == [optimum(problem)[0] for problem in problems]
    assert calls == [(1, 3), (2, 3), (3, 3)]
    assert list(map(known_optimum, problems)) == optima
    assert len([path for path in cache.rglob("*") if path.is_file()]) == 3


def test_an_optimum_that_is_known_is_not_computed_again(cache):
    problem = make_problem("case1", 7)
    store_optimum(problem, 123.0)
    assert ensure_optima([problem]) == [123.0]
    assert math.isnan(known_optimum(make_problem("case1", 8)))
    assert ensure_optima([make_problem("case1")]) == [known_optimum(make_problem("case1"))]


@pytest.mark.parametrize("content", ["", "12,5", "none"])
def test_a_damaged_file_in_the_cache_is_computed_again(cache, content):
    problem = make_problem("case3", 5)
    store_optimum(problem, 1.0)
    (file,) = (path for path in cache.rglob("*") if path.is_file())
    file.write_text(content)
    assert math.isnan(known_optimum(problem))
    assert ensure_optima([problem]) == [known_optimum(problem)] == [optimum(problem)[0]]


def test_the_command_stores_what_environments_then_know(cache, monkeypatch, capsys):
    name = "random-fields:large-obstacles:700-701"
    monkeypatch.setattr(sys, "argv", ["waypoint_optimum", name, "--num-waypoints", "6"])
    main()
    assert "2/2" in capsys.readouterr().err
    env = SwarmEnv(scenario=name, num_waypoints=6)
    env.reset(seed=0)
    assert np.isfinite(env.simulation.gaps.optimality()).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "expected names"),
        (["case1", "--ship"], "expected names"),
        (["case9"], "'case9'"),
        (["case1", "--num-waypoints", "0"], "num_waypoints"),
        (["case1", "--threads", "0"], "num_threads"),
    ],
)
def test_the_command_refuses_what_it_cannot_do(arguments, message, cache, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["waypoint_optimum", *arguments])
    with pytest.raises(SystemExit):
        main()
    assert message in capsys.readouterr().err


def test_the_optimum_of_another_problem_is_not_known(cache):
    assert math.isnan(known_optimum(AnalyticProblem(scenario())))
    assert math.isnan(known_optimum(make_problem("case1", 30)))
    assert math.isnan(known_optimum(make_problem("case1", length_weight=0.4)))


def test_equal_problems_have_one_digest_whatever_their_name_and_number_type():
    def made(name, number, radius=1):
        zero, five = number(0), number(5)
        circle, workspace = Circle(five, zero, number(radius)), (zero, -five, five + five, five)
        return AnalyticProblem(Scenario(name, (zero, zero), (five + five, zero), (circle,), workspace))

    digests = {digest(made(str(number), number)) for number in (int, float, np.int64, np.float32)}
    assert len(digests) == 1
    assert digest(made("another radius", int, 2)) not in digests


def test_environments_import_neither_pygame_nor_what_computes_optima():
    code = "import sys, swarm_gym.env; print(*sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert "swarm_gym.reference" in loaded
    assert {f"swarm_gym.reference.{m}" for m in ("waypoint_optimum", "visibility")}.isdisjoint(loaded)
    assert "pygame" not in loaded
