"""Maps in longitude and latitude: planned in metres, written in degrees, held against geodesics of pyproj."""

import json
import pickle

import numpy as np
import pytest
import shapely

from helpers.features import collection, feature, read, written
from swarm_gym.errors import MissingExtraError, ScenarioError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import Planner, plan
from swarm_gym.planning.previous import require_previous
from swarm_gym.planning.tasks import read_task
from swarm_gym.planning.writing import as_geojson, as_ros_path
from swarm_gym.scenarios.formats.geographic import (
    GEOGRAPHIC,
    PLANE,
    WIDEST,
    Projection,
    look_geographic,
    named_by,
    projection_for,
)

pyproj = pytest.importorskip("pyproj", reason="needs the extra `maps`")
GEOD = pyproj.Geod(ellps="WGS84")

START, GOAL = (11.5746, 48.1373), (11.5765, 48.1372)
HOUSE = [
    [11.57512, 48.13711],
    [11.57552, 48.13711],
    [11.57552, 48.13751],
    [11.57512, 48.13751],
    [11.57512, 48.13711],
]
FENCE = [[11.5758, 48.1367], [11.5758, 48.13742]]
CITY = collection(
    feature("Polygon", [HOUSE], properties={"name": "house"}),
    feature("LineString", FENCE, properties={"name": "fence"}),
)
CRS84 = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}


def length_on_earth(points):
    """Return the length of a polyline of longitudes and latitudes in metres, by geodesics."""
    return GEOD.line_length(*np.array(points).T)


@pytest.mark.parametrize(
    "centre", [(11.57, 48.14), (-70.0, -33.0), (151.2, 0.0), (20.0, 78.0), (179.0, -16.5)]
)
def test_lengths_and_corners_of_projected_maps_are_those_on_earth(centre):
    rng = np.random.default_rng(1)
    projection = Projection(*centre)
    metres = rng.uniform(-WIDEST / 2.0, WIDEST / 2.0, (500, 2))
    degrees = projection.to_degrees(metres)
    np.testing.assert_allclose(projection.to_metres(degrees), metres, atol=1e-6)
    steps = np.hypot(*np.diff(metres, axis=0).T)
    on_earth = GEOD.inv(*degrees[:-1].T, *degrees[1:].T)[2]
    assert np.abs(steps / on_earth - 1.0).max() < 2.1e-5
    near = np.hypot(*metres.T) < 10_000.0
    assert np.abs(projection.to_metres(degrees[near]) - metres[near]).max() < 1e-6
    # x points to the east and y to the north.
    x, y = projection.to_metres([(centre[0] + 1e-4, centre[1]), (centre[0], centre[1] + 1e-4)])
    assert min(x[0], y[1]) > 0
    assert max(abs(x[1]), abs(y[0])) < 1e-3


@pytest.mark.parametrize(("kilometres", "expected"), [(1.0, 0.023), (10.0, 2.3)])
def test_a_line_that_is_straight_in_degrees_is_nearly_straight_in_metres(kilometres, expected):
    half = kilometres / 2.0 / (111.32 * np.cos(np.radians(50.0)))  # in degrees, along a circle of latitude
    ends = Projection(8.0, 50.0).to_metres([(8.0 - half, 50.0), (8.0 + half, 50.0)])
    assert np.hypot(*(ends[1] - ends[0])) == pytest.approx(1000.0 * kilometres, rel=0.01)
    assert np.hypot(*ends.mean(axis=0)) == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (
            [(0, 0), (388096.5, 3948996.25)],
            r"expected longitude in \[-180, 180\].*got \(388096.5, 3948996.25\)",
        ),
        ([(0, 95), (0, 94)], "choose coordinates 'plane'"),
        ([(179.99, 0), (-179.99, 0)], "cross the antimeridian"),
        ([(11.0, 48.0), (13.0, 48.0)], "span 149 km, expected at most 100 km"),
        ([(11.0, 48.0), (11.0, 49.0)], "span 111 km"),
        ([(-90.0, -80.0), (80.0, 85.0)], "expected at most 100 km"),
    ],
)
def test_a_map_for_which_no_plane_is_good_is_refused_in_words(points, message):
    with pytest.raises(ScenarioError, match=message):
        projection_for("city.geojson", np.array(points, dtype=np.float64))


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("urn:ogc:def:crs:OGC:1.3:CRS84", GEOGRAPHIC),
        ("urn:ogc:def:crs:OGC::CRS84", GEOGRAPHIC),
        ("OGC:CRS84", GEOGRAPHIC),
        ("http://www.opengis.net/def/crs/OGC/1.3/CRS84", GEOGRAPHIC),
        ("EPSG:4326", GEOGRAPHIC),
        ("epsg:4326", GEOGRAPHIC),
        ("urn:ogc:def:crs:EPSG::4326", GEOGRAPHIC),
        ("urn:ogc:def:crs:EPSG:6.9:4326", GEOGRAPHIC),
        ("http://www.opengis.net/def/crs/EPSG/0/4326", GEOGRAPHIC),
        ("http://www.opengis.net/gml/srs/epsg.xml#4326", GEOGRAPHIC),
        ("urn:ogc:def:crs:EPSG::4258", GEOGRAPHIC),
        ("EPSG:25832", PLANE),
        ("urn:ogc:def:crs:EPSG::32632", PLANE),
        ("EPSG:14326", PLANE),
        ("ESRI:102100", PLANE),
    ],
)
def test_a_file_may_name_its_coordinates(name, kind):
    assert named_by("a", {"type": "name", "properties": {"name": name}}) == kind


