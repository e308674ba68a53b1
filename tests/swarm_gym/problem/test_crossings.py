"""Blocked lengths of paths on grid maps, against the exact traversal and against shapely."""

import re
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.compiled import compiled
from helpers.grids import area_of, grids
from helpers.public_maps import needed
from helpers.slow import slow_but
from swarm_gym.compiler.jit import entry
from swarm_gym.compiler.simd import load
from swarm_gym.env import SwarmEnv
from swarm_gym.planning.search import guided_population
from swarm_gym.problem import GridProblem
from swarm_gym.problem.geometry.traversal import TOLERANCE, blocked_length, path_is_free
from swarm_gym.problem.grid import crossings
from swarm_gym.problem.tables import evaluate_entry
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.ways import shortest_way


def _named(name, *tasks):
    return [f"moving-ai:{name}?start={task}" for task in tasks]


# Four scenarios on maps of each family.
FAMILIES = {
    "rooms": [f"rooms:{number}" for number in range(4)],
    "caves": [f"caves:{number}" for number in range(4)],
    "block": [f"block:{number}" for number in (20, 50, 100, 150)],
    "maze": _named(
        "maze-128-128-10", "34,114&goal=14,73", "29,122&goal=64,75", "19,24&goal=8,59", "69,75&goal=18,108"
    ),
    "public rooms": _named(
        "room-64-64-8", "10,58&goal=42,14", "36,55&goal=39,47", "42,50&goal=61,38", "17,25&goal=20,38"
    ),
    "random": _named(
        "random-64-64-20", "63,44&goal=39,18", "47,63&goal=27,46", "10,36&goal=4,59", "24,23&goal=59,22"
    ),
    "arena": [f"moving-ai:arena#{number}" for number in (40, 60, 80, 100)],
    "game": [f"moving-ai:den400d#{number}" for number in (100, 200, 400, 700)],
}
OPTIMIZERS = "particle-swarm", "firefly", "multivariate", "elite-genetic", "generational-firefly"
ENCODINGS = [("bezier", 1), ("bezier", 4), ("bezier", 8), ("waypoints", 3), ("waypoints", 31)]


@cache
def eight():
    @entry
    def measure(table, numbers):
        x, y, dx, dy = load(numbers, 0), load(numbers, 1), load(numbers, 2), load(numbers, 3)
        return crossings.pieces(table, x, y, dx, dy)

    return measure


def problem_on(blocked, num_points=1):
    """Return a problem on a map whose first two cells are free."""
    return GridProblem(
        GridScenario("drawn", GridMap("drawn", blocked), (0, 0), (1, 0)), "waypoints", num_points
    )


def points_in(height, width):
    """Points among the centres of cells: centres, middles of edges, corners, and any others."""
    halves = st.tuples(st.integers(0, 2 * width - 2), st.integers(0, 2 * height - 2))
    anywhere = st.tuples(st.floats(0.0, width - 1.0), st.floats(0.0, height - 1.0))
    return st.one_of(halves.map(lambda point: (point[0] / 2, point[1] / 2)), anywhere)


@st.composite
def maps_and_points(draw, count):
    """Draw a map whose first two cells are free, and points on it."""
    blocked = np.pad(draw(grids(most=9)), ((1, 0), (0, 1)))
    points = draw(st.lists(points_in(*blocked.shape), min_size=count, max_size=count))
    return blocked, np.array(points, dtype=np.float64)


def test_a_piece_without_length_in_a_blocked_cell_has_a_blocked_length_of_zero():
    blocked = np.zeros((6, 10), dtype=np.bool_)
    blocked[2, 2] = True
    at = 1.5804458185525354  # rounding leaves a rest between what lies before it and after it
    found = compiled(crossings.segment)(problem_on(blocked).table, at, at, 0.0, 0.0)
    assert found == (0.0, False)


@settings(deadline=None)
@given(maps_and_points(2))
def test_a_segment_is_blocked_as_by_the_traversal_unless_it_is_in_doubt(drawn):
    blocked, ends = drawn
    length, in_doubt = compiled(crossings.segment)(problem_on(blocked).table, *ends[0], *(ends[1] - ends[0]))
    if not in_doubt:
        assert length == pytest.approx(blocked_length(blocked, ends), abs=1e-9)
        assert np.ptp(ends, axis=0).any() <= ((length == 0.0) == path_is_free(blocked, ends))


@settings(deadline=None)
@given(maps_and_points(16), st.sampled_from([0.1, 1.0]))
def test_eight_pieces_are_blocked_as_by_the_traversal_unless_one_is_in_doubt(drawn, scale):
    blocked, points = drawn
    begins, changes = points[:8], scale * (points[8:] - points[:8])
    numbers = np.ascontiguousarray(np.concatenate([begins.T, changes.T]))
    length, in_doubt = eight()(problem_on(blocked).table, numbers)
    if not in_doubt:
        pieces = np.stack([begins, begins + changes], axis=1)
        assert length == pytest.approx(sum(blocked_length(blocked, piece) for piece in pieces), abs=1e-9)
        assert (length == 0.0) == all(
            path_is_free(blocked, piece) for piece in pieces if np.ptp(piece, axis=0).any()
        )


