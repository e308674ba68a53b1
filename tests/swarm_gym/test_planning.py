"""Planning: free paths from a map, a start and a goal, checked by shapely, not by the package's own tests."""

import json
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely

import swarm_gym
from helpers.plans import assert_free, obstacles_of
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import NoPathError, ScenarioError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan, search, tasks
from swarm_gym.planning.drawing import GOAL, OBSTACLE, PAPER, PATH, START
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, Polygon, Scenario

L_SHAPE = [[2, 1], [8, 1], [8, 3], [4, 3], [4, 9], [2, 9], [2, 1]]
FIELD = {
    "type": "FeatureCollection",
    "features": [
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [L_SHAPE]}},
        {"type": "Feature", "geometry": {"type": "Point", "coordinates": [1, 1]}},
        {
            "type": "Feature",
            "geometry": {"type": "MultiPolygon", "coordinates": [[[[10, 4], [12, 4], [11, 8], [10, 4]]]]},
        },
    ],
}


@pytest.mark.parametrize(
    ("name", "radius"),
    slow_but(
        [("case2", 0.0), ("random-fields:test:5", 12.0)],
        [(name, radius) for name in ("case2", "case3", "random-fields:test:5") for radius in (0.0, 12.0)],
    ),
)
def test_paths_among_obstacles_are_free_and_short(name, radius):
    found = plan(name, robot_radius=radius / 2, clearance=radius / 2, seed=1, planner="swarm")
    assert_free(found, radius)
    assert found.gap < (0.06 if radius == 0.0 else 0.6)
    assert found.found_by.startswith("swarm")
    assert found.evaluations > 1000


@pytest.mark.parametrize("name", ["rooms:0", "caves:1"])
def test_paths_on_grids_are_free(name):
    assert_free(plan(name, planner="swarm"))


def test_the_robots_radius_counts_on_grids():
    assert_free(plan("rooms:0", robot_radius=0.4, planner="swarm"), 0.4)


def test_the_same_seed_gives_the_same_path_and_more_budget_no_longer_one():
    options = {"seed": 3, "planner": "swarm", "max_evaluations": 2000}
    first, again = (plan("case2", **options) for _ in range(2))
    np.testing.assert_array_equal(first.path, again.path)
    more = plan("case2", **{**options, "max_evaluations": 2 * first.evaluations})
    assert more.evaluations >= 2 * first.evaluations
    assert more.length <= first.length
    other = swarm_gym.plan("case2", optimizer="particle-swarm", controller="fixed:40", **options)
    assert_free(other)


def _ticking(monkeypatch):
    """Let every look at the clock take 0.01 seconds."""
    ticks = iter(np.arange(0.0, 10000.0, 0.01))
    monkeypatch.setattr(search.time, "monotonic", lambda: next(ticks))


def test_seconds_end_an_episode_in_its_middle(monkeypatch):
    _ticking(monkeypatch)
    found = plan("case1", max_seconds=0.2, planner="swarm")
    assert found.evaluations < plan("case1", planner="swarm").evaluations
    assert_free(found)


@pytest.mark.parametrize("name", slow_but(["case3"], ["case3", "rooms:0"]))
def test_more_seconds_never_give_a_longer_path(monkeypatch, name):
    lengths = []
    for seconds in (0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0):
        _ticking(monkeypatch)
        found = plan(name, max_seconds=seconds, planner="swarm")
        assert [step.length for step in found.improvements] == sorted(
            (step.length for step in found.improvements), reverse=True
        )
        lengths.append(found.length)
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < lengths[0]


@pytest.mark.parametrize(
    "name",
    slow_but(
        ["case3", "random-fields:test:5", "rooms:0"],
        ["case1", "case2", "case3", "random-fields:test:5", "rooms:0", "caves:1"],
    ),
)
def test_the_exact_path_is_the_result_where_it_is_quick(name):
    found = plan(name, max_seconds=0.1)
    assert_free(found)
    assert found.found_by == "exact planner"
    assert found.evaluations == 0
    assert -1e-12 <= found.gap < 1e-4
    swarm = plan(name, max_evaluations=1, planner="swarm")
    assert found.length <= swarm.length * (1.0 + 1e-4)
    both = plan(name, max_evaluations=1, optimizer="particle-swarm")
    assert both.evaluations > 0
    assert both.length <= found.length


