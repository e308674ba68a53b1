"""Flights over files: threats, degrees and metres, `terrain-file:...`, and every refusal of a bad input."""

import math
import re

import numpy as np
import pytest

from helpers.terrain_files import hill, write_asc, write_hgt, write_threats
from swarm_gym.errors import ScenarioError, SettingError
from swarm_gym.scenarios import TerrainScenario, make_scenario
from swarm_gym.scenarios.formats.elevation_files import read_elevation
from swarm_gym.scenarios.formats.geographic import PlaneSystem
from swarm_gym.scenarios.formats.threat_file import read_threats
from swarm_gym.scenarios.formats.true_lengths import require_true_lengths
from swarm_gym.scenarios.terrain.survey import survey

START, GOAL = (1500.0, 2500.0, 150.0), (4500.0, 4500.0, 120.0)
WEST, EAST = (7.40, 46.50, 150.0), (7.48, 46.52, 150.0)

pytest.importorskip("pyproj", reason="needs the extra `terrain`")


def test_a_grid_of_metres_keeps_its_posts(tmp_path):
    found = survey(write_asc(tmp_path / "a.asc", hill()), START, GOAL)
    scenario = found.scenario
    assert isinstance(scenario, TerrainScenario)
    assert (scenario.start, scenario.goal, scenario.cell) == (START, GOAL, 50.0)
    columns = int((scenario.origin[0] - 1025.0) / 50.0)
    rows = int((scenario.origin[1] - 2025.0) / 50.0)
    height, width = scenario.heights.shape
    assert np.array_equal(scenario.heights, hill()[rows : rows + height, columns : columns + width])
    assert found.for_user(np.array([START[:2]])).tolist() == [list(START[:2])]


def test_degrees_become_metres_and_back(tmp_path):
    found = survey(write_hgt(tmp_path), WEST, EAST)
    scenario = found.scenario
    import pyproj

    *_, metres = pyproj.Geod(ellps="WGS84").inv(*WEST[:2], *EAST[:2])
    assert math.dist(scenario.start[:2], scenario.target) == pytest.approx(metres, rel=1e-6)
    back = found.for_user(np.array([scenario.start[:2], scenario.target]))
    assert back == pytest.approx(np.array([WEST[:2], EAST[:2]]), abs=1e-9)
    # The tile is a plane but for steps of a metre: 1200 metres a degree to the north and 120 to the east.
    expected = 200 + 1200 * (EAST[1] - 46) + 120 * (EAST[0] - 7)
    assert scenario.ground(scenario.target) == pytest.approx(expected, abs=1.5)
    assert scenario.cell < 40.0  # posts are 93 m apart to the north and 64 m to the east


def test_metres_with_a_reference_system_take_degrees(tmp_path):
    import pyproj

    path = write_asc(tmp_path / "a.asc", hill(), corner=(500_000.0, 5_200_000.0))
    (tmp_path / "a.prj").write_text(pyproj.CRS("EPSG:32632").to_wkt())
    to_degrees = pyproj.Transformer.from_crs("EPSG:32632", "EPSG:4326", always_xy=True).transform
    start, goal = to_degrees(500_500.0, 5_200_500.0), to_degrees(503_500.0, 5_202_000.0)
    found = survey(path, (*start, 150.0), (*goal, 150.0), coordinates="longitude-latitude")
    assert found.scenario.start == pytest.approx((500_500.0, 5_200_500.0, 150.0), abs=1e-3)
    assert found.for_user(np.array([found.scenario.target])) == pytest.approx(np.array([goal]), abs=1e-8)


def test_threats_have_tops_above_the_ground_or_the_sea(tmp_path):
    threats = write_threats(
        tmp_path / "t.geojson",
        (2000, 3500, {"radius": 100}),
        (2500, 3500, {"radius": 50.5, "height": 80}),
        (3000, 2400, {"radius": 60, "top": 700, "height": None}),
    )
    scenario = survey(write_asc(tmp_path / "a.asc", hill()), START, GOAL, threats=threats).scenario
    ground = float(scenario.ground((2500.0, 3500.0)))
    expected = [[2000, 3500, math.inf, 100], [2500, 3500, ground + 80, 50.5], [3000, 2400, 700, 60]]
    assert scenario.threats == pytest.approx(np.array(expected))


