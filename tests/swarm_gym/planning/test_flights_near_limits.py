"""Flights that nearly break a limit: ends at tops, waypoints at corners of cells, metres of other systems."""

import json
import math
import warnings
from itertools import pairwise

import numpy as np
import pytest

from helpers.terrain_files import write_asc, write_threats
from swarm_gym import plan_flight
from swarm_gym.errors import ScenarioError
from swarm_gym.plan import main
from swarm_gym.planning.flights import search
from swarm_gym.planning.flights.writing import as_csv, as_geojson, as_mission
from swarm_gym.scenarios.formats.elevation_files import read_elevation

pyproj = pytest.importorskip("pyproj", reason="needs the extra `terrain`")

SECOND = 1.0 / 3600.0  # degrees


def lone_post(folder, height):
    """Write flat ground in degrees, 500 metres high but for one post."""
    heights = np.full((61, 61), 500.0)
    heights[30, 15] = height
    return write_asc(folder / "a.asc", heights, SECOND, (10.0, 46.0), key="center")


@pytest.mark.parametrize(
    ("post", "above", "top", "is_free"), [(300.0, 200.0, 530.0, False), (700.0, 100.0, 780.0, True)]
)
def test_ends_are_held_against_tops_by_the_ground_of_the_file(post, above, top, is_free, tmp_path):
    # The ground that is sampled for swarms is 36 metres off here.
    start, goal = (10.0 + 15 * SECOND, 46.0 + 30 * SECOND), (10.0 + 45 * SECOND, 46.0 + 30 * SECOND)
    threats = write_threats(tmp_path / "t.geojson", (*start, {"radius": 60, "top": top}))
    given = (lone_post(tmp_path, post), (*start, above), (*goal, 150.0))
    limits = {"altitude": (50.0, 450.0), "largest_climb": 80.0, "threats": threats}
    if not is_free:
        with pytest.raises(ScenarioError, match="lies inside threat 0"):
            plan_flight(*given, **limits)
        return
    found = plan_flight(*given, **limits)
    assert found.waypoints[0, 2] == pytest.approx(post + above)
    ends = found.waypoints[[0, -1], :2]
    assert found.map.ground(ends) == pytest.approx(found.task.ground(ends), abs=1e-9)


def test_ground_that_is_sampled_agrees_with_the_file_at_ends_in_one_cell(tmp_path):
    heights = 500.0 + 300.0 * np.random.default_rng(0).random((31, 31))
    path = write_asc(tmp_path / "a.asc", heights, SECOND, (10.0, 46.0))
    start, goal = (10.0 + 15.2 * SECOND, 46.0 + 15.1 * SECOND), (10.0 + 15.3 * SECOND, 46.0 + 15.4 * SECOND)
    found = plan_flight(path, (*start, 150.0), (*goal, 150.0), largest_climb=89.0)
    ends = found.waypoints[[0, -1], :2]
    assert found.map.ground(ends) == pytest.approx(found.task.ground(ends), abs=1e-9)


def test_a_straight_flight_through_corners_of_cells_has_no_doubled_waypoint_and_no_turn(tmp_path):
    y, x = np.mgrid[0:200, 0:200]
    heights = 500.0 + 3.0 * np.sin(x / 9.0) + 3.0 * np.cos(y / 7.0)
    path = write_asc(tmp_path / "a.asc", heights, 5.0, (600002.5, 5299002.5), key="center")
    for goal_post in ((104, 26), (92, 32), (104, 55), (20, 100)):
        posts = (20, 20), goal_post
        start, goal = ((600002.5 + 5.0 * a, 5299002.5 + 5.0 * b, 40.0) for a, b in posts)
        found = plan_flight(path, start, goal, altitude=(39.0, 41.0), largest_turn=1.0)
        assert found.sharpest_turn < 1e-3
        assert np.hypot(*np.diff(found.waypoints[:, :2], axis=0).T).min() > 1e-6