@settings(deadline=None)
@given(maps_and_points(6))
def test_a_path_through_corners_and_along_edges_collides_unless_it_is_free(drawn):
    blocked, points = drawn
    problem = problem_on(blocked, num_points=4)
    table = problem.table._replace(base=points, gain=np.zeros_like(points))
    collision = evaluate_entry(table, problem._path(np.zeros(4)))[1] if np.ptp(points) > 0.0 else 0.0
    is_free = np.ptp(points) == 0.0 or path_is_free(blocked, points)
    passed = 0.0 if is_free else crossings.DOUBT  # by a gap, of no width
    assert collision == pytest.approx(blocked_length(blocked, points) or passed, abs=1e-9)
    assert (collision == 0.0) == is_free


@pytest.mark.parametrize("scale", [0.3, 1.0, 20.0])
def test_random_pieces_are_hardly_ever_in_doubt(scale):
    rng = np.random.default_rng(0)
    blocked = rng.random((60, 70)) < 0.3
    blocked[0, :2] = False
    table, doubts = problem_on(blocked).table, 0
    for _ in range(2000):
        begins, changes = rng.uniform((20, 20), (50, 40), (8, 2)), rng.uniform(-scale, scale, (8, 2))
        doubts += eight()(table, np.ascontiguousarray(np.concatenate([begins.T, changes.T])))[1]
    assert doubts <= 2


# Whole paths, against shapely.


def scenario_of(name):
    family, _, rest = name.partition(":")
    if family == "moving-ai":
        needed(re.split("[#?]", rest)[0] + ".map")
    return make_scenario(name)


def differences(problem, vectors):
    """Return of how many paths shapely says otherwise than the problem, and how many are free."""
    room = area_of(~problem.scenario.map.blocked)
    shapely.prepare(room)
    paths = [shapely.LineString(problem.scenario.map.to_cells(path)) for path in problem.points(vectors)]
    free = shapely.covers(room, paths)
    for index in np.flatnonzero(~free):  # what only touches a cell, within rounding, is free
        free[index] = paths[index].difference(room).length <= TOLERANCE
    collides = np.array([problem.evaluate(vector)[1] > 0.0 for vector in vectors])
    return int((collides == free).sum()), int(free.sum())


def random_vectors(problem, count, seed):
    """Return vectors around the straight line, from narrow to wide."""
    rng, (low, high) = np.random.default_rng(seed), problem.bounds
    widths = rng.choice([0.01, 0.05, 0.2, 1.0], (count, 1))
    return problem.curve.middle + widths * (rng.uniform(low, high, (count, len(low))) - problem.curve.middle)


def optimised(optimizer, scenario, encoding, num_points, seed):
    """Return a problem, and the members of a swarm after twenty iterations.

    Curves begin around the path of A*, since random ones hardly ever come through a maze.
    """
    problem = GridProblem(scenario, encoding, num_points)
    count = {"bezier": "num_control_points", "waypoints": "num_waypoints"}[encoding]
    env = SwarmEnv(
        optimizer,
        scenario=scenario,
        encoding=encoding,
        initial_population_size=32,
        iterations=20,
        **{count: num_points},
    )
    options = None
    if encoding == "bezier":
        options = {"initial_population": guided_population(problem, shortest_way(scenario), 32, seed)}
    env.reset(seed=seed, options=options)
    for _ in range(20):
        env.step(np.array([32.0, 1.0]))
    return problem, env.simulation.positions(0)


@pytest.mark.parametrize(
    ("family", "encoding", "num_points"),
    slow_but(
        [("rooms", *one) for one in ENCODINGS]
        + [(family, "bezier", 4) for family in ("caves", "block", "public rooms", "random", "arena")],
        [(family, *one) for family in FAMILIES for one in ENCODINGS],
    ),
)
def test_paths_collide_unless_shapely_finds_them_free(family, encoding, num_points):
    problem = GridProblem(scenario_of(FAMILIES[family][0]), encoding, num_points)
    assert differences(problem, random_vectors(problem, 40, seed=0))[0] == 0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*every path turns back")
@pytest.mark.parametrize("family", FAMILIES)
def test_100000_random_paths_collide_unless_shapely_finds_them_free(family):
    """12,800 for each of eight families."""
    for encoding, num_points in ENCODINGS:
        for number, name in enumerate(FAMILIES[family]):
            problem = GridProblem(scenario_of(name), encoding, num_points)
            assert differences(problem, random_vectors(problem, 640, seed=number))[0] == 0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*every path turns back")
@pytest.mark.parametrize("family", FAMILIES)
def test_10000_optimised_paths_collide_unless_shapely_finds_them_free(family):
    """1,920 for each of eight families."""
    total = 0
    for encoding, num_points in ("bezier", 8), ("bezier", 60), ("waypoints", 31):
        for name in FAMILIES[family]:
            for seed, optimizer in enumerate(OPTIMIZERS):
                scenario = scenario_of(name)
                problem, vectors = optimised(optimizer, scenario, encoding, num_points, seed)
                different, free = differences(problem, vectors)
                assert different == 0
                total += free
    assert total > 0