def test_threats_in_degrees_lie_where_they_are(tmp_path):
    threats = write_threats(tmp_path / "t.geojson", (7.44, 46.51, {"radius": 200}), crs="EPSG:4326")
    found = survey(write_hgt(tmp_path), WEST, EAST, threats=threats)
    assert found.for_user(found.scenario.threats[:, :2]) == pytest.approx(np.array([[7.44, 46.51]]), abs=1e-9)


def test_a_name_stands_for_all_of_a_task(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    write_asc(tmp_path / "a.asc", hill())
    write_threats(tmp_path / "t.geojson", (2000, 3500, {"radius": 100}))
    name = "terrain-file:a.asc?start=1500,2500,150&goal=4500,4500,120"
    scenario = make_scenario(f"{name}&threats=t.geojson&altitude=90-180.5&turn=30&climb=20")
    assert (scenario.band, scenario.largest_turn, scenario.largest_climb) == ((90.0, 180.5), 30.0, 20.0)
    assert len(scenario.threats) == 1
    assert make_scenario(" terrain-file:a.asc ?start=1500, 2500,150&goal=4500,4500,120 ").name == name
    assert make_scenario(name).band == (100.0, 200.0)


def test_spaces_in_the_names_of_files_stay(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    write_asc(tmp_path / "Map, 2020 # 1.asc", hill())
    write_threats(tmp_path / "t, 2.geojson", (2000, 3500, {"radius": 100}))
    options = "start=1500, 2500,150 & goal=4500,4500,120 & threats = t, 2.geojson"
    scenario = make_scenario(f" terrain-file: Map, 2020 # 1.asc ? {options} ")
    assert len(scenario.threats) == 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": (0.0, 0.0, 150.0)}, "start 0, 0 lies outside the map"),
        ({"start": (0.0, 990.0, 150.0)}, "(plane); is it in another system?"),
        ({"goal": (7.1, 46.2, 150.0)}, "for degrees choose coordinates 'longitude-latitude'"),
        ({"goal": (4500.0, 4500.0, math.nan)}, "goal must be x, y and height above ground"),
        ({"start": (1500.0, 2500.0)}, "start must be x, y and height above ground"),
        ({"start": (1500.0, 2500.0, 20.0)}, "expected the altitude band, 100.0 to 200.0"),
        ({"altitude": (200.0, 100.0)}, "lowest < highest"),
        ({"largest_turn": 0.0}, "largest_turn must be a number"),
        ({"coordinates": "longitude-latitude"}, "names no coordinate reference system"),
        ({"threats": ((1500, 2510, {"radius": 100}),)}, "t.geojson: start 1500, 2500, 150 lies inside"),
        ({"threats": ((2000, 3000, {}),)}, "feature 0: a threat without radius; add the property radius"),
        ({"threats": ((2000, 3000, {"radius": 0}),)}, "radius must be positive, in metres, got 0"),
        ({"threats": ((2000, 3000, {"radius": "9"}),)}, "radius must be a number of metres"),
        ({"threats": ((2000, 3000, {"radius": True}),)}, "radius must be a number of metres"),
        ({"threats": ((2000, 3000, {"radius": 9, "height": -1}),)}, "height must be positive"),
        ({"threats": ((2000, 3000, {"radius": 9, "height": 1, "top": 9}),)}, "both height above ground"),
        ({"goal": (*START[:2], 120.0)}, "start and goal must be different points of the map, got 1500, 2500"),
        ({"gaps": [(30, 40)]}, "cells around start and goal have no data, one at 3025, 3525; fill"),
    ],
)  # fmt: skip
def test_a_bad_input_is_refused_by_value(tmp_path, options, message):
    given = {"start": START, "goal": GOAL, **options}
    path = write_asc(tmp_path / "a.asc", hill(), gaps=given.pop("gaps", ()))
    if "threats" in given:
        given["threats"] = write_threats(tmp_path / "t.geojson", *given["threats"])
    with pytest.raises(ScenarioError, match=re.escape(message)):
        survey(path, **given)


