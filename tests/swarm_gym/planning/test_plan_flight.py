"""Planned flights: free by an independent check, anytime, in every file format, and refused with a status."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from helpers.terrain_files import hill, write_asc, write_hgt, write_threats
from oracles.flown_terrain import bilinear, faults, ground_in_degrees
from swarm_gym import plan_flight
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import MissingExtraError, NoPathError, ScenarioError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.planning.flights import planner, search
from swarm_gym.planning.flights.writing import FORMATS, as_kml, as_mission, write_flight
from swarm_gym.scenarios import TerrainScenario, make_scenario
from swarm_gym.scenarios.formats.elevation_files import read_elevation
from swarm_gym.scenarios.formats.geographic import PlaneSystem

pytest.importorskip("pyproj", reason="needs the extra `terrain`")

START, GOAL = (1500.0, 2500.0, 150.0), (4500.0, 4500.0, 120.0)
WEST, EAST = (7.40, 46.50, 150.0), (7.43, 46.51, 150.0)
WALL = (
    (2700, 3400, {"radius": 350}),
    (3600, 3700, {"radius": 250}),
    (3000, 2700, {"radius": 150, "height": 30}),
)
FAST = {"optimizer": "firefly", "max_evaluations": 3000}


@pytest.fixture
def small(monkeypatch):
    """Let episodes be short."""
    monkeypatch.setattr(search, "ITERATIONS", 20)
    monkeypatch.setattr(search, "WAYPOINTS", (8,))


@pytest.fixture
def grid(tmp_path):
    """Return an elevation model in metres and threats between start and goal."""
    return write_asc(tmp_path / "a.asc", hill()), write_threats(tmp_path / "t.geojson", *WALL)


@pytest.fixture
def over_earth(tmp_path):
    """Return a flight over an elevation model in degrees, past two threats."""
    threats = write_threats(
        tmp_path / "t.geojson", (7.412, 46.506, {"radius": 80}), (7.425, 46.504, {"radius": 99, "top": 4000})
    )
    return plan_flight(write_hgt(tmp_path), WEST, EAST, threats=threats)


def test_a_flight_between_threats_is_free_and_longer_time_is_no_worse(grid, small):
    path, threats = grid
    found = plan_flight(path, START, GOAL, threats=threats, **FAST)
    assert faults(found.map, found.waypoints.tolist()) == []
    assert found.found_by == "swarm"
    assert found.evaluations >= 3000
    assert found.passed[0].distance >= found.map.drone_size - 1e-6
    lengths = [one.length for one in found.improvements]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] == found.length >= math.dist(START[:2], GOAL[:2])
    longer = plan_flight(path, START, GOAL, threats=threats, optimizer="firefly", max_evaluations=6000)
    assert longer.length <= found.length
    again = plan_flight(path, START, GOAL, threats=threats, **FAST)
    assert np.array_equal(again.waypoints, found.waypoints)
    assert 100.0 <= found.least_height <= found.greatest_height <= 200.0
    assert found.steepest_climb <= 45.0
    assert found.sharpest_turn <= 45.0


@pytest.mark.parametrize("controller", ["fixed:20,smooth_share=1,amplitude=0.05", "spsfa-tip"])
def test_controllers_with_members_and_sizes_of_their_own_fly(grid, small, controller):
    path, threats = grid
    found = plan_flight(path, START, GOAL, threats=threats, controller=controller, max_evaluations=1000)
    assert faults(found.map, found.waypoints.tolist()) == []
    assert found.evaluations >= 1000


def test_a_budget_that_planning_has_spent_leaves_nothing_to_a_swarm(grid, small):
    path, threats = grid
    found = plan_flight(path, START, GOAL, threats=threats, optimizer="firefly", max_seconds=1e-3)
    assert (found.found_by, found.evaluations) == ("coarse graph", 0)


def test_evaluations_of_the_first_population_count(grid, monkeypatch):
    monkeypatch.setattr(search, "ITERATIONS", 1)
    monkeypatch.setattr(search, "WAYPOINTS", (8,))
    path, threats = grid
    found = plan_flight(path, START, GOAL, threats=threats, optimizer="firefly", max_evaluations=1)
    options = make_controller(search.CONTROLLER).env_options()
    env = SwarmEnv("firefly", scenario=found.map, num_waypoints=8, iterations=1, source="guided", **options)
    assert env.reset(seed=0)[1]["evaluations"] == 60
    assert env.step(np.array([60.0, 0.0]))[4]["evaluations"] == found.evaluations


def test_a_real_elevation_model_is_flown_over(tmp_path, small):
    # Three seconds of arc around Jacksboro, Tennessee: data of the US government, with matplotlib.
    cbook = pytest.importorskip("matplotlib.cbook", reason="needs the extra `train`")
    data = cbook.get_sample_data("jacksboro_fault_dem.npz")
    corner = float(data["xmin"]), float(data["ymax"])  # the names of its ends to the north are swapped
    path = write_asc(tmp_path / "fault.asc", data["elevation"][::-1], float(data["dx"]), corner)
    threats = write_threats(
        tmp_path / "t.geojson",
        (-84.25, 36.59, {"radius": 1200}),
        (-84.22, 36.62, {"radius": 900, "height": 90}),
    )
    start, goal = (-84.33, 36.53, 80.0), (-84.13, 36.66, 80.0)
    limits = {"altitude": (40.0, 120.0), "largest_climb": 20.0, "threats": threats}
    found = plan_flight(path, start, goal, optimizer="firefly", max_evaluations=500, **limits)
    ground = ground_in_degrees(read_elevation(path), -84.23, 36.595)
    assert faults(found.map, found.waypoints.tolist(), 1e-3, ground) == []
    assert found.map.straight_line < found.length < 1.2 * found.map.straight_line
    assert 40.0 <= found.least_height <= found.greatest_height <= 120.0
    write_flight(found, tmp_path / "f.plan")
    items = json.loads((tmp_path / "f.plan").read_text())["mission"]["items"]
    assert items[-1]["params"][4:6] == pytest.approx([36.66, -84.13])


def stripes(folder, cell=30.0):
    """Write an elevation model whose posts are closer to the south than to the east: walls of one post."""
    rasterio = pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    heights = np.full((80, 60), 300.0)
    heights[7::9], heights[:, 11::13] = 330.0, 345.0
    place = rasterio.transform.from_origin(500_000.0, 5_200_000.0, 1.4 * cell, cell)
    shape = {"height": 80, "width": 60, "count": 1, "dtype": "float64", "crs": "EPSG:32632"}
    path = folder / "stripes.tif"
    with rasterio.open(path, "w", driver="GTiff", transform=place, **shape) as file:
        file.write(heights, 1)
    return path


def test_flights_stay_in_the_band_over_posts_that_are_not_square(tmp_path):
    path = stripes(tmp_path)
    start, goal = (500_130.0, 5_198_000.0, 12.0), (502_100.0, 5_199_800.0, 12.0)
    found = plan_flight(path, start, goal, altitude=(10.0, 16.0), largest_climb=80.0)
    posts = read_elevation(path)

    def ground(x, y):
        (first, south), (dx, dy) = posts.origin, posts.spacing
        return bilinear(posts.heights, (x - first) / dx, (y - south) / dy)

    assert faults(found.map, found.waypoints.tolist(), 1e-6, ground) == []
    assert 10.0 <= found.least_height <= found.greatest_height <= 16.0
    sampled = [
        found.map.ground(place) - ground(*place)
        for place in np.random.default_rng(0).uniform(
            (500_130.0, 5_198_000.0), (502_100.0, 5_199_800.0), (2000, 2)
        )
    ]
    assert max(np.abs(sampled)) > 2.0  # the ground of the swarms would not have done


def test_heights_in_degrees_are_those_of_dense_points_over_the_file(tmp_path):
    rng = np.random.default_rng(5)
    heights = np.rint(300.0 + 25.0 * rng.random((60, 60)))
    path = write_asc(tmp_path / "a.asc", heights, 0.0005, (7.0, 46.0))
    start, goal = (7.003, 46.004, 40.0), (7.027, 46.021, 40.0)
    found = plan_flight(path, start, goal, altitude=(30.0, 60.0), largest_climb=70.0)
    ground = ground_in_degrees(read_elevation(path), 7.015, 46.0125)
    assert faults(found.map, found.waypoints.tolist(), 1e-3, ground) == []
    shares = np.linspace(0.0, 1.0, 1500)[:, None]
    legs = zip(found.waypoints[:-1], found.waypoints[1:], strict=True)
    dense = np.vstack([begin + (end - begin) * shares for begin, end in legs])
    above = [z - ground(x, y) for x, y, z in dense.tolist()]
    assert found.least_height == pytest.approx(min(above), abs=1e-2)
    assert found.greatest_height == pytest.approx(max(above), abs=1e-2)
    assert found.least_height <= min(above) + 1e-4
    assert found.greatest_height >= max(above) - 1e-4


@pytest.mark.parametrize("above", [30.0, 60.0])
def test_a_flight_may_begin_and_end_on_posts_at_a_limit_of_the_band(above, tmp_path):
    # In metres a line between cells is a billionth of a metre away from such a start.
    heights = np.rint(300.0 + 10.0 * np.random.default_rng(6).random((60, 60)))
    path = write_asc(tmp_path / "a.asc", heights, 0.0005, (7.0, 46.0))
    for (west, south), (east, north) in (((6, 8), (54, 42)), ((8, 40), (50, 10)), ((10, 12), (10, 45))):
        start, goal = (
            (7.0 + 0.0005 * west, 46.0 + 0.0005 * south),
            (7.0 + 0.0005 * east, 46.0 + 0.0005 * north),
        )
        found = plan_flight(path, (*start, above), (*goal, above), altitude=(30.0, 60.0), largest_climb=60.0)
        assert found.found_by == "straight line"
        middle = 0.5 * (start[0] + goal[0]), 0.5 * (start[1] + goal[1])
        ground = ground_in_degrees(read_elevation(path), *middle)
        assert faults(found.map, found.waypoints.tolist(), 1e-3, ground) == []
        assert found.least_height >= 30.0 - 1e-6
        assert found.greatest_height <= 60.0 + 1e-6


def test_limits_take_the_place_of_those_of_a_scenario():
    scenario = make_scenario("terrain:train:0")
    limits = {"altitude": (90.0, 210.0), "largest_climb": 80.0, "largest_turn": 60.0, "drone_size": 2.0}
    found = plan_flight(scenario, max_evaluations=1, **limits)
    of_map = found.map.band, found.map.largest_climb, found.map.largest_turn, found.map.drone_size
    assert of_map == tuple(limits.values())
    assert found.map.danger_distance == scenario.danger_distance
    with pytest.raises(ScenarioError, match=r"start .* expected the altitude band, 10"):
        plan_flight(scenario, altitude=(10.0, 20.0))
    with pytest.raises(ScenarioError, match="a scenario has its own coordinates; leave it out"):
        plan_flight(scenario, coordinates="plane")


def test_limits_take_the_place_of_those_of_a_file_that_is_named_as_scenario(tmp_path):
    tile = write_hgt(tmp_path)
    name = f"terrain-file:{tile}?start=7.40,46.50,15&goal=7.43,46.51,15"
    with pytest.raises(ScenarioError, match=r"start 7\.4, 46\.5, 15 is 15\.0 metres above ground"):
        plan_flight(name)
    found = plan_flight(name, altitude=(10.0, 20.0), largest_climb=30.0)
    assert (found.map.band, found.map.largest_climb) == ((10.0, 20.0), 30.0)


def test_ctrl_c_before_a_flight_is_no_lack_of_budget(grid, small, capsys, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(search.FlightSearch, "_run", stopped)
    with pytest.raises(KeyboardInterrupt):
        plan_flight(grid[0], START, GOAL, threats=grid[1])
    assert main(command(grid, "--threats", str(grid[1]))) == 130
    assert capsys.readouterr().err == "interrupted before a flight was found or written\n"


def test_where_the_line_is_free_no_swarm_is_needed(grid):
    found = plan_flight(grid[0], START, GOAL)
    assert (found.found_by, found.evaluations) == ("straight line", 0)
    assert faults(found.map, found.waypoints.tolist()) == []


@pytest.mark.slow
def test_flights_over_generated_terrain_have_no_fault():
    # Some of these terrains are so steep that no flight stays in the band, whatever its climb.
    found = 0
    for number in range(0, 56, 5):
        scenario = replace(make_scenario(f"terrain:test:{number}"), largest_climb=75.0)
        try:
            flight = plan_flight(scenario, max_evaluations=20_000)
        except NoPathError:
            continue
        found += 1
        assert faults(flight.map, flight.waypoints.tolist()) == []
    assert found >= 8


def test_a_scenario_has_its_own_ends(grid):
    name = f"terrain-file:{grid[0]}?start=1500,2500,150&goal=4500,4500,120"
    found = plan_flight(name)
    assert found.length == plan_flight(grid[0], START, GOAL).length
    assert plan_flight(make_scenario(name)).length == found.length
    with pytest.raises(ScenarioError, match="a scenario has its own start"):
        plan_flight(name, START, GOAL)
    with pytest.raises(ScenarioError, match=r"plan it with swarm_gym\.plan_flight"):
        plan(name)
    with pytest.raises(ScenarioError, match="expected terrain to fly over"):
        plan_flight("case1")
    with pytest.raises(ScenarioError, match="a file needs a start and a goal"):
        plan_flight(grid[0], START)


def test_csv_has_heights_above_the_sea_and_the_ground(over_earth, tmp_path):
    write_flight(over_earth, tmp_path / "f.csv")
    table = np.loadtxt(tmp_path / "f.csv", delimiter=",", skiprows=1)
    assert (tmp_path / "f.csv").read_text().startswith("x,y,z,above_ground\n")
    assert table[[0, -1], :2] == pytest.approx(np.array([WEST[:2], EAST[:2]]), abs=1e-9)
    assert table[[0, -1], 3] == pytest.approx([150.0, 150.0], abs=2e-3)
    assert table[:, :3] == pytest.approx(over_earth.path, abs=1e-3)


def test_geojson_has_positions_with_heights(over_earth, tmp_path):
    write_flight(over_earth, tmp_path / "f.geojson")
    feature = json.loads((tmp_path / "f.geojson").read_text())
    assert feature["geometry"]["type"] == "LineString"
    positions = np.array(feature["geometry"]["coordinates"])
    assert positions[[0, -1]] == pytest.approx(over_earth.in_degrees[[0, -1]])
    for place in over_earth.in_degrees:  # positions between waypoints keep the line straight in metres
        assert np.abs(positions - place).max(axis=1).min() < 1e-9
    assert feature["properties"]["length"] == over_earth.length


def test_kml_is_a_line_above_the_sea_and_rings(over_earth, tmp_path):
    write_flight(over_earth, tmp_path / "f.kml")
    root = ElementTree.parse(tmp_path / "f.kml").getroot()
    space = {"k": "http://www.opengis.net/kml/2.2"}
    assert root.tag == "{http://www.opengis.net/kml/2.2}kml"
    (line,) = root.findall(".//k:LineString", space)
    assert line.find("k:altitudeMode", space).text == "absolute"
    positions = [list(map(float, word.split(","))) for word in line.find("k:coordinates", space).text.split()]
    assert np.array(positions) == pytest.approx(over_earth.in_degrees, abs=1e-3)
    rings = root.findall(".//k:LinearRing/k:coordinates", space)
    assert len(rings) == 2
    assert all(ring.text.split()[0] == ring.text.split()[-1] for ring in rings)


NUMBER, POSITIVE = {"type": "number"}, {"type": "number", "exclusiveMinimum": 0}
PLACE = {"type": "array", "items": NUMBER}
# "Plan File Format" in the developer guide of QGroundControl, as far as files of waypoints and circles go.
PLAN = {
    "type": "object",
    "required": ["fileType", "groundStation", "mission", "version", "geoFence", "rallyPoints"],
    "additionalProperties": False,
    "properties": {
        "fileType": {"const": "Plan"},
        "groundStation": {"type": "string"},
        "version": {"const": 1},
        "rallyPoints": {"const": {"points": [], "version": 2}},
        "geoFence": {
            "type": "object",
            "required": ["circles", "polygons", "version"],
            "properties": {
                "version": {"const": 2},
                "polygons": {"const": []},
                "circles": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "required": ["circle", "inclusion", "version"],
                        "properties": {
                            "circle": {
                                "type": "object",
                                "required": ["center", "radius"],
                                "properties": {
                                    "center": {**PLACE, "minItems": 2, "maxItems": 2},
                                    "radius": POSITIVE,
                                },
                            },
                            "inclusion": {"type": "boolean"},
                            "version": {"const": 1},
                        },
                    },
                },
            },
        },
        "mission": {
            "type": "object",
            "required": [
                "cruiseSpeed", "firmwareType", "hoverSpeed", "items", "plannedHomePosition", "vehicleType",
                "version",
            ],
            "properties": {
                "version": {"const": 2},
                "cruiseSpeed": POSITIVE,
                "hoverSpeed": POSITIVE,
                "firmwareType": {"type": "integer"},
                "vehicleType": {"type": "integer"},
                "plannedHomePosition": {**PLACE, "minItems": 3, "maxItems": 3},
                "items": {
                    "type": "array",
                    "minItems": 1,
                    "items": {
                        "type": "object",
                        "required": ["autoContinue", "command", "doJumpId", "frame", "params", "type"],
                        "properties": {
                            "AMSLAltAboveTerrain": {"type": ["number", "null"]},
                            "Altitude": NUMBER,
                            "AltitudeMode": {"enum": [0, 1, 2, 3]},
                            "autoContinue": {"type": "boolean"},
                            "command": {"type": "integer"},
                            "doJumpId": {"type": "integer", "minimum": 1},
                            "frame": {"type": "integer"},
                            "params": {
                                "type": "array",
                                "minItems": 7,
                                "maxItems": 7,
                                "items": {"type": ["number", "null"]},
                            },
                            "type": {"const": "SimpleItem"},
                        },
                    },
                },
            },
        },
    },
}  # fmt: skip


def test_a_mission_has_the_documented_form(over_earth):
    jsonschema = pytest.importorskip("jsonschema", reason="comes with the dependency group `docs`")
    plan = json.loads(as_mission(over_earth))
    jsonschema.validate(plan, PLAN)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**plan, "fileType": "Mission"}, PLAN)


def test_a_mission_has_latitude_before_longitude_and_circles_to_keep_out_of(over_earth):
    plan = json.loads(as_mission(over_earth))
    items = plan["mission"]["items"]
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    places = np.array([[item["params"][5], item["params"][4], item["params"][6]] for item in items])
    assert places == pytest.approx(over_earth.in_degrees, abs=1e-3)
    assert all(item["params"][6] == item["Altitude"] for item in items)
    home = plan["mission"]["plannedHomePosition"]
    assert home[:2] == pytest.approx([WEST[1], WEST[0]])
    assert home[2] == pytest.approx(over_earth.waypoints[0, 2] - 150.0, abs=1e-2)
    circles = plan["geoFence"]["circles"]
    assert [one["circle"]["radius"] for one in circles] == [80.0, 99.0]
    assert circles[0]["circle"]["center"] == pytest.approx([46.506, 7.412])
    assert not any(one["inclusion"] for one in circles)


def test_threats_without_a_place_in_degrees_are_in_no_file(tmp_path):
    path = write_asc(tmp_path / "a.asc", hill(), corner=(501_000.0, 5_152_000.0))
    (tmp_path / "a.prj").write_text("EPSG:32632")
    ends = PlaneSystem("EPSG:32632").to_degrees([(501_500.0, 5_152_500.0), (504_500.0, 5_154_500.0)]).tolist()
    inside = PlaneSystem("EPSG:32632").to_degrees([(502_000.0, 5_154_500.0)])[0].tolist()
    threats = write_threats(tmp_path / "t.geojson", (99.0, 0.0, {"radius": 9}), (*inside, {"radius": 20}))
    with pytest.warns(UserWarning, match="1 of 2 threats do not touch"):
        found = plan_flight(
            path,
            (*ends[0], 150.0),
            (*ends[1], 150.0),
            threats=threats,
            coordinates="longitude-latitude",
            largest_climb=80.0,
        )
    assert len(found.map.threats) == 2
    [circle] = json.loads(as_mission(found))["geoFence"]["circles"]
    assert circle["circle"]["center"] == pytest.approx(inside[::-1], abs=1e-6)
    text = as_kml(found)
    assert text.count("<name>threat") == 1
    assert "inf" not in text


@pytest.mark.parametrize("radius", [400.0, 1e6])
def test_a_threat_that_is_larger_than_the_map_is_drawn_on_the_map_only(radius, tmp_path):
    pillow = pytest.importorskip("PIL.Image", reason="needs the extra `terrain`")
    scenario = TerrainScenario(
        "flat",
        np.zeros((60, 60)),
        (100.0, 110.0, 150.0),
        (500.0, 100.0, 150.0),
        10.0,
        threats=((295.0, 60.0 - radius, math.inf, radius),),
    )
    write_flight(plan_flight(scenario), tmp_path / "f.png")
    picture = np.asarray(pillow.open(tmp_path / "f.png").convert("RGB")).astype(int)
    side = picture.shape[1]  # of the map, which is a square
    in_threat, above, in_profile = (side - 30, side // 2), (side // 2, side // 2), (-3, -3)
    assert picture[in_threat][0] > picture[above][0] + 20  # red
    assert picture[in_profile].tolist() == [255, 255, 255]


def test_pictures_and_pages_are_whole(over_earth, tmp_path):
    pillow = pytest.importorskip("PIL.Image", reason="needs the extra `terrain`")
    write_flight(over_earth, tmp_path / "f.png", tmp_path / "f.html")
    picture = np.asarray(pillow.open(tmp_path / "f.png").convert("RGB")).astype(int)
    assert picture.shape[1] == 900
    flight = np.abs(picture - (0xC2, 0x41, 0x0C)).sum(axis=2) < 60
    assert flight.sum() > 900  # the line on the map, and its profile below
    page = (tmp_path / "f.html").read_text("utf-8")
    assert "{{" not in page
    assert not re.search(r'(?:src|href)="', page)  # it loads nothing
    data = json.loads(re.search(r'type="application/json">(.*?)</script>', page)[1])
    assert len(data["flight"]) == len(over_earth.waypoints)
    assert data["rows"] * data["columns"] == len(data["heights"]) == len(data["colours"])
    assert data["threats"][0][3] is None


def test_missions_need_a_place_on_the_earth(grid, tmp_path):
    found = plan_flight(grid[0], START, GOAL)
    with pytest.raises(SettingError, match="names no coordinate reference system"):
        write_flight(found, tmp_path / "a.csv", tmp_path / "f.plan")
    assert not (tmp_path / "a.csv").exists()
    write_flight(found, tmp_path / "a.geojson")
    content = json.loads((tmp_path / "a.geojson").read_text())
    assert content["geometry"]["coordinates"][0][:2] == [1500.0, 2500.0]


def command(grid, *more):
    return ["--map", str(grid[0]), "--start", "1500,2500,150", "--goal", "4500,4500,120", *more]


def test_the_command_reports_and_writes(grid, small, tmp_path, capsys):
    output = tmp_path / "out" / "f.csv"
    given = ["--threats", str(grid[1]), "--budget", "3000", "--optimizer", "firefly", "--output", str(output)]
    assert main(command(grid, *given)) == 0
    printed = capsys.readouterr().out
    for word in (
        "length",
        "above ground",
        "climb",
        "turn",
        "threat 0",
        "passed at",
        "evaluations",
        "written to",
    ):
        assert word in printed
    assert output.exists()
    below = output / "folder" / "g.csv"
    assert main(command(grid, "--output", str(below))) == 2
    expected = r"error: output '.*g\.csv': '.*f\.csv' is a file, no folder for it\n"
    assert re.fullmatch(expected, capsys.readouterr().err)


@pytest.mark.parametrize(
    ("more", "status", "message"),
    [
        (["--start", "1500,2500"], 2, "expected three numbers x,y,height, got '1500,2500'"),
        (["--altitude", "100"], 2, "expected two heights in metres such as 100..200, got '100'"),
        (["--budget", "fast"], 2, "expected evaluations such as 50000 or seconds"),
        (["--start", "0,0,150"], 2, "error: .*a.asc: start 0, 0 lies outside the map"),
        (["--start", "1500,2500,20"], 2, "error: .*expected the altitude band"),
        (["--altitude", "200..100"], 2, "error: .*lowest < highest"),
        (["--threats", "none.geojson"], 2, "error: no file none.geojson"),
        (
            ["--output", "f.csv", "--output", "f.kml"],
            2,
            r"error: output 'f.kml': .*a.asc names no coordinate",
        ),
        (["--output", "f.doc"], 2, "the name must end with .csv, .geojson, .kml, .plan, .png, .html"),
        (
            ["--max-climb", "0.1", "--budget", "600", "--optimizer", "firefly"],
            3,
            "no flight: no flight found",
        ),
        (["--map", "none.tif"], 2, "error: no file none.tif"),
    ],
)
def test_the_command_ends_with_a_status(grid, small, capsys, more, status, message):
    try:
        ended = main(command(grid, *more))
    except SystemExit as error:
        ended = error.code
    assert ended == status
    assert re.search(message, capsys.readouterr().err)


@pytest.mark.slow
def test_the_page_shows_what_the_command_prints(capsys):
    page = (Path(__file__).parents[3] / "docs" / "flights.md").read_text(encoding="utf-8")
    shown = re.search(r"--map (terrain:test:\d) --budget (\d+)\n```\n\n```\n(.*?)```", page, re.DOTALL)
    assert main(["--map", shown[1], "--budget", shown[2]]) == 0
    assert capsys.readouterr().out.startswith(shown[3])


def test_a_warning_is_a_line(tmp_path, capsys):
    rasterio = pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    place = rasterio.transform.from_origin(500_000.0, 5_200_000.0, 50.0, 50.0)
    shape = {"height": 61, "width": 81, "count": 2, "dtype": "float64", "crs": "EPSG:32632"}
    with rasterio.open(tmp_path / "two.tif", "w", driver="GTiff", transform=place, **shape) as file:
        file.write(np.stack([hill(), hill()]))
    ends = ["--start", "500500,5198500,150", "--goal", "503500,5198500,150"]
    assert main(["--map", str(tmp_path / "two.tif"), *ends]) == 0
    assert re.fullmatch(r"warning: .*two\.tif: 2 bands, of which .*\n", capsys.readouterr().err)


def test_ctrl_c_while_a_map_is_read_is_a_line(grid, capsys, monkeypatch):
    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(planner, "survey", stopped)
    assert main(command(grid)) == 130
    assert capsys.readouterr().err == "interrupted before a flight was found or written\n"


def test_help_is_that_of_flights_over_an_elevation_model(capsys):
    with pytest.raises(SystemExit):
        main(["--map=dem.tif", "--help"])
    assert "--altitude LEAST..GREATEST" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "--map dem.tif --help" in capsys.readouterr().out


def test_no_flight_is_found_where_limits_leave_none(grid, small):
    with pytest.raises(NoPathError, match=r"no flight found over 'a' with .* each route needs a climb of"):
        plan_flight(grid[0], START, GOAL, largest_climb=0.1, **FAST)


def test_a_picture_needs_pillow_before_anything_is_planned(grid, tmp_path, monkeypatch):
    import sys

    from swarm_gym.planning.flights.writing import require_formats

    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises((MissingExtraError, ValueError)):
        require_formats([tmp_path / "f.png"])
    assert set(FORMATS) == {".csv", ".geojson", ".kml", ".plan", ".png", ".html"}
