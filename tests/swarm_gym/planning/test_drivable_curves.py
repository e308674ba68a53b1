"""Drivable curves: all limits by other code, costs, refusals, outputs, and the planner's object."""

import contextlib
import json
import math
import re
import time

import numpy as np
import pytest
import shapely

from helpers.grids import grid
from oracles.driven_curves import assert_drivable, obstacles_of
from swarm_gym.errors import NoPathError, ScenarioError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import GradedMap, Planner, plan
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.curves.pieces import connect, connected
from swarm_gym.planning.curves.search import Limits, cost_between
from swarm_gym.planning.drive_costs import USUAL
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.previous import read_previous
from swarm_gym.planning.tasks import read_task
from swarm_gym.scenarios import Circle, GridMap, Polygon, Scenario

LATE = 5.0  # seconds that a call may take on a machine that does much else
FEW = {"max_evaluations": 4000}


def corridor(width=7, length=30):
    """A straight corridor with walls on all sides."""
    blocked = np.ones((width + 2, length), dtype=bool)
    blocked[1:-1, 1:-1] = False
    return GridMap("corridor", blocked)


@pytest.mark.parametrize(
    ("where", "radius", "turning_radius", "step"),
    [
        ("rooms:1", 0.3, 1.0, 0.001),
        ("caves:3", 0.4, 2.5, 0.001),
        ("case2", 5.0, 20.0, 0.01),
        ("case3", 2.0, 60.0, 0.03),
    ],
)
def test_curves_obey_all_limits(where, radius, turning_radius, step):
    found = plan(where, robot_radius=radius, turning_radius=turning_radius, **FEW)
    assert_drivable(found, radius, step=step)
    assert found.curve.least_radius >= turning_radius * (1.0 - 1e-12)
    assert found.length == found.improvements[-1].length
    assert found.gap > -1e-6


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("y_up", [False, True])
def test_headings_are_those_of_the_map(y_up, reverse):
    blocked = np.zeros((40, 50), dtype=bool)
    blocked[10:28, 20:24] = True
    where = GridMap("wall", blocked, 0.5, (-3.0, 2.0), y_up)
    start, goal = where.to_map([(4, 20), (44, 20)]).tolist()
    ends = {"start_heading": 90.0, "goal_heading": -135.0}
    found = plan(where, start, goal, robot_radius=0.4, turning_radius=1.0, reverse=reverse, **ends, **FEW)
    assert_drivable(found, 0.4, 90.0, -135.0, reverses=reverse)


def test_a_robot_that_may_reverse_turns_in_a_corridor():
    limits = {"robot_radius": 0.5, "turning_radius": 3.0, "start_heading": 180.0, "goal_heading": 0.0}
    with pytest.raises((SettingError, NoPathError), match="reverse=True"):
        plan(corridor(), (12.0, 4.0), (20.0, 4.0), **limits)
    found = plan(corridor(), (12.0, 4.0), (20.0, 4.0), reverse=True, **limits)
    assert_drivable(found, 0.5, 180.0, 0.0, reverses=True)
    assert found.curve.changes >= 1
    assert found.costs["changes"] == found.curve.changes


def test_short_curves_are_the_shortest_of_dubins():
    """Without obstacles near, nothing but the shortest curve between the poses is best."""
    scenario = Scenario(
        "open", (0.0, 0.0), (60.0, 20.0), (Circle(30.0, -200.0, 1.0),), (-9.0, -300.0, 90.0, 90.0)
    )
    limits = {"turning_radius": 5.0, "start_heading": 120.0, "goal_heading": -60.0}
    found = plan(scenario, wishes={}, **limits)
    drive_map = DriveMap(read_task(scenario, None, None, 0.0), 5.0, dict.fromkeys(USUAL, 0.0))
    begin, end = (
        np.array([*drive_map.to_nodes(point), math.radians(heading)])
        for point, heading in ((scenario.start, 120.0), (scenario.target, -60.0))
    )
    least = cost_between(drive_map.field, Limits(5.0 / drive_map.unit, False, 0.0, 0.0), begin, end, True)
    assert found.length == pytest.approx(least * drive_map.unit, rel=1e-4)
    assert found.length > math.dist(scenario.start, scenario.target) + 5.0