def test_coordinates_of_another_kind_are_refused(tmp_path):
    tile = write_hgt(tmp_path)
    with pytest.raises(SettingError, match="coordinates must be one of"):
        survey(tile, WEST, EAST, coordinates="utm")
    with pytest.raises(ScenarioError, match="the map is in longitude and latitude"):
        survey(tile, START, GOAL, coordinates="plane")
    with pytest.raises(ScenarioError, match="expected longitude in"):
        survey(tile, START, GOAL)
    threats = write_threats(tmp_path / "t.geojson", (2000, 3000, {"radius": 9}))
    with pytest.raises(ScenarioError, match=r"feature 0: expected longitude in .*2000, 3000"):
        survey(tile, WEST, EAST, threats=threats)
    threats = write_threats(tmp_path / "t.geojson", (7.44, 46.51, {"radius": 9}), crs="EPSG:32632")
    with pytest.raises(ScenarioError, match=r"'EPSG:32632', expected .* start and goal, longitude-latitude"):
        survey(tile, WEST, EAST, threats=threats)


def utm(folder):
    """Write an elevation model in UTM zone 32N, 500 km to the east and 5150 km to the north of `hill`."""
    import pyproj

    path = write_asc(folder / "a.asc", hill(), corner=(501_000.0, 5_152_000.0))
    (folder / "a.prj").write_text(pyproj.CRS("EPSG:32632").to_wkt())
    return path


ON_UTM = (2000.0 + 500_000.0, 3000.0 + 5_150_000.0, {"radius": 9})  # of a map near 9 degrees east


@pytest.mark.parametrize(
    ("threat", "crs", "message"),
    [
        (ON_UTM, "EPSG:32633", r"names .*'EPSG:32633', expected .*UTM zone 32N; convert"),
        (ON_UTM, "urn:ogc:def:crs:EPSG::3857", r"'EPSG:3857', expected .*UTM zone 32N"),
        (ON_UTM, "EPSG:99999", "unknown coordinate reference system 'EPSG:99999'"),
        (
            (9.03, 46.5, {"radius": 9}),
            "urn:ogc:def:crs:OGC:1.3:CRS84",
            "'OGC:CRS84', expected .*UTM zone 32N",
        ),
        (
            (9.03, 46.5, {"radius": 9}),
            None,
            r"none of its 1 threats touches the map.*at 9.03, 46.5; is it in",
        ),
    ],
)
def test_threats_in_another_system_than_the_map_are_refused(tmp_path, threat, crs, message):
    path = utm(tmp_path)
    start, goal = ((x + 500_000.0, y + 5_150_000.0, z) for x, y, z in (START, GOAL))
    threats = write_threats(tmp_path / "t.geojson", threat, crs=crs)
    with pytest.raises(ScenarioError, match=rf"t\.geojson: .*{message}"):
        survey(path, start, goal, threats=threats)


def test_threats_in_degrees_are_refused_where_the_map_names_no_system(tmp_path):
    path = write_asc(tmp_path / "a.asc", hill())
    threats = write_threats(tmp_path / "t.geojson", (2000, 3000, {"radius": 9}), crs="EPSG:4326")
    with pytest.raises(ScenarioError, match=r"'EPSG:4326', expected .*metres of the map"):
        survey(path, START, GOAL, threats=threats)
    threats = write_threats(tmp_path / "t.geojson", (2000, 3000, {"radius": 9}), crs="EPSG:32632")
    assert len(survey(path, START, GOAL, threats=threats).scenario.threats) == 1


