"""Drivable curves in corridors: alternatives, and steady replanning with a turning radius."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from numba.core import event

from helpers.grids import points_in_obstacles, random_blocks
from oracles import naive_alternatives
from oracles.driven_curves import assert_drivable
from swarm_gym.errors import NoPathError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import Planner, plan
from swarm_gym.planning.corridor_map import CorridorMap
from swarm_gym.planning.corridor_search import shortest_by_corridor
from swarm_gym.planning.corridor_walls import walls_around
from swarm_gym.planning.tasks import read_task
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Scenario

FEW = {"max_evaluations": 2000}
ROBOT = {"robot_radius": 0.4, "turning_radius": 1.5}
WALL = 20  # column of the wall with doors
START, GOAL = (2.0, 20.0), (38.0, 20.0)


def never():
    return False


def wall(*doors, size=3, thick=0):
    """A wall with doors around some rows; the piece between two doors is an obstacle off the border."""
    blocked = np.zeros((41, 41), dtype=bool)
    blocked[:, WALL - thick : WALL + thick + 1] = True
    for row in doors:
        blocked[row - size // 2 : row + size // 2 + 1, WALL - thick : WALL + thick + 1] = False
    return GridScenario("wall", GridMap("wall", blocked), START, GOAL)


def row_at_wall(path):
    return float(np.interp(WALL, path[:, 0], path[:, 1]))


def assert_each_drivable(found, robot_radius, step, **ends):
    assert found.alternatives[0].curve is found.curve
    np.testing.assert_array_equal(found.alternatives[0].path, found.path)
    sums = [one.costs["sum"] for one in found.alternatives]
    assert sums == sorted(sums)
    for one in found.alternatives:
        as_plan = replace(found, curve=one.curve, length=one.length, clearance=one.clearance)
        assert_drivable(as_plan, robot_radius, step=step, **ends)
        assert one.curve.least_radius >= found.curve.turning_radius * (1.0 - 1e-12)
        np.testing.assert_allclose(one.path, one.curve.poses[:, :2], atol=1e-6)


def test_all_doors_of_a_wall_are_driven_through():
    doors = (5, 17, 25, 34)
    found = plan(wall(*doors), alternatives=4, start_heading=90.0, **ROBOT, **FEW)
    assert_each_drivable(found, 0.4, 0.01, start_heading=90.0)
    rows = [row_at_wall(one.path) for one in found.alternatives]
    assert len(rows) == len(doors)
    assert all(abs(row - door) < 1.2 for row, door in zip(sorted(rows), doors, strict=True))
    assert found.undrivable == ()


def test_the_best_curve_is_the_one_without_alternatives():
    alone, first = (plan(wall(9, 24), alternatives=number, **ROBOT, **FEW) for number in (1, 2))
    np.testing.assert_array_equal(alone.path, first.path)
    assert alone.alternatives == ()
    assert len(first.alternatives) == 2


def bent():
    """Two ways through a thick wall: a straight one, and a narrow one that bends twice."""
    scenario = wall(14, thick=4, size=5)
    blocked = scenario.map.blocked.copy()
    blocked[23:25, 16:21] = blocked[23:32, 19:21] = blocked[30:32, 19:25] = False
    return GridScenario("bent", GridMap("bent", blocked), START, GOAL)


def command_of(scenario, folder, turning_radius):
    """Write a map as one of Moving AI; return arguments of the command."""
    file = folder / "drawn.map"
    rows = ["".join("@" if cell else "." for cell in row) for row in scenario.map.blocked]
    file.write_text("\n".join(["type octile", "height 41", "width 41", "map", *rows, ""]))
    ends = ["--map", str(file), "--start", "2,20", "--goal", "38,20", "--budget", "2000"]
    return [*ends, "--robot-radius", "0.4", "--turning-radius", turning_radius]


def test_a_corridor_without_a_curve_is_named(capsys, tmp_path):
    found = plan(bent(), alternatives=2, robot_radius=0.4, turning_radius=1.0, **FEW)
    assert len(found.alternatives) == 2
    found = plan(bent(), alternatives=2, robot_radius=0.4, turning_radius=8.0, **FEW)
    assert len(found.alternatives) == 1
    assert abs(row_at_wall(found.path) - 14.0) < 2.2
    (shut,) = found.undrivable
    np.testing.assert_array_equal(shut[[0, -1]], [START, GOAL])
    assert 22.0 < row_at_wall(shut) < 32.0
    length = float(np.hypot(*np.diff(shut, axis=0).T).sum())
    arguments = command_of(bent(), tmp_path, "8")
    assert main([*arguments, "--alternatives", "2"]) == 0
    printed = capsys.readouterr().out
    assert f"no curve     through another corridor, whose shortest path has length {length:.6g}" in printed


def row_of_circles():
    circles = tuple(Circle(0.0, y, 3.0) for y in (-8.0, 0.0, 8.0))
    return Scenario("row", (-20.0, 1.0), (20.0, 1.5), circles, (-25.0, -25.0, 25.0, 25.0))


def test_the_gaps_between_circles_are_all_driven_through():
    found = plan(
        row_of_circles(), alternatives=4, robot_radius=0.5, turning_radius=4.0, goal_heading=90.0, **FEW
    )
    assert_each_drivable(found, 0.5, 0.02, goal_heading=90.0)
    heights = sorted(float(np.interp(0.0, *one.path.T)) for one in found.alternatives)
    gaps = ((-math.inf, -11.0), (-5.0, -3.0), (3.0, 5.0), (11.0, math.inf))
    assert len(heights) == len(gaps)
    assert all(low < height < high for height, (low, high) in zip(heights, gaps, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize(
    ("where", "radius", "turning_radius", "step"),
    [("rooms:0", 0.3, 1.0, 0.005), ("rooms:1", 0.0, 1.0, 0.005), ("caves:3", 0.4, 2.5, 0.005)],
)
def test_alternatives_on_generated_maps_are_drivable_and_apart(where, radius, turning_radius, step, reverse):
    found = plan(where, robot_radius=radius, turning_radius=turning_radius, alternatives=4, reverse=reverse)
    assert len(found.alternatives) == 4
    assert_each_drivable(found, radius, step, reverses=reverse)
    posts = points_in_obstacles(found.map)
    for one, other in itertools.combinations(found.alternatives, 2):
        assert any(naive_alternatives.sides_between(one.path, other.path, posts))


@pytest.mark.slow
def test_all_ways_through_a_lattice_of_corridors_are_driven():
    blocked = np.zeros((40, 40), dtype=bool)
    for row, column in itertools.product((4, 22), (4, 22)):
        blocked[row : row + 14, column : column + 14] = True
    scenario = GridScenario("streets", GridMap("streets", blocked), (1.0, 19.5), (38.0, 19.5))
    posts = points_in_obstacles(scenario)
    expected = [one.path for one in plan(scenario, alternatives=9).alternatives]
    found = plan(scenario, alternatives=9, robot_radius=0.3, turning_radius=1.0)
    assert_each_drivable(found, 0.3, 0.01)
    sides = [
        {naive_alternatives.sides_between(path, expected[0], posts) for path in paths}
        for paths in (expected, [one.path for one in found.alternatives])
    ]
    assert len(sides[0]) == 9
    assert sides[0] == sides[1]


@pytest.mark.parametrize("seed", range(8))
def test_walls_leave_the_sides_of_one_path(seed):
    """A path that meets no wall passes all obstacles as the path does for which the walls stand."""
    rng = np.random.default_rng(seed)
    blocked = random_blocks(rng, 14, 18, 4)
    scenario = GridScenario("small", GridMap("small", blocked), (0.0, 6.0), (17.0, 7.0))
    corridors = CorridorMap(read_task(scenario, None, None, 0.0))
    paths = list(itertools.islice(shortest_by_corridor(scenario, never), 12))
    assert len(paths) > 3
    posts, met = points_in_obstacles(scenario), 0
    for path in paths:
        walls = walls_around(corridors, path)
        if walls is None:  # the path comes back to one of its cells
            continue
        lines = [shapely.LineString(ends) for ends in walls.segments.reshape(-1, 2, 2)]
        assert not any(shapely.LineString(path).crosses(line) for line in lines)
        for other in paths:
            if any(naive_alternatives.sides_between(path, other, posts)):
                assert shapely.LineString(other).distance(shapely.MultiLineString(lines)) == 0.0
                met += 1
    assert met > 10


def test_a_path_that_winds_around_an_obstacle_has_no_walls():
    scenario = wall(9, 24)
    corridors = CorridorMap(read_task(scenario, None, None, 0.0))
    around = np.array([START, (20.0, 24.0), (30.0, 17.0), (20.0, 9.0), (10.0, 17.0), (20.0, 24.0), GOAL])
    assert walls_around(corridors, around) is None
    assert walls_around(corridors, around[[0, 1, -1]]) is not None


def test_a_corridor_is_kept_while_another_one_is_little_better():
    before = plan(wall(13, 29), **ROBOT, **FEW)
    assert row_at_wall(before.path) < 20.0
    changed = wall(13, 26)  # the other door is a little nearer now
    best = plan(changed, **ROBOT, **FEW)
    assert row_at_wall(best.path) > 20.0
    steady = plan(changed, previous=before.path, switch_margin=0.1, **ROBOT, **FEW)
    assert row_at_wall(steady.path) < 20.0
    assert (steady.found_by, steady.switched) == ("previous corridor", False)
    assert_drivable(steady, 0.4, step=0.01)
    assert best.costs["sum"] < steady.costs["sum"] <= best.costs["sum"] / 0.9
    gain = 1.0 - best.costs["sum"] / steady.costs["sum"]
    for margin, is_kept in ((0.0, False), (gain * 0.99, False), (gain * 1.01, True), (1.0, True)):
        found = plan(changed, previous=before.path, switch_margin=margin, **ROBOT, **FEW)
        assert found.switched is not is_kept
    both = plan(changed, previous=before.path, switch_margin=0.1, alternatives=2, **ROBOT, **FEW)
    np.testing.assert_array_equal(both.path, steady.path)
    assert [one.costs["sum"] for one in both.alternatives] == [steady.costs["sum"], best.costs["sum"]]


def test_a_corridor_that_is_closed_is_left():
    before = plan(wall(13, 29), **ROBOT, **FEW)
    after = plan(wall(29), previous=before.path, switch_margin=1.0, **ROBOT, **FEW)
    assert row_at_wall(after.path) > 20.0
    assert_drivable(after, 0.4, step=0.01)


def test_a_curve_does_not_flip_where_an_obstacle_trembles():
    def with_circle(y):
        return Scenario("circle", (0.0, 0.0), (20.0, 0.0), (Circle(10.0, y, 4.0),), (-5.0, -10.0, 25.0, 10.0))

    def below(found):
        return bool(np.interp(10.0, *found.path.T) < 0.0)

    limits = {"robot_radius": 0.5, "turning_radius": 2.0, "max_evaluations": 1000}
    first = plan(with_circle(0.1), **limits)
    assert below(first)
    path, sides = first.path, {0.05: [], 0.0: []}
    for y in (-0.1, 0.1, -0.2, 0.05, -0.1):
        for margin, seen in sides.items():
            found = plan(with_circle(y), previous=path, switch_margin=margin, **limits)
            seen.append(below(found))
            assert_drivable(found, 0.5, step=0.02)
            if margin > 0.0:
                path = found.path
    assert sides[0.05] == [True] * 5
    assert sides[0.0] == [False, True, False, True, False]


def test_a_previous_path_must_fit():
    with pytest.raises(SettingError, match="previous: expected a path that ends at"):
        plan(wall(13, 29), previous=[START, (20.0, 13.0)], **ROBOT)


def test_a_planner_keeps_the_corridor_of_a_curve_without_compiling():
    planner = Planner(wall(13, 29), **ROBOT)
    with event.install_recorder("numba:compile") as recorder:
        before = planner.plan(alternatives=2, **FEW)
        other = before.alternatives[1]
        here = tuple(other.path[len(other.path) // 5].tolist())
        heading = float(other.curve.poses[len(other.path) // 5, 2])
        found = planner.plan(here, GOAL, previous=other.path, start_heading=heading, **FEW)
    assert recorder.buffer == []
    assert row_at_wall(found.path) == pytest.approx(row_at_wall(other.path), abs=0.5)
    assert found.switched is False
    assert_drivable(found, 0.4, heading, step=0.01)
    try:
        timed = planner.plan(alternatives=2, max_seconds=0.4)
    except NoPathError:  # on a machine that does much else
        return
    assert_drivable(timed, 0.4, step=0.01)


def test_the_command_writes_all_curves(tmp_path, capsys):
    files = [tmp_path / name for name in ("way.csv", "way.geojson", "way.yaml")]
    outputs = [text for file in files for text in ("--output", str(file))]
    arguments = command_of(wall(13, 29), tmp_path, "1.5")
    assert main([*arguments, "--alternatives", "2", *outputs]) == 0
    found = plan(wall(13, 29), alternatives=2, **ROBOT, **FEW)
    for one, name in zip(found.alternatives, ("way.csv", "way-2.csv"), strict=True):
        lines = (tmp_path / name).read_text().splitlines()[1:]
        rows = np.array([list(map(float, line.split(","))) for line in lines])
        np.testing.assert_array_equal(rows, np.column_stack([one.path, one.curve.poses[:, 2:]]))
    features = json.loads((tmp_path / "way.geojson").read_text())["features"]
    for one, feature in zip(found.alternatives, features, strict=True):
        assert feature["properties"]["headings"] == one.curve.poses[:, 2].tolist()
        assert feature["properties"]["cost_sum"] == one.costs["sum"]
    assert "path 2       length" in capsys.readouterr().out
    # The other curve is the previous one: the command reads its file, and stays in its corridor.
    previous = ["--previous", str(tmp_path / "way-2.csv"), "--switch-margin", "0.9"]
    assert main([*arguments, *previous]) == 0
    assert "corridor     that of the previous path" in capsys.readouterr().out