def test_a_fence_is_no_larger_than_the_threat_and_the_flight_stays_outside_on_the_ground(tmp_path):
    # In Iceland a metre of EPSG:3035 has between 0.983 and 1.017 metres on the ground.
    path = write_asc(tmp_path / "a.asc", np.full((200, 200), 100.0), 90.0, (2_700_000.0, 4_882_000.0))
    (tmp_path / "a.prj").write_text("EPSG:3035")
    threats = write_threats(tmp_path / "t.geojson", (2_709_000.0, 4_891_000.0, {"radius": 3000}))
    ends = (2_703_000.0, 4_891_200.0, 150.0), (2_715_000.0, 4_891_200.0, 150.0)
    found = plan_flight(path, *ends, threats=threats, max_evaluations=5000)
    [fence] = json.loads(as_mission(found))["geoFence"]["circles"]
    assert fence["circle"]["radius"] == pytest.approx(3000.0, abs=0.1)
    (latitude, longitude), globe = fence["circle"]["center"], pyproj.Geod(ellps="WGS84")
    dense = np.vstack([np.linspace(a, b, 500) for a, b in pairwise(found.waypoints)])
    places = found.task.in_degrees(dense[:, :2])
    same = np.ones(len(places))
    away = globe.inv(longitude * same, latitude * same, *places.T)[2]
    assert 3000.0 < away.min() < 3120.0


def test_lines_that_are_straight_in_degrees_stay_near_a_long_flight(tmp_path):
    path = write_asc(tmp_path / "a.asc", np.full((110, 110), 100.0), 0.01, (10.0, 59.5))
    ends = (10.02, 60.0, 150.0), (11.05, 60.0, 150.0)
    found = plan_flight(path, *ends)
    assert len(found.waypoints) == 2
    feature = json.loads(as_geojson(found))
    line = np.array(feature["geometry"]["coordinates"])
    assert len(feature["properties"]["above_ground"]) == len(line) > 20
    dense = np.vstack([np.linspace(a, b, 50) for a, b in pairwise(line[:, :2])])
    x, y = found.task.system.to_metres(dense).T
    (x_0, y_0), (x_1, y_1) = found.waypoints[:, :2]
    aside = np.abs((x - x_0) * (y_1 - y_0) - (y - y_0) * (x_1 - x_0)) / math.hypot(x_1 - x_0, y_1 - y_0)
    assert aside.max() < 0.12
    assert as_csv(found).count("\n") == 3  # a head and the waypoints


def test_a_budget_of_time_that_is_over_begins_no_episode(tmp_path, monkeypatch):
    monkeypatch.setattr(search, "SwarmEnv", None)  # would be called
    path = write_asc(tmp_path / "a.asc", np.full((30, 30), 100.0), 30.0, (0.0, 0.0))
    found = plan_flight(path, (100.0, 100.0, 150.0), (700.0, 700.0, 150.0), max_seconds=1e-3)
    assert (found.found_by, found.evaluations) == ("straight line", 0)


def test_heights_above_the_ellipsoid_get_a_warning(tmp_path):
    path = write_asc(tmp_path / "a.asc", np.full((30, 30), 100.0), SECOND, (10.0, 46.0))
    (tmp_path / "a.prj").write_text("EPSG:4979")
    with pytest.warns(UserWarning, match=r"a\.asc: heights .* are above the ellipsoid"):
        read_elevation(path)
    (tmp_path / "a.prj").write_text("EPSG:4326")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_elevation(path)


def test_a_file_that_is_read_is_not_written(tmp_path, capsys):
    path = write_asc(tmp_path / "a.asc", np.full((30, 30), 100.0), 30.0, (0.0, 0.0))
    threats = write_threats(tmp_path / "t.geojson", (400.0, 300.0, {"radius": 20}))
    before = threats.read_bytes()
    given = ["--map", str(path), "--start", "100,100,150", "--goal", "700,700,150", "--threats", str(threats)]
    again = tmp_path / "folder" / ".." / "t.geojson"
    assert main([*given, "--output", str(again)]) == 2
    assert "this command reads it; name another file" in capsys.readouterr().err
    assert threats.read_bytes() == before