@pytest.mark.parametrize(
    "crs",
    [
        None, "EPSG:32632", "urn:ogc:def:crs:EPSG::32632", "EPSG:25832",
        "urn:ogc:def:crs,crs:EPSG::32632,crs:EPSG::5773",
    ],
)  # fmt: skip
def test_threats_in_the_system_of_the_map_are_where_they_are(tmp_path, crs):
    start, goal = ((x + 500_000.0, y + 5_150_000.0, z) for x, y, z in (START, GOAL))
    far = (9.0, 46.0, {"radius": 9})  # one that is off the map is no fault
    threats = write_threats(tmp_path / "t.geojson", ON_UTM, far, crs=crs)
    with pytest.warns(UserWarning, match="1 of 2 threats do not touch the map, among them feature 1"):
        found = survey(utm(tmp_path), start, goal, threats=threats)
    assert found.scenario.threats[0, :2].tolist() == [502_000.0, 5_153_000.0]
    assert len(found.scenario.threats) == 2


def test_threats_whose_coordinates_are_swapped_are_refused(tmp_path):
    threats = write_threats(tmp_path / "t.geojson", (46.51, 7.44, {"radius": 9}))
    with pytest.raises(ScenarioError, match=r"none of its 1 threats touches the map.*are x and y swapped"):
        survey(write_hgt(tmp_path), WEST, EAST, threats=threats)


@pytest.mark.parametrize(
    ("code", "place", "same"),
    [
        (4258, (7.4, 46.5), True),  # ETRS89
        (4269, (-84.3, 36.5), True),  # NAD83
        (4230, (7.4, 46.5), False),  # ED50: 130 metres off
        (4807, (7.4, 46.5), False),  # grads from Paris
        (4301, (139.4, 35.5), False),  # Tokyo: 500 metres off
    ],
)
def test_a_map_with_other_degrees_than_those_of_wgs_84_is_refused(tmp_path, code, place, same):
    import pyproj

    x, y = place
    path = write_asc(tmp_path / "a.asc", hill(), cell=0.001, corner=place)
    (tmp_path / "a.prj").write_text(pyproj.CRS.from_epsg(code).to_wkt())
    ends = (x + 0.02, y + 0.02, 150.0), (x + 0.05, y + 0.03, 150.0)
    if same:
        assert survey(path, *ends).system is not None
    else:
        with pytest.raises(ScenarioError, match=r"a\.asc: its reference system, .* has other longitudes"):
            survey(path, *ends)


def test_a_system_that_shears_is_refused():
    system = PlaneSystem("EPSG:3035")
    near, far = (np.array(system.to_metres([(x, y), (x + 0.1, y)])) for x, y in ((10, 50), (-16, 28)))
    require_true_lengths("a", system, near)
    with pytest.raises(
        ScenarioError, match=r"a: \d+ metres of its reference system are \d+ metres on the gro"
    ):
        require_true_lengths("a", system, far)


@pytest.mark.parametrize(
    ("start", "goal"),
    [
        ((7.01, 46.003), (7.05, 46.003)),  # 300 metres from the edge
        ((7.95, 46.001), (7.99, 46.001)),
        ((7.0, 46.0), (7.03, 46.02)),  # on the first post
        ((7.97, 46.98), (8.0, 47.0)),  # on the last post
        ((7.5, 46.0), (7.52, 46.0)),  # along the edge
    ],
)
def test_start_and_goal_may_be_anywhere_on_a_map_in_degrees(tmp_path, start, goal):
    found = survey(write_hgt(tmp_path), (*start, 150.0), (*goal, 150.0))
    places = found.for_user(np.array([found.scenario.start[:2], found.scenario.target]))
    assert places == pytest.approx(np.array([start, goal]), abs=1e-9)
    assert np.isfinite(found.ground(np.array([found.scenario.start[:2], found.scenario.target]))).all()