def test_ctrl_c_gives_the_best_path_so_far(monkeypatch):
    steps, step = iter(range(100)), SwarmEnv.step

    def interrupted(env, action):
        if next(steps) == 40:
            raise KeyboardInterrupt
        return step(env, action)

    monkeypatch.setattr(SwarmEnv, "step", interrupted)
    found = plan("case3", planner="swarm")
    assert found.stopped
    assert_free(found)


def test_polygons_of_geojson_are_obstacles_convex_or_not(tmp_path):
    file = tmp_path / "field.geojson"
    file.write_text(json.dumps(FIELD))
    found = plan(file, (0.0, 5.0), (14.0, 5.0), clearance=0.3)
    area = shapely.union_all([shapely.Polygon(L_SHAPE), shapely.Polygon([[10, 4], [12, 4], [11, 8]])])
    assert shapely.LineString(found.path).distance(area) >= 0.3 - 1e-6
    assert obstacles_of(found.map).symmetric_difference(area).area < 1e-9
    assert shapely.box(*found.map.workspace).contains(shapely.LineString([(0, 5), (14, 5)]))


def test_files_have_the_path_in_every_format(tmp_path, capsys):
    command = ["--map", "case1", "--seed", "2", "--planner", "swarm", "--budget", "2000", "--output"]
    for ending in ("csv", "geojson", "yaml", "svg"):
        assert main([*command, str(tmp_path / f"path.{ending}")]) == 0
    found = plan("case1", seed=2, planner="swarm", max_evaluations=2000)
    printed = capsys.readouterr().out
    assert f"length       {found.length:.6g}" in printed
    assert "found by     swarm" in printed
    table = np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table, found.path)
    feature = json.loads((tmp_path / "path.geojson").read_text())
    assert feature["geometry"]["coordinates"] == found.path.tolist()
    assert feature["properties"]["length"] == found.length
    yaml = pytest.importorskip("yaml")
    poses = yaml.safe_load((tmp_path / "path.yaml").read_text())["poses"]
    assert [[one["pose"]["position"][k] for k in "xy"] for one in poses] == found.path.tolist()
    for pose, step in zip(poses, np.diff(found.path, axis=0), strict=False):
        turn = pose["pose"]["orientation"]
        assert 2.0 * math.atan2(turn["z"], turn["w"]) == pytest.approx(math.atan2(step[1], step[0]))
    picture = ElementTree.parse(tmp_path / "path.svg").getroot()
    assert picture.tag.endswith("svg")
    assert len(picture.findall(".//{*}polyline")) == 1


def test_a_png_shows_the_map_and_the_path(tmp_path):
    image = pytest.importorskip("PIL.Image")
    file = tmp_path / "wall.map"
    file.write_text("type octile\nheight 3\nwidth 5\nmap\n.....\n..@..\n..@..\n")
    assert (
        main(["--map", str(file), "--start", "0,2", "--goal", "4,2", "--output", str(tmp_path / "a.png")])
        == 0
    )
    with image.open(tmp_path / "a.png") as picture:
        cell = picture.width // 5
        assert picture.size == (5 * cell, 3 * cell)

        def colour(column, row):
            x, y = round((column + 0.5) * cell), round((row + 0.5) * cell)
            return "#{:02x}{:02x}{:02x}".format(*picture.getpixel((x, y)))

        assert colour(0, 2) == START
        assert colour(4, 2) == GOAL
        assert [colour(2, row) for row in (1, 2)] == [OBSTACLE, OBSTACLE]
        assert colour(0, 0) == PAPER
        assert PATH in _colours(picture)


def _colours(picture):
    return {"#{:02x}{:02x}{:02x}".format(*pixel) for _, pixel in picture.getcolors(10**6)}


def test_walls_leave_no_path(tmp_path, capsys):
    rows = ["..@..", "..@..", "..@.."]
    file = tmp_path / "walled.map"
    file.write_text("type octile\nheight 3\nwidth 5\nmap\n" + "\n".join(rows) + "\n")
    assert main(["--map", str(file), "--start", "0,0", "--goal", "4,2"]) == 3
    assert "no path leads from start (0.0, 0.0)" in capsys.readouterr().err
    narrow = tmp_path / "narrow.map"
    narrow.write_text("type octile\nheight 3\nwidth 5\nmap\n..@..\n.....\n..@..\n")
    assert main(["--map", str(narrow), "--start", "0,1", "--goal", "4,1"]) == 0
    assert main(["--map", str(narrow), "--start", "0,1", "--goal", "4,1", "--robot-radius", "0.8"]) == 3
    assert "for a disc of diameter 1.6, twice the robot's radius" in capsys.readouterr().err