def test_short_curves_with_reversing_are_the_cheapest_words():
    """A robot that is beside its goal comes there by a word of four pieces; a change costs a radius."""
    scenario = Scenario(
        "lot", (0.0, 0.0), (2.0, 4.0), (Circle(30.0, -200.0, 1.0),), (-60.0, -300.0, 60.0, 90.0)
    )
    limits = {"turning_radius": 5.0, "start_heading": 0.0, "goal_heading": 0.0, "reverse": True}
    found = plan(scenario, wishes={}, **limits)
    begin, end = np.zeros(3), np.array([2.0, 4.0, 0.0])
    pieces = np.zeros((5, 2))
    least = connected(begin, end, 5.0, 5.0, False, math.inf, pieces)
    assert (pieces[:, 1] != 0.0).sum() == 4
    assert found.costs["sum"] == pytest.approx(least, rel=1e-4)
    assert found.costs["sum"] > connect(begin, end, 5.0, True, False, pieces)


def test_wide_arcs_cost_less_curvature():
    weights = [{"curvature": weight} for weight in (0.0, 2.0)]
    plain, wide = (
        plan("case2", turning_radius=20.0, goal_heading=90.0, wishes=one, **FEW) for one in weights
    )
    assert wide.costs["curvature"] < plain.costs["curvature"]
    assert plain.length < wide.length
    square = (wide.curve.poses[:-1, 3] * 20.0) ** 2
    steps = np.hypot(*np.diff(wide.path, axis=0).T)
    assert wide.costs["curvature"] == pytest.approx(float((square * steps).sum()), rel=1e-3)
    assert wide.costs["sum"] == pytest.approx(wide.length + 2.0 * wide.costs["curvature"])


def test_the_wish_for_distance_is_that_of_shapely():
    found = plan("case2", robot_radius=5.0, turning_radius=20.0, **FEW)
    poses = found.curve.sampled(0.5)
    middles = 0.5 * (poses[1:, :2] + poses[:-1, :2])
    _, apart = shapely.STRtree(obstacles_of(found.map)).query_nearest(
        shapely.points(middles), return_distance=True, all_matches=False
    )
    near = np.exp(-(apart - 5.0) / 20.0)
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert found.costs["distance"] == pytest.approx(float((near * steps).sum()), rel=1e-3)
    parts = sum(USUAL[name] * found.costs[name] for name in USUAL)
    assert found.costs["sum"] == pytest.approx(found.length + parts)


def test_dear_ground_is_driven_around():
    values = np.zeros((30, 40), dtype=int)
    values[5:25, 18:22] = 90
    ground = GradedMap.of_values("field", values, "costmap", 1.0, (0.0, 0.0))
    around, through = (
        plan(ground, (3.0, 15.0), (36.0, 15.0), turning_radius=2.0, wishes={"ground": weight})
        for weight in (9.0, 0.1)
    )
    assert_drivable(around, 0.0)
    assert around.costs["ground"] < 0.5 < through.costs["ground"]
    assert through.length < around.length


def test_a_test_of_a_curve_is_never_optimistic():
    """Curves that the compiled test calls free keep the margin, by shapely; those that keep more are free."""
    blocked = np.random.default_rng(3).random((24, 24)) < 0.1
    blocked[[0, -1]], blocked[:, [0, -1]] = False, False
    blocked[0, 0] = blocked[-1, -1] = False
    where = GridMap("blocks", blocked, 1.0, (0.0, 0.0))
    solids = Scenario(
        "solids", (1.0, 1.0), (22.0, 22.0),
        (Circle(8, 8, 3), Polygon(((14, 3), (20, 5), (15, 9))), Polygon.rectangle(4, 14, 9, 15)),
        (0.0, 0.0, 23.0, 23.0),
    )  # fmt: skip
    rng = np.random.default_rng(0)
    for given, ends in ((where, ((0.0, 0.0), (23.0, 23.0))), (solids, (None, None))):
        drive_map = DriveMap(read_task(given, *ends, 0.3), 1.5, dict.fromkeys(USUAL, 0.0))
        limits = Limits(1.5 / drive_map.unit, False, 0.0, 0.0)
        shapes, free, missed = shapely.union_all(obstacles_of(drive_map.task.given)), 0, 0
        for _ in range(300):
            begin, end = rng.uniform([1.0, 1.0, -3.0], [22.0, 22.0, 3.0], (2, 3))
            end[:2] = np.clip(begin[:2] + rng.uniform(-6.0, 6.0, 2), 1.0, 22.0)
            begin[:2], end[:2] = drive_map.to_nodes([begin[:2], end[:2]])
            is_free = math.isfinite(cost_between(drive_map.field, limits, begin, end, True))
            apart = shapely.distance(shapes, _line(drive_map, limits, begin, end))
            assert apart >= 0.3 or not is_free
            free += is_free
            missed += (
                apart > 0.3 + 2.0 * drive_map.slack
                and not is_free
                and _is_inside(drive_map, limits, begin, end)
            )
        assert free > 20
        assert missed == 0