def test_threats_at_the_edge_of_a_map_in_degrees_are_on_it(tmp_path):
    # A parallel bends: the middle of the southern edge lies farther south than its ends.
    threats = write_threats(tmp_path / "t.geojson", (7.5, 46.0005, {"radius": 1}))
    found = survey(write_hgt(tmp_path), WEST, EAST, threats=threats)
    assert len(found.scenario.threats) == 1
    threats = write_threats(tmp_path / "t.geojson", (7.5, 45.999, {"radius": 100}))
    with pytest.raises(ScenarioError, match="none of its 1 threats touches the map"):
        survey(write_hgt(tmp_path), WEST, EAST, threats=threats)
    threats = write_threats(tmp_path / "t.geojson", (7.5, 45.999, {"radius": 120}))  # 111 metres away
    assert len(survey(write_hgt(tmp_path), WEST, EAST, threats=threats).scenario.threats) == 1


def test_a_southern_tile_reaches_its_southern_edge(tmp_path):
    found = survey(write_hgt(tmp_path, "S55W070.hgt"), (-69.53, -54.99, 150.0), (-69.48, -54.985, 150.0))
    south = found.scenario.workspace[1]
    assert np.isfinite(found.ground(np.array([[0.0, south + 1.0]]))).all()
    assert np.isnan(found.ground(np.array([[0.0, south - 1.0]]))).all()


@pytest.mark.parametrize(("x", "y"), [(425231.06, 5226914.24), (520000.3, 5100000.7), (411111.1, 5000000.9)])
def test_start_and_goal_may_be_the_outermost_posts_after_roundings(tmp_path, x, y):
    for k in range(12):
        cell = 10.0 + 0.1 * k
        path = write_asc(tmp_path / "a.asc", hill()[:60, :60], cell, (x, y), key="center")
        last = round(x + 59 * cell, 2), round(y + 59 * cell, 2)
        found = survey(path, (x, y, 150.0), (*last, 150.0))
        assert found.scenario.target == pytest.approx(last, abs=1e-6)


def test_degrees_of_the_edge_of_a_map_in_metres_are_on_it(tmp_path):
    path, system = utm(tmp_path), PlaneSystem("EPSG:32632")
    x_min, y_min, x_max, y_max = read_elevation(path).box
    middle = system.to_degrees([(0.5 * (x_min + x_max), 0.5 * (y_min + y_max))])[0]
    edge = [(x, y) for x in np.linspace(x_min, x_max, 9) for y in (y_min, y_max)]
    edge += [(x, y) for x in (x_min, x_max) for y in np.linspace(y_min, y_max, 9)]
    for place in system.to_degrees(edge).tolist():
        found = survey(path, (*place, 150.0), (*middle, 150.0), coordinates="longitude-latitude")
        assert np.isfinite(found.ground(np.array([found.scenario.start[:2]]))).all()


@pytest.mark.parametrize(
    ("corner", "rows", "columns"),
    [((-20.0, 40.0), 101, 81), ((-180.0, -90.0), 361, 721), ((5.0, 46.0), 9, 21)],
)
def test_a_wide_map_in_degrees_has_ground_all_around_start_and_goal(tmp_path, corner, rows, columns):
    heights = 300.0 + 10.0 * np.random.default_rng(1).random((rows, columns))
    path = write_asc(tmp_path / "a.asc", heights, cell=0.5, corner=corner, key="center")
    (tmp_path / "a.prj").write_text("EPSG:4326")
    found = survey(path, (8.4, 47.7, 150.0), (9.4, 47.8, 150.0))
    x_min, y_min, x_max, y_max = found.scenario.workspace
    start, goal = found.scenario.start[:2], found.scenario.target
    reach = 0.5 * math.dist(start, goal)
    assert x_min == pytest.approx(start[0] - reach)
    assert y_min == pytest.approx(start[1] - reach)
    assert x_max >= goal[0] + reach
    assert y_max >= goal[1] + reach
    corners = [(x_min, y_min), (goal[0] + reach, y_min), (x_min, goal[1] + reach)]
    assert np.isfinite(found.ground(np.array(corners))).all()