RING = tuple(
    Polygon.rectangle(*corners)
    for corners in ((40, 20, 60, 22), (40, 38, 60, 40), (40, 20, 42, 40), (58, 20, 60, 40))
)
CAGED = Scenario("caged", (10.0, 30.0), (50.0, 30.0), RING, (0.0, 0.0, 100.0, 60.0))
OPEN = Scenario("open", (10.0, 30.0), (90.0, 30.0), (Circle(50, 29, 10),), (0.0, 0.0, 100.0, 60.0))


def test_the_exact_planner_stands_in_where_the_swarm_finds_nothing(monkeypatch):
    for options in ({}, {"planner": "swarm"}):
        with pytest.raises(NoPathError, match="separate start and target"):
            plan(CAGED, **options)
    monkeypatch.setattr(search, "final_repair", lambda *_: None)
    with pytest.raises(NoPathError, match="no free path found on 'open'"):
        plan(OPEN, planner="swarm")
    monkeypatch.setattr(tasks, "MOST_OBSTACLES", 0)
    found = plan(OPEN)
    assert found.found_by == "exact planner"
    assert found.evaluations > 0
    assert found.gap is None
    assert found.length == pytest.approx(shortest_path(OPEN)[0], rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--map", "nowhere.yaml", "--start", "0,0", "--goal", "1,1"], "no file nowhere.yaml; searched"),
        (["--map", "case9"], "unknown scenario 'case9'"),
        (["--map", "case1", "--start", "100,250"], "start (100.0, 250.0) lies inside obstacle 0"),
        (["--map", "case1", "--start", "20,300", "--goal", "20,300"], "must be different points"),
        (["--map", "case1", "--robot-radius", "80"], "obstacles have grown by 80"),
        (["--map", "case1", "--robot-radius", "-1"], "robot_radius"),
        (["--map", "case1", "--output", "path.doc"], "the name must end with .csv"),
        (["--map", "case1", "--controller", "mine"], "unknown controller 'mine'"),
        (["--map", "case1", "--optimizer", "bees"], "unknown optimizer 'bees'"),
        (["--map", "function:booth-2"], "planning needs a map"),
        (["--map", "dynamic:case1-gate@50"], "planning needs a map that stays as it is"),
    ],
)
def test_invalid_input_is_refused_with_status_2(arguments, message, capsys):
    assert main(arguments) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "expected GeoJSON"),
        ("[]", "expected GeoJSON objects with a type"),
        ('{"type": "FeatureCollection", "features": []}', "expected at least one polygon"),
        ('{"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]}', "a ring needs at least 4 points"),
        ('{"type": "Polygon", "coordinates": [["a"]]}', "expected rings of points"),
    ],
)
def test_malformed_geojson_is_refused(tmp_path, content, message):
    file = tmp_path / "field.geojson"
    file.write_text(content)
    with pytest.raises(ScenarioError, match=message):
        plan(file, (0.0, 0.0), (1.0, 0.0))


def test_other_values_are_refused():
    with pytest.raises(SettingError, match="max_seconds"):
        plan("case1", max_seconds=-1.0)
    with pytest.raises(SettingError, match="max_evaluations"):
        plan("case1", max_evaluations=0)
    with pytest.raises(ScenarioError, match="a file needs a start and a goal"):
        plan(Path("somewhere.map"))
    with pytest.raises(SystemExit):
        main(["--map", "case1", "--budget", "many"])
    with pytest.raises(SystemExit):
        main(["--map", "case1", "--start", "1;2"])


def test_a_start_may_begin_with_a_minus_sign(tmp_path, capsys):
    walls = {"type": "Polygon", "coordinates": [[[2, 0], [3, 0], [3, 1], [2, 1], [2, 0]]]}
    (tmp_path / "wall.geojson").write_text(json.dumps(walls))
    given = ["--map", str(tmp_path / "wall.geojson"), "--start", "-0.5,0.5", "--goal", "5,-.5"]
    assert main([*given, "--budget", "500"]) == 0
    assert "length" in capsys.readouterr().out
