"""The workspace of a plan: a box or a polygon that the robot stays in, held against shapely."""

import math

import numpy as np
import pytest
import shapely

from helpers.features import BOX, blocked, collection, feature, read, written
from swarm_gym.errors import ScenarioError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.planning.tasks import read_task
from swarm_gym.planning.workspace import read_workspace
from swarm_gym.scenarios import make_scenario

YARD = [[0, -3], [12, -3], [12, 6], [0, 6]]
L_SHAPE = [[0, -3], [12, -3], [12, 6], [8, 6], [8, 2], [0, 2], [0, -3]]
# The wall leaves the yard below, so the way around that end leads outside.
WALL = feature("LineString", [[5, -4], [5, 4]])


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ((0, -3, 12, 6), shapely.box(0, -3, 12, 6)),
        (np.array([0.0, -3.0, 12.0, 6.0]), shapely.box(0, -3, 12, 6)),
        ("0,-3,12,6", shapely.box(0, -3, 12, 6)),
        (" 0, -3, 1.2e1, 6", shapely.box(0, -3, 12, 6)),
        (YARD, shapely.box(0, -3, 12, 6)),
        (np.array(YARD[::-1]), shapely.box(0, -3, 12, 6)),
        (L_SHAPE, shapely.Polygon(L_SHAPE)),
        (L_SHAPE[:-1], shapely.Polygon(L_SHAPE)),
        (((1, -2), (11, -2), (6, 5.5)), shapely.Polygon(((1, -2), (11, -2), (6, 5.5)))),
    ],
)
def test_what_is_free_is_in_the_workspace(tmp_path, given, expected):
    scenario = read(tmp_path, feature("Polygon", [BOX]), (3.5, 0.0), (7.0, 0.0), workspace=given)
    area, everything = blocked(scenario), shapely.box(*scenario.workspace)
    free = everything.difference(area)
    assert free.symmetric_difference(expected.difference(shapely.Polygon(BOX))).area < 1e-9
    # The frame closes the workspace, and the view of pictures shows it.
    assert everything.contains_properly(expected)
    assert everything.buffer(1e-9).contains(area)


def test_a_workspace_may_be_a_file_with_one_polygon_and_holes(tmp_path, monkeypatch):
    hole = [[9, -1], [10, -1], [10, 1], [9, 1], [9, -1]]
    file = written(tmp_path, collection(feature("Polygon", [L_SHAPE, hole])), "yard.geojson")
    for given in (file, str(file)):
        scenario = read(tmp_path, feature("Polygon", [BOX]), (3.5, 0.0), (7.0, 0.0), workspace=given)
        expected = shapely.Polygon(L_SHAPE, [hole]).difference(shapely.Polygon(BOX))
        free = shapely.box(*scenario.workspace).difference(blocked(scenario))
        assert free.symmetric_difference(expected).area < 1e-9
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    assert read_workspace("yard.geojson").shape == read_workspace(file).shape


def test_obstacles_beyond_the_workspace_are_left_out_and_those_across_its_edge_are_not(tmp_path):
    far = [[[x + 100, y] for x, y in BOX]]
    across = [[[x + 9.5, y] for x, y in BOX]]
    content = collection(feature("Polygon", [BOX]), feature("Polygon", far), feature("Polygon", across))
    scenario = read(tmp_path, content, (3.5, 0.0), (7.0, 0.0), workspace=(0, -3, 12, 6))
    assert len(scenario.obstacles) == 2 + 4
    assert scenario.workspace[2] < 20
    empty = read(tmp_path, collection(), (3.5, 0.0), (7.0, 0.0), workspace=(0, -3, 12, 6))
    assert len(empty.obstacles) == 4


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((0, 0, 0, 5), "workspace x_min,y_min,x_max,y_max: expected finite numbers, x_min < x_max"),
        ("5,0,0,5", "x_min < x_max and y_min < y_max, got [5.0, 0.0, 0.0, 5.0]"),
        ((0, 0, math.nan, 5), "expected finite numbers"),
        (
            (0, 0, 5),
            "workspace: expected x_min,y_min,x_max,y_max, corners of shape (k, 2), or a GeoJSON file",
        ),
        ([[0, 0], [1, 1]], "corners of shape (k, 2)"),
        ([[0, 0], [1, 1], [math.inf, 0]], "corners of shape (k, 2)"),
        ([[0, 0], [1], [2, 0]], "corners of shape (k, 2)"),
        ("0,0,5", "no file 0,0,5"),
        (Ellipsis, "corners of shape (k, 2)"),
        ([[0, 0], [2, 2], [2, 0], [0, 2]], "workspace: expected a polygon whose edges do not cross"),
        ([[0, 0], [1, 1], [2, 2]], "workspace: expected a polygon whose edges do not cross"),
    ],
)
def test_another_value_is_refused(given, message):
    with pytest.raises((SettingError, ScenarioError)) as caught:
        read_workspace(given)
    assert message in str(caught.value)