def test_a_map_around_the_pole_has_ground_around_it(tmp_path):
    path = write_asc(tmp_path / "a.asc", np.zeros((21, 721)), cell=0.5, corner=(-180.0, 80.0), key="center")
    (tmp_path / "a.prj").write_text("EPSG:4326")
    found = survey(path, (10.0, 89.5, 150.0), (60.0, 89.0, 150.0))
    x_min, y_min, x_max, y_max = found.scenario.workspace
    reach = 0.5 * math.dist(found.scenario.start[:2], found.scenario.target)
    assert x_max - x_min >= 2.0 * reach
    assert y_max - y_min >= 2.0 * reach


@pytest.mark.parametrize(("cell", "away"), [(0.02, 0.002), (0.25, 0.05)])
def test_posts_may_be_wider_than_the_way(tmp_path, cell, away):
    path = write_asc(tmp_path / "a.asc", hill()[:20, :20], cell=cell, corner=(7.0, 46.0))
    (tmp_path / "a.prj").write_text("EPSG:4326")
    middle = 7.0 + 10.3 * cell, 46.0 + 10.4 * cell
    found = survey(path, (*middle, 150.0), (middle[0] + away, middle[1], 150.0))
    assert math.dist(found.scenario.start[:2], found.scenario.target) == pytest.approx(
        away * 111_320 * math.cos(math.radians(middle[1])), rel=1e-2
    )


@pytest.mark.parametrize("dy", [10.0, 11.0])
def test_a_task_of_too_many_posts_is_refused_by_its_file(tmp_path, dy):
    head = f"ncols 9000\nnrows 3\nxllcorner 0\nyllcorner 0\ndx 10\ndy {dy}\n"
    path = tmp_path / "a.asc"
    path.write_text(head + "5 " * 27_000)
    with pytest.raises(ScenarioError, match=r"a\.asc: 9000 x \d heights around .*, expected at most 8192"):
        survey(path, (50.0, 15.0, 150.0), (89_900.0, 15.0, 150.0))


def test_a_map_that_reaches_beyond_180_degrees_is_one_map(tmp_path):
    heights = np.arange(60.0)[:, None] + 2.0 * np.arange(80.0)
    path = write_asc(tmp_path / "a.asc", heights, cell=0.002, corner=(179.899, -17.101))
    (tmp_path / "a.prj").write_text("EPSG:4326")
    found = survey(path, (179.95, -17.05, 150.0), (179.999, -17.02, 150.0))
    column, row = (180.01 - 179.9) / 0.002, (-17.04 + 17.1) / 0.002
    beyond = found.system.to_metres([(180.01 - 360.0, -17.04)])
    assert found.ground(beyond) == pytest.approx([row + 2.0 * column], abs=1e-3)
    threats = write_threats(tmp_path / "t.geojson", (180.01 - 360.0, -17.04, {"radius": 9, "height": 100}))
    found = survey(path, (179.95, -17.05, 150.0), (179.999, -17.02, 150.0), threats=threats)
    assert found.scenario.threats[0, 2] == pytest.approx(100.0 + row + 2.0 * column, abs=1e-3)


def test_threats_that_the_system_of_a_map_does_not_reach_are_off_the_map(tmp_path):
    path = utm(tmp_path)
    inside = PlaneSystem("EPSG:32632").to_degrees([ON_UTM[:2]])[0].tolist()
    threats = write_threats(tmp_path / "t.geojson", (*inside, ON_UTM[2]), (99.5, 0.0, {"radius": 9}))
    ends = PlaneSystem("EPSG:32632").to_degrees([(501_500.0, 5_152_500.0), (504_500.0, 5_154_500.0)]).tolist()
    with pytest.warns(UserWarning, match="1 of 2 threats do not touch"):
        found = survey(
            path, (*ends[0], 150.0), (*ends[1], 150.0), threats=threats, coordinates="longitude-latitude"
        )
    assert found.scenario.threats[0, :2] == pytest.approx(ON_UTM[:2], abs=1e-3)