def _pieces(limits, begin, end):
    pieces = np.zeros((3, 2))
    connect(begin, end, limits.radius, False, False, pieces)
    return pieces


def _line(drive_map, limits, begin, end):
    start = np.array([*begin[:2], math.degrees(begin[2])])
    points = Curve(start, _pieces(limits, begin, end), limits.radius).sampled(0.02)[:, :2]
    return shapely.LineString(drive_map.to_map(points))


def _is_inside(drive_map, limits, begin, end):
    """Return whether a curve stays in the region of the robot's centre."""
    x_min, y_min, x_max, y_max = _line(drive_map, limits, begin, end).bounds
    box = drive_map.box
    return x_min > box[0] + 0.1 and y_min > box[1] + 0.1 and x_max < box[2] - 0.1 and y_max < box[3] - 0.1


def test_the_same_call_gives_the_same_curve():
    one, other = (plan("rooms:0", robot_radius=0.3, turning_radius=1.0, **FEW) for _ in range(2))
    np.testing.assert_array_equal(one.path, other.path)
    assert one.evaluations == other.evaluations >= 4000


def test_more_work_never_costs_more():
    sums = [
        plan("rooms:0", robot_radius=0.3, turning_radius=1.5, max_evaluations=work).costs["sum"]
        for work in (1000, 8000, 40_000)
    ]
    assert sums[2] <= sums[1] * (1.0 + 1e-3) <= sums[0] * (1.0 + 2e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"turning_radius": 0.0}, r"turning_radius must lie in \[1e-06, 1e\+09\], got 0.0"),
        ({"turning_radius": "wide"}, "turning_radius must be a number, got 'wide'"),
        (
            {"turning_radius": 1.0, "start_heading": math.nan},
            "start_heading in degrees must lie in .*got nan",
        ),
        (
            {"turning_radius": 1.0, "goal_heading": "north"},
            "goal_heading in degrees must be a number, got 'north'",
        ),
        (
            {"turning_radius": 1.0, "goal_heading": 500.0},
            r"goal_heading in degrees must lie in \[-360, 360\]",
        ),
        ({"turning_radius": 1.0, "reverse": 1}, "reverse must be True or False, got 1"),
        (
            {"turning_radius": 1.0, "wishes": {"curvature": -1.0}},
            "weight of curvature must lie in .*got -1.0",
        ),
        ({"turning_radius": 1.0, "wishes": {"ground": 1.0}}, "has no costs of ground"),
        (
            {"turning_radius": 1.0, "previous": [(0, 0), (1, 1)]},
            "previous: expected a path that starts at",
        ),
        ({"turning_radius": 1.0, "planner": "swarm"}, "turning_radius: swarms find polylines"),
        ({"start_heading": 90.0}, "start_heading 90.0: expected a turning_radius, too"),
        ({"reverse": True}, "reverse True: expected a turning_radius, too"),
        ({"wishes": {"curvature": 1.0}}, "weight of curvature 1.0: expected a turning_radius, too"),
    ],
)
def test_bad_values_are_named(options, message):
    with pytest.raises(SettingError, match=message):
        plan("rooms:0", **options)