def test_a_file_with_another_content_is_refused(tmp_path):
    two = collection(feature("Polygon", [BOX]), feature("Point", [1, 1]))
    for content, kinds in ((two, "['Polygon', 'Point']"), (collection(), "[]"), (WALL, "['LineString']")):
        file = written(tmp_path, content, "yard.geojson")
        with pytest.raises(
            ScenarioError, match=r"yard\.geojson: expected one Polygon and nothing else, got"
        ) as caught:
            read_workspace(file)
        assert kinds in str(caught.value)


@pytest.mark.parametrize("workspace", [(0, -3, 12, 6), L_SHAPE])
def test_an_end_outside_of_the_workspace_is_refused(tmp_path, workspace):
    content = feature("Polygon", [BOX])
    for ends, role in ((((-1.0, 0.0), (9.0, 0.0)), "start"), (((9.0, 0.0), (-1.0, 0.0)), "goal")):
        with pytest.raises(ScenarioError, match=rf"{role} \(-1.0, 0.0\) lies outside the workspace"):
            read(tmp_path, content, *ends, workspace=workspace)
    with pytest.raises(
        ScenarioError, match=r"start \(0.5, 0.0\) is 0.5 from the edge of the workspace.*least 0.7"
    ):
        read(tmp_path, content, (0.5, 0.0), (9.0, 0.0), 0.7, workspace=workspace)
    assert read(tmp_path, content, (0.0, 0.0), (9.0, -3.0), workspace=workspace).obstacles
    assert read(tmp_path, content, (0.5, 0.0), (9.0, 0.0), 0.5, workspace=workspace).obstacles


def test_scenarios_by_name_have_a_workspace_too(capsys):
    case = make_scenario("case1")
    task = read_task("case1", None, None, 0.0, case.workspace)
    assert task.given.obstacles[: len(case.obstacles)] == case.obstacles
    assert len(task.given.obstacles) == len(case.obstacles) + 4
    with pytest.raises(ScenarioError, match=r"start .* lies outside the workspace 0,0,10,10"):
        read_task("case1", None, None, 0.0, (0, 0, 10, 10))
    assert main(["--map", "rooms:0", "--workspace", "0,0,10,10"]) == 2
    assert "has cells, and the border of such a map is the workspace" in capsys.readouterr().err


def test_a_path_stays_in_the_yard(tmp_path, capsys):
    file = written(tmp_path, collection(WALL, feature("Polygon", [BOX])))
    command = ["--map", str(file), "--start=1,-2", "--goal=10,-2", "--output", str(tmp_path / "path.csv")]

    def path():
        return shapely.LineString(np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1))

    assert main(command) == 0
    below = math.hypot(4.0, 2.0) + math.hypot(5.0, 2.0)
    assert path().length == pytest.approx(below, rel=1e-6)
    yard = shapely.box(0, -3, 12, 6)
    assert not yard.contains(path())
    assert main([*command, "--workspace=0,-3,12,6"]) == 0
    assert yard.contains(path())
    above = math.hypot(1.0, 3.0) + math.hypot(3.0, 3.0) + math.hypot(5.0, 6.0)
    assert above * (1.0 - 1e-9) <= path().length <= above * 1.002
    assert f"length       {path().length:.6g}" in capsys.readouterr().out


def test_a_robot_does_not_fit_between_wall_and_workspace(tmp_path):
    file = written(tmp_path, feature("LineString", [[5, -4], [5, 4.5]]))
    yard = shapely.box(0, -3, 12, 6)
    found = plan(file, (1.0, 0.0), (10.0, 0.0), robot_radius=0.5, workspace=(0, -3, 12, 6))
    line = shapely.LineString(found.path)
    assert line.distance(yard.exterior) >= 0.5 - 1e-6
    assert line.distance(shapely.LineString([(5, -4), (5, 4.5)])) >= 0.5 - 1e-6
    assert found.clearance == pytest.approx(0.5, abs=5e-3)