@pytest.mark.parametrize(("code", "words"), [(3857, r"3000 metres .* are \d+ metres"), (3395, "to UTM")])
def test_a_map_whose_metres_are_longer_than_metres_is_refused(tmp_path, code, words):
    import pyproj

    corner = {3857: (820_000.0, 5_860_000.0), 3395: (820_000.0, 5_830_000.0)}[code]
    path = write_asc(tmp_path / "a.asc", hill(), corner=corner)
    (tmp_path / "a.prj").write_text(pyproj.CRS.from_epsg(code).to_wkt())
    (x, y) = corner
    with pytest.raises(ScenarioError, match=words):
        survey(path, (x + 500.0, y + 500.0, 150.0), (x + 3500.0, y + 500.0, 150.0))


def test_heights_that_stand_for_no_data_are_refused(tmp_path):
    path = write_asc(tmp_path / "a.asc", hill(), gaps=[(30, 40)])
    path.write_text(path.read_text().replace("NODATA_value -9999", "NODATA_value -1"))
    with pytest.raises(ScenarioError, match=r"a\.asc: 1 of .* no land has, -9999 metres at 3025, 3525"):
        survey(path, START, GOAL)


def test_messages_have_the_coordinates_that_were_given(tmp_path):
    threats = write_threats(tmp_path / "t.geojson", (7.4005, 46.5, {"radius": 99}))
    with pytest.raises(ScenarioError, match=r"t\.geojson: start 7\.4, 46\.5, 150 lies inside threat 0"):
        survey(write_hgt(tmp_path), WEST, EAST, threats=threats)
    gap = round(0.505 * 1200), round(0.42 * 1200)  # row and column
    with pytest.raises(ScenarioError, match=r"have no data, one at 7\.4[12]\d*, 46\.50\d*;"):
        survey(write_hgt(tmp_path, gap=gap), WEST, EAST)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "expected GeoJSON"),
        ("[]", "expected a FeatureCollection"),
        ('{"type": "Feature"}', "expected a FeatureCollection"),
        ('{"type": "FeatureCollection", "features": [3]}', "feature 0: expected a Point"),
        (
            '{"type": "FeatureCollection", "features": [{"geometry": {"type": "LineString"}}]}',
            "feature 0: expected a Point with a radius as threat, got 'LineString'",
        ),
        (
            '{"type": "FeatureCollection", "features": [{"geometry": {"type": "Point", "coordinates": [1]}}'
            "]}",
            "feature 0: expected coordinates [x, y], got [1]",
        ),
    ],
)
def test_a_malformed_file_of_threats_is_refused(tmp_path, content, message):
    path = tmp_path / "t.geojson"
    path.write_text(content)
    with pytest.raises(ScenarioError, match=re.escape(message)):
        read_threats(path)


@pytest.mark.parametrize(
    "name",
    [
        "terrain-file:a.asc",
        "terrain-file:a.asc?start=0,0&goal=1,1",
        "terrain-file:a.asc?start=0,0,1&goal=1,1,1&speed=3",
        "terrain-file:a.asc?start=0,0,1&goal=1,1,1&turn=3&turn=4",
        "terrain-file:?start=0,0,1&goal=1,1,1",
    ],
)
def test_a_name_of_another_form_is_refused(name):
    with pytest.raises(ScenarioError, match="expected"):
        make_scenario(name)


@pytest.mark.parametrize("part", ["altitude=100", "altitude=100-200-300", "turn=x", "climb=-3"])
def test_a_part_of_another_form_is_refused(part):
    with pytest.raises(ScenarioError, match="must be a text such as"):
        make_scenario(f"terrain-file:a.asc?start=0,0,1&goal=1,1,1&{part}")