def test_other_names_of_coordinates_are_refused_or_warned_about():
    assert named_by("a", None) is None
    for wrong in (
        "EPSG:4326",
        {},
        {"type": "link", "properties": {"href": "x"}},
        {"properties": {"name": 3}},
    ):
        with pytest.raises(
            ScenarioError, match="a: expected a member 'crs' with properties that have a name"
        ):
            named_by("a", wrong)
    with pytest.warns(UserWarning, match="lengths in EPSG:3857 are no metres"):
        assert named_by("a", {"properties": {"name": "EPSG:3857"}}) == PLANE


def test_all_geographic_codes_are_longitudes_and_latitudes_by_pyproj():
    from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC_CODES

    for code in GEOGRAPHIC_CODES:
        assert pyproj.CRS.from_epsg(int(code)).is_geographic


def test_coordinates_that_look_like_degrees_are_warned_about_once_unless_chosen(tmp_path, recwarn):
    read(tmp_path, CITY, START, GOAL)
    (message,) = (str(one.message) for one in recwarn)
    assert "look like longitude and latitude" in message
    assert "choose coordinates 'longitude-latitude' to plan in metres, or 'plane' to silence this" in message
    recwarn.clear()
    plane = read(tmp_path, CITY, START, GOAL, kind=PLANE)
    metres = read(tmp_path, CITY, START, GOAL, kind=GEOGRAPHIC)
    named = read(tmp_path, {**CITY, "crs": CRS84}, START, GOAL)
    still_plane = read(tmp_path, {**CITY, "crs": CRS84}, START, GOAL, kind=PLANE)
    assert not recwarn.list
    assert plane.straight_line == still_plane.straight_line < 0.01
    assert (
        metres.straight_line == named.straight_line == pytest.approx(length_on_earth([START, GOAL]), rel=1e-8)
    )


def test_small_numbers_with_many_digits_look_like_degrees():
    points = np.array([START, GOAL])
    assert look_geographic(points)
    assert not look_geographic(np.round(points, 3))
    assert not look_geographic(200.0 * points)
    assert not look_geographic(np.array([START, (13.0765, 48.1372)]))


def test_obstacles_and_ends_in_degrees_are_metres_and_messages_say_degrees(tmp_path):
    scenario = read(tmp_path, CITY, START, GOAL, kind=GEOGRAPHIC)
    east, north = (GEOD.inv(*HOUSE[0], *HOUSE[k])[2] for k in (1, 3))
    area = shapely.Polygon(scenario.obstacles[0].vertices)
    assert area.area == pytest.approx(east * north, rel=1e-5)
    with pytest.raises(
        ScenarioError, match=r"start \(11.5753, 48.1373\) lies inside the polygon of .*name 'house'"
    ):
        read(tmp_path, CITY, (11.5753, 48.1373), GOAL, kind=GEOGRAPHIC)
    with pytest.raises(
        ScenarioError, match=r"goal \(11.575799, 48.1372\) is 0.07.* from the line of .*'fence'"
    ):
        read(tmp_path, CITY, START, (11.575799, 48.1372), 0.5, kind=GEOGRAPHIC)
    yard = (11.5745, 48.1371, 11.5764, 48.138)
    with pytest.raises(ScenarioError, match=r"goal \(11.5765, 48.1372\) lies outside the workspace 11.5745"):
        read(tmp_path, CITY, START, GOAL, workspace=yard, kind=GEOGRAPHIC)


def test_a_workspace_with_other_coordinates_is_refused(tmp_path):
    ring = [[11.574, 48.136], [11.577, 48.136], [11.577, 48.139], [11.574, 48.139], [11.574, 48.136]]
    yard = written(tmp_path, collection(feature("Polygon", [ring]), crs=CRS84), "yard.geojson")
    utm = {"type": "name", "properties": {"name": "EPSG:32632"}}
    with pytest.raises(
        ScenarioError, match=r"has coordinates 'longitude-latitude', and .* 'plane'; expected the same"
    ):
        read(tmp_path, {**CITY, "crs": utm}, START, GOAL, workspace=yard)
    assert read(tmp_path, {**CITY, "crs": CRS84}, START, GOAL, workspace=yard).straight_line > 100.0


