"""The exact planner of discs on grids, against a graph of all tangents and against lengths in closed form."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.grids import area_of, frozen, grid
from helpers.robot_maps import RESOLUTION, door_map, office_map
from oracles.naive_discs import shortest_disc_path
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.problem.geometry.clearance import clearance
from swarm_gym.reference import (
    AnyAnglePlanner,
    DiscPlanner,
    known_robot_path,
    shortest_path,
    shortest_robot_path,
)
from swarm_gym.reference.disc_planner import TooMuchWorkError
from swarm_gym.scenarios import GridMap, GridScenario

SEEDS = st.integers(0, 2**32 - 1)
# Radii that are exactly half of gaps between cells, and others.
RADII = (0.5, 1.0, 1.5, math.sqrt(0.5), 1.5 * math.sqrt(0.5), math.sqrt(5.0) / 2, 0.3, 0.05, 0.49999999)
LONGER = 2.5e-7  # share by which the polyline may be longer than the path


def random_task(seed, most):
    """Return blocked cells, a radius, and ends where the disc fits, often on grid lines, or None."""
    rng = np.random.default_rng(seed)
    width, height = rng.integers(2, most, 2)
    blocked = rng.random((height, width)) < rng.choice([0.05, 0.1, 0.2, 0.3])
    if rng.random() < 0.4:
        parts = rng.integers(2, 4)
        blocked = np.kron(blocked, np.ones((parts, parts), bool))[:most, :most].copy()
    size = np.array(blocked.shape[::-1])
    radius = float(rng.choice(RADII) if rng.random() < 0.6 else rng.uniform(0.01, 3.0))
    area = area_of(blocked)
    for _ in range(50):
        if rng.random() < 0.5:
            ends = rng.integers(-1, 2 * size, (2, 2)) / 2
        else:
            ends = rng.uniform(-0.5, size - 0.5, (2, 2))
        if area.is_empty or (shapely.distance(shapely.points(ends), area) >= radius).all():
            return frozen(blocked), radius, *(tuple(end) for end in ends.tolist())
    return None


def check(task):
    """The length is that of the graph, and the polyline keeps the distance and is hardly longer."""
    blocked, radius, start, goal = task
    expected = shortest_disc_path(blocked, radius, start, goal)
    if math.isinf(expected):
        with pytest.raises(NoPathError, match="leave no passage"):
            DiscPlanner(blocked, radius).shortest_path(start, goal)
        return
    length, points = DiscPlanner(blocked, radius).shortest_path(start, goal)
    assert length == pytest.approx(expected, rel=1e-9, abs=1e-9)
    np.testing.assert_array_equal(points[[0, -1]], [start, goal])
    line = shapely.LineString(points)
    assert length - 1e-9 <= line.length <= length * (1.0 + LONGER) + 1e-9
    height, width = blocked.shape
    assert shapely.box(-0.5, -0.5, width - 0.5, height - 0.5).buffer(1e-9).covers(line)
    if blocked.any():
        assert line.distance(area_of(blocked)) >= radius - 1.1e-9
        assert clearance(blocked, points) >= radius - 1e-9


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_paths_of_discs_are_the_shortest_of_a_graph_of_all_tangents(seed):
    task = random_task(seed, 9)
    assume(task is not None and task[2] != task[3])
    check(task)


@pytest.mark.slow
@given(seed=SEEDS)
@settings(max_examples=1000, deadline=None)
def test_paths_of_discs_on_larger_grids_are_the_shortest(seed):
    task = random_task(seed, 15)
    assume(task is not None and task[2] != task[3])
    check(task)


@given(seed=SEEDS)
@settings(max_examples=100, deadline=None)
def test_discs_of_hardly_any_radius_take_the_any_angle_path(seed):
    rng = np.random.default_rng(seed)
    blocked = frozen(rng.random(rng.integers(2, 15, 2)) < rng.choice([0.1, 0.3]))
    cells = np.argwhere(~blocked)[:, ::-1]
    assume(len(cells) > 1)
    start, goal = rng.choice(cells, 2, replace=False).astype(float).tolist()
    try:
        expected = AnyAnglePlanner(blocked).shortest_path(start, goal)[0]
    except NoPathError:
        expected = None
    if expected is None:
        with pytest.raises(NoPathError):
            DiscPlanner(blocked, 1e-6).shortest_path(start, goal)
    else:
        length, _ = DiscPlanner(blocked, 1e-6).shortest_path(start, goal)
        assert expected - 1e-9 <= length <= expected * (1.0 + 1e-5)


def test_a_disc_turns_around_a_wall_on_an_arc():
    wall = np.zeros((20, 21), dtype=np.bool_)
    wall[10:, 10] = True
    length, points = DiscPlanner(frozen(wall), 2.0).shortest_path((4.5, 14.0), (15.5, 14.0))
    # From 5 columns beside a corner of the wall, and 4.5 rows below it, on both sides.
    distance = math.hypot(5.0, 4.5)
    turn = math.pi / 2 - (math.acos(2.0 / distance) - math.atan2(4.5, 5.0))
    assert length == pytest.approx(1.0 + 2.0 * (math.sqrt(distance**2 - 4.0) + 2.0 * turn), rel=1e-12)
    assert points[:, 1].min() == pytest.approx(7.5, abs=1e-9)


@pytest.mark.parametrize("cells", [1, 2, 9, 10])
def test_a_door_as_wide_as_the_disc_is_open_and_one_hardly_narrower_is_not(cells):
    scenario = GridScenario("door", door_map(cells), (-1.5, 0.2), (1.5, 0.2))
    width = cells * RESOLUTION
    length, path = shortest_robot_path(scenario, width / 2)
    assert length >= 3.0
    assert clearance(scenario.map.blocked, scenario.map.to_cells(path)) * 2 >= cells - 1e-8
    with pytest.raises(NoPathError, match=f"disc of diameter {width + 2e-6:g}"):
        shortest_robot_path(scenario, width / 2 + 1e-6)
    assert shortest_robot_path(scenario, 0.0)[0] == shortest_path(scenario)[0] <= length


@pytest.mark.parametrize(
    ("radius", "expected"),
    [(0.25, 23.0084), (0.30, 23.1810), (0.31, 26.4374)],  # through the gap of 0.60 m, and around
)
def test_the_gap_of_an_office_is_open_to_robots_that_fit(radius, expected):
    scenario = GridScenario("office", office_map(), (-1.0, 0.8), (15.2, 11.0))
    assert shortest_robot_path(scenario, radius)[0] == pytest.approx(expected, abs=1e-4)
    assert known_robot_path(scenario, radius)[0] == shortest_robot_path(scenario, radius)[0]


def test_only_the_centre_of_a_disc_stays_on_the_map():
    wall = grid(".....", "..#..", "..#..", "..#..")
    ends = (-0.5, 3.0), (4.5, 3.0)
    length, points = DiscPlanner(wall, 1.0).shortest_path(*ends)
    assert points[:, 1].min() == pytest.approx(-0.5)  # the border of the map, which the disc crosses
    assert length == pytest.approx(shortest_disc_path(wall, 1.0, *ends), rel=1e-9)
    with pytest.raises(NoPathError):
        DiscPlanner(wall, 1.0 + 1e-6).shortest_path(*ends)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ((1.0, 1.2), r"start \(1, 1.2\) is 0.5 cells from a blocked cell; expected at least 0.6"),
        ((3.0, 1.0), r"start \(3, 1\) is 0 cells from a blocked cell"),
        ((-1.0, 0.0), r"start \(-1, 0\) is outside the grid"),
        ((math.nan, 0.0), "expected two finite numbers"),
    ],
)
def test_ends_where_the_disc_does_not_fit_are_refused(start, message):
    with pytest.raises(ScenarioError, match=message):
        DiscPlanner(grid(".....", "..##.", "....."), 0.6).shortest_path(start, (0.0, 0.0))


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, math.inf])
def test_a_radius_that_is_none_is_refused(radius):
    with pytest.raises(ScenarioError, match="radius is"):
        DiscPlanner(grid(".."), radius)


def test_a_search_that_takes_too_much_work_is_given_up_whatever_was_found_before():
    blocked = np.random.default_rng(0).random((60, 60)) < 0.02
    blocked[[0, -1], [0, -1]] = False
    ends = (0.0, 0.0), (59.0, 59.0)
    with pytest.raises(TooMuchWorkError):
        DiscPlanner(blocked, 0.5, most_work=10.0)
    planner = DiscPlanner(blocked, 0.5, most_work=1e5)
    for _ in range(2):
        with pytest.raises(TooMuchWorkError):
            planner.shortest_path(*ends)
    assert DiscPlanner(blocked, 0.5).shortest_path(*ends)[0] < 90.0
    scenario = GridScenario("rain", GridMap("rain", blocked), *ends)
    with pytest.raises(TooMuchWorkError):
        shortest_robot_path(scenario, 0.5, 1e5)


def test_turned_and_mirrored_maps_have_paths_of_the_same_length():
    blocked = np.random.default_rng(3).random((30, 40)) < 0.04
    start, goal = (1.0, 2.0), (37.0, 27.0)
    blocked[:5, :5] = blocked[24:, 34:] = False
    expected = DiscPlanner(blocked, 1.3).shortest_path(start, goal)[0]
    height, width = blocked.shape
    for turned, places in (
        (blocked.T, [end[::-1] for end in (start, goal)]),
        (blocked[::-1], [(x, height - 1 - y) for x, y in (start, goal)]),
        (blocked[:, ::-1], [(width - 1 - x, y) for x, y in (goal, start)]),
    ):
        assert DiscPlanner(turned, 1.3).shortest_path(*places)[0] == pytest.approx(expected, rel=1e-12)