def test_a_robot_that_cannot_leave_an_end_is_told_so():
    """A dead end as wide as the robot, which it would have to leave backwards."""
    where = GridMap("pocket", grid("##########", "#....#####", "#.........", "#....#####", "##########"))
    limits = {"robot_radius": 0.4, "turning_radius": 3.0}
    with pytest.raises(SettingError, match=r"turning_radius 3: the robot cannot leave start .* heading 180"):
        plan(where, (2.0, 2.0), (8.0, 2.0), start_heading=180.0, **limits)
    with pytest.raises(SettingError, match=r"turning_radius 3: the robot cannot reach goal .* heading 0"):
        plan(where, (8.0, 2.0), (2.0, 2.0), goal_heading=0.0, **limits)
    found = plan(where, (2.0, 2.0), (8.0, 2.0), start_heading=0.0, **limits)
    assert found.length == pytest.approx(6.0, rel=1e-3)


def test_an_end_without_room_is_refused():
    with pytest.raises(
        ScenarioError, match=r"start .* is 0.5 from an obstacle; with a turning radius expected"
    ):
        plan(corridor(3), (5.0, 1.0), (20.0, 2.0), robot_radius=0.5, turning_radius=1.0)


def bent(width=3):
    """Two corridors that meet at a right angle."""
    blocked = np.ones((40, 40), dtype=bool)
    blocked[2 : 2 + width, 2:38] = False
    blocked[2:38, 38 - width : 38] = False
    return GridMap("bent", blocked)


def test_no_curve_means_exit_status_3_with_the_reason(tmp_path, capsys):
    with pytest.raises(NoPathError) as caught:
        plan(bent(), (4.0, 3.0), (36.0, 34.0), robot_radius=0.4, turning_radius=15.0)
    message = str(caught.value)
    assert "no curve with turning_radius 15 was found on 'bent'" in message
    shortest = plan(bent(), (4.0, 3.0), (36.0, 34.0), robot_radius=0.4).length
    said = re.search(r"without a turning radius there is a path of length ([\d.]+)", message)
    assert float(said[1]) == pytest.approx(shortest, rel=1e-5)
    arguments = ["--map", "rooms:0", "--robot-radius", "0.4", "--turning-radius"]
    assert main([*arguments, "16", "--output", str(tmp_path / "path.csv")]) == 3
    assert "no path: no curve with turning_radius 16" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_command_writes_curves(tmp_path, capsys):
    files = [tmp_path / f"path{ending}" for ending in (".csv", ".geojson", ".yaml", ".svg")]
    outputs = [word for file in files for word in ("--output", str(file))]
    limits = ["--turning-radius", "20", "--start-heading", "-45", "--goal-heading", "90", "--budget", "3000"]
    assert main(["--map", "case2", *limits, "--wishes", "curvature=1", *outputs]) == 0
    printed = capsys.readouterr().out
    assert "found by     curve search" in printed
    assert "least radius " in printed
    head, *lines = files[0].read_text().splitlines()
    assert head == "x,y,heading,curvature,direction"
    rows = np.array([list(map(float, line.split(","))) for line in lines])
    assert rows[0, 2] == pytest.approx(-45.0)
    assert rows[-1, 2] == pytest.approx(90.0)
    assert (np.abs(rows[:, 3]) <= 1.0 / 20.0 + 1e-12).all()
    assert set(rows[:, 4]) == {1.0}
    np.testing.assert_array_equal(read_previous(files[0]), rows[:, :2])
    feature = json.loads(files[1].read_text())
    assert feature["geometry"]["coordinates"] == rows[:, :2].tolist()
    assert feature["properties"]["headings"] == rows[:, 2].tolist()
    assert feature["properties"]["turning_radius"] == 20.0
    last = files[2].read_text().splitlines()[-1]
    assert f"z: {math.sin(math.pi / 4.0):.6f}"[:10] in last
    points = files[3].read_text().split('<polyline points="')[1].split('"')[0]
    assert len(points.split()) == len(rows)


def test_a_planner_plans_curves_in_time():
    planner = Planner("rooms:0", robot_radius=0.3, turning_radius=1.0)
    found = planner.plan(goal_heading=0.0)
    assert_drivable(found, 0.3, goal_heading=0.0)
    assert found.curve.turning_radius == 1.0
    began = time.monotonic()
    with contextlib.suppress(NoPathError):  # on a machine that does much else
        assert_drivable(planner.plan(max_seconds=0.15), 0.3)
    assert time.monotonic() - began < LATE
    assert_drivable(planner.with_map("rooms:1").plan(), 0.3)
    with pytest.raises(SettingError, match="turning_radius must lie in"):
        Planner("rooms:0", turning_radius=-1.0)