def test_other_values_and_maps_are_refused(tmp_path, monkeypatch, capsys):
    for wrong in ("degrees", 3, ["plane"]):
        with pytest.raises(SettingError, match="coordinates must be one of plane, longitude-latitude"):
            read_task("case1", None, None, 0.0, None, wrong)
    for name in ("case1", "rooms:0"):
        with pytest.raises(SettingError, match="expected a GeoJSON file, the map is"):
            read_task(name, None, None, 0.0, None, GEOGRAPHIC)
    with pytest.raises(SystemExit):
        main(["--map", "case1", "--coordinates", "degrees"])
    capsys.readouterr()
    monkeypatch.setitem(__import__("sys").modules, "pyproj", None)
    with pytest.raises(
        MissingExtraError, match=r"longitude and latitude needs pyproj: run .*swarm_gym\[maps\]"
    ):
        read(tmp_path, CITY, START, GOAL, kind=GEOGRAPHIC)


def test_a_plan_in_metres_has_its_path_in_degrees(tmp_path, capsys):
    file = written(tmp_path, {**CITY, "crs": CRS84})
    found = plan(file, START, GOAL, robot_radius=0.4, clearance=0.1)
    np.testing.assert_array_equal(found.path[[0, -1]], [START, GOAL])
    assert found.length == pytest.approx(length_on_earth(found.path), rel=1e-6)
    # The distances of points on the path from the corners of house and fence, on earth.
    corners = np.array([*HOUSE, *FENCE])
    steps = np.linspace(found.path[:-1], found.path[1:], 1000, axis=1).reshape(-1, 2)
    distances = [GEOD.inv(*np.tile(corner, (len(steps), 1)).T, *steps.T)[2].min() for corner in corners]
    assert min(distances) == pytest.approx(0.5, abs=5e-3)
    assert found.clearance >= 0.5 - 1e-6
    for one in found.improvements:
        np.testing.assert_array_equal(one.path[[0, -1]], [START, GOAL])
    np.testing.assert_array_equal(found.improvements[-1].path, found.path)
    assert pickle.loads(pickle.dumps(found)).projection == found.projection
    on_map = found.path_on_map
    assert shapely.LineString(on_map).length == pytest.approx(found.length, rel=1e-9)
    headings = [line for line in as_ros_path(found).splitlines() if "orientation" in line]
    east = on_map[1] - on_map[0]
    assert f"z: {float(np.sin(np.arctan2(east[1], east[0]) / 2.0))!r}" in headings[0]
    # The path goes on from there, and files have degrees.
    task = read_task(file, START, GOAL, 0.5)
    assert shapely.LineString(require_previous(found.path, task)).length == pytest.approx(
        found.length, rel=1e-9
    )
    with pytest.raises(
        SettingError, match=r"expected a path that starts at \(11.5746, 48.1373\), got \(0.0, 0.0\)"
    ):
        require_previous([(0.0, 0.0), GOAL], task)
    again = ["--map", str(file), "--start=11.5746,48.1373", "--goal=11.5765,48.1372", "--robot-radius", "0.5"]
    assert main([*again, "--output", str(tmp_path / "path.geojson")]) == 0
    written_path = json.loads((tmp_path / "path.geojson").read_text())
    np.testing.assert_array_equal(written_path["geometry"]["coordinates"], found.path)
    assert written_path["properties"]["length"] == found.length
    assert f"length       {found.length:.6g}" in capsys.readouterr().out


@pytest.mark.parametrize("latitude", [5.0, 50.0, -60.0])
def test_the_rest_of_a_previous_path_is_measured_in_metres(tmp_path, latitude):
    plane = pyproj.Proj(proj="aeqd", lon_0=25, lat_0=latitude, ellps="WGS84")

    def degrees(x, y):
        return tuple(map(float, plane(x, y, inverse=True)))

    wall = [degrees(*corner) for corner in [(-900, 75), (800, 75), (800, 80), (-900, 80), (-900, 75)]]
    file = tmp_path / "wall.geojson"
    file.write_text(json.dumps({"type": "Polygon", "coordinates": [wall]}))
    planner = Planner(file, coordinates="longitude-latitude", switch_margin=1.0)
    # Metres to the path in the east, 100, are more degrees than the 140 metres to its end beyond the wall.
    around = [(100, 60), (100, -400), (-1000, -400), (-1000, 140), (0, 140), (400, 140)]
    before = [degrees(*point) for point in around]
    found = planner.plan(degrees(0, 0), degrees(400, 140), previous=before)
    assert found.switched is False
    assert found.length == pytest.approx(3540, abs=40)


@pytest.mark.parametrize("options", [{}, {"alternatives": 2}, {"turning_radius": 1.0}])
def test_geojson_repeats_the_coordinate_system_of_the_map(tmp_path, options):
    system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    block = [[500_004, 5_300_004], [500_006, 5_300_004], [500_006, 5_300_006], [500_004, 5_300_004]]
    shape = {"type": "Polygon", "coordinates": [block]}
    for crs in ({"crs": system}, {}):
        (file := tmp_path / "block.geojson").write_text(json.dumps({**shape, **crs}))
        found = plan(file, (500_000, 5_300_000), (500_010, 5_300_010), coordinates="plane", **options)
        assert json.loads(as_geojson(found)).get("crs") == crs.get("crs")
