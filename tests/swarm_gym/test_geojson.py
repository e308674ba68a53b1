"""GeoJSON: every feature is an obstacle, is counted in a warning, or is refused by name."""

import json
import math
import warnings
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from helpers.features import BOX, blocked, collection, feature, random_area, read, written
from helpers.mutations import fuzzed
from helpers.shapes import shape
from swarm_gym.errors import MissingExtraError, ScenarioError
from swarm_gym.plan import main
from swarm_gym.planning import Plan, plan
from swarm_gym.planning.drawing import OBSTACLE, PAPER, as_png, as_svg
from swarm_gym.planning.geojson import read_features
from swarm_gym.planning.pieces import FLAT, as_convex, cut
from swarm_gym.planning.shapes import THIN
from swarm_gym.scenarios import Circle, Polygon

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
ROOM = {
    "type": "Polygon",
    "coordinates": [
        [[0, 0], [10, 0], [10, 8], [0, 8], [0, 0]],
        [[1, 1], [9, 1], [9, 7], [1, 7], [1, 1]],
    ],
}
PLUS = [[3, -1], [3, -6], [5, -6], [5, -1], [8, -1], [8, 1], [5, 1], [5, 6], [3, 6], [3, 1], [1, 1], [1, -1]]
WALL = feature("LineString", [[5, -4], [5, 4], [6, 4.5]], id=7, properties={"name": "wall"})


# Every feature counts.


def test_all_types_of_geometry_are_obstacles(tmp_path):
    parts = [
        feature("Polygon", [SQUARE]),
        feature(
            "MultiPolygon", [[[[10, 0], [12, 0], [11, 2], [10, 0]]], [[[20, 0], [22, 0], [21, 2], [20, 0]]]]
        ),
        feature("LineString", [[0, 10], [4, 10], [4, 14]]),
        feature("MultiLineString", [[[10, 10], [12, 10]], [[14, 10], [16, 10]]]),
        feature("Point", [20, 10, 99.0]),
        feature("MultiPoint", [[22, 10], [24, 10]]),
    ]
    collected = {"type": "GeometryCollection", "geometries": [one["geometry"] for one in parts]}
    for content in (
        collection(*parts),
        collection(*(one["geometry"] for one in parts)),
        collection({"type": "Feature", "geometry": collected}),
        {"type": "Feature", "properties": None, "geometry": collected},
        collected,
    ):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            scenario = read(tmp_path, content)
        area = blocked(scenario)
        assert area.area == pytest.approx(16 + 2 + 2)
        assert len(scenario.obstacles) == 3 + 4 + 3
        for place in ((2, 10), (4, 12), (11, 10), (15, 10), (20, 10), (22, 10), (24, 10)):
            assert area.contains(shapely.Point(place))
        assert not area.intersects(shapely.LineString([(13, 9), (13, 11)]))


def test_a_ring_that_is_open_is_read_as_the_closed_one(tmp_path):
    hole = [[1, 1], [2, 1], [1.5, 1.5], [1, 2]]
    content = {"type": "Polygon", "coordinates": [SQUARE[:-1], hole]}
    (found,) = read_features(written(tmp_path, content)).shapes
    assert found.parts == tuple(tuple(map(tuple, ring)) for ring in (SQUARE, [*hole, hole[0]]))


@pytest.mark.parametrize(
    "empty",
    [
        {"type": "Feature", "properties": {}, "geometry": None},
        feature("Polygon", None),
        feature("Polygon", []),
        feature("Polygon", [[]]),
        feature("MultiPolygon", [[]]),
        feature("MultiPoint", [None]),
        feature("LineString", []),
        {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [None]}},
        {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": None}},
        None,
    ],
)
def test_whatever_is_empty_is_counted_in_one_warning(tmp_path, empty):
    with pytest.warns(UserWarning, match="left out") as caught:
        scenario = read(tmp_path, collection(feature("Polygon", [BOX]), empty, empty))
    assert len(scenario.obstacles) == 1
    (message,) = (str(one.message) for one in caught)
    assert "2 features of 3 have no geometry" in message
    assert message.endswith("features 1, 2 (counted from 0)")


def test_what_is_beside_an_empty_part_still_counts(tmp_path):
    content = collection(
        {
            "type": "Feature",
            "geometry": {
                "type": "GeometryCollection",
                "geometries": [None, {"type": "Polygon", "coordinates": [BOX]}],
            },
        }
    )
    with pytest.warns(UserWarning, match="1 feature of 1 has no geometry, or an empty part"):
        assert blocked(read(tmp_path, content)).area == 2.0


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "expected GeoJSON"),
        ("\xff", "expected GeoJSON"),
        ("[" * 100_000, "expected GeoJSON"),
        ('{"type": "FeatureCollection", "features": null}', "expected at least one polygon, line or point"),
        ('{"type": "FeatureCollection"}', "the FeatureCollection has no member 'features'"),
        ('{"type": "FeatureCollection", "features": {}}', "'features' must be a list of features, got {}"),
        ('{"features": []}', "expected GeoJSON objects with a type"),
        ('{"type": "Topology", "objects": {}}', "unknown type 'Topology'; expected one of FeatureCollection"),
    ],
)
def test_other_files_are_refused_in_a_line(tmp_path, content, message):
    with pytest.raises(ScenarioError) as caught:
        read(tmp_path, content)
    assert message in str(caught.value)
    assert "map.geojson" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (feature("polygon", [BOX]), "unknown type 'polygon'; expected 'Polygon': capital letters count"),
        (feature("Circle", [0, 0]), "unknown type 'Circle'; expected one of Point"),
        (feature(["Polygon"], [0, 0]), "unknown type ['Polygon']"),
        ({"type": "feature", "geometry": None}, "unknown type 'feature'; expected 'Feature'"),
        (collection(), "unknown type 'FeatureCollection'"),
        ({"type": "Feature"}, "the feature has no member 'geometry'"),
        ({"geometry": None}, "expected GeoJSON objects with a type"),
        ({"type": "Feature", "geometry": {"type": "Point"}}, "the Point has no member 'coordinates'"),
        ({"type": "Feature", "geometry": {"type": "GeometryCollection"}}, "no member 'geometries'"),
        ({"type": "Feature", "geometry": {"coordinates": []}}, "expected GeoJSON objects with a type"),
        ({"type": "Feature", "geometry": 3}, "expected GeoJSON objects with a type, got 3"),
        (
            feature("Polygon", [[[0, 0], [1, 1], [0, 0]]]),
            "a ring needs at least 4 points [x, y], got [[0, 0],",
        ),
        (feature("Polygon", [BOX, [[0, 0]]]), "a ring needs at least 4 points"),
        (feature("Polygon", BOX), "expected rings of points [x, y], got 2"),
        (feature("Polygon", 5), "'coordinates' must be a list, got 5"),
        (feature("MultiPolygon", [5]), "expected rings of points [x, y], got 5"),
        (feature("LineString", [[0, 0]]), "a line needs at least 2 points"),
        (feature("LineString", [0, 0]), "expected points [x, y] of a line, got 0"),
        (feature("Point", [1]), "expected [x, y], got [1]"),
        (feature("Point", ["1", "2"]), "expected [x, y], got ['1', '2']"),
        (feature("Point", [True, False]), "expected [x, y], got [True, False]"),
        (
            feature("Point", [math.nan, 0]),
            "a coordinate must be finite and at most 1e+09 in size, got [nan, 0]",
        ),
        (feature("Point", [0, -math.inf]), "got [0, -inf]"),
        (feature("Point", [0, 10**400]), "must be finite and at most 1e+09"),
        (feature("Point", [2e9, 0]), "must be finite and at most 1e+09 in size, got [2000000000.0, 0]"),
    ],
)
def test_a_feature_that_is_malformed_is_refused_by_number_and_name(tmp_path, wrong, message):
    named = {**wrong, "id": 12, "properties": {"name": "shed"}}
    for content, name in ((wrong, "feature 1: "), (named, "feature 1 (id 12, name 'shed'): ")):
        with pytest.raises(ScenarioError) as caught:
            read(tmp_path, collection(feature("Polygon", [BOX]), content))
        assert f"map.geojson: {name}" in str(caught.value)
        assert message in str(caught.value)
        assert "\n" not in str(caught.value)


def test_a_file_with_the_mark_of_utf_8_is_read(tmp_path):
    path = tmp_path / "marked.geojson"
    path.write_bytes(b"\xef\xbb\xbf" + json.dumps(feature("Polygon", [BOX])).encode())
    assert blocked(read(tmp_path, path.read_bytes().decode("utf-8"))).area == 2.0


things = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers(-5, 5) | st.sampled_from(["Point", 10**400]),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                ["type", "coordinates", "geometry", "geometries", "features", "crs", "properties", "id"]
            ),
            inner | st.sampled_from(["Polygon", "MultiLineString", "GeometryCollection", "Feature"]),
            max_size=4,
        )
    ),
    max_leaves=12,
)


def attempt(call):
    """Return what a call returns, or None, and the message of the refusal."""
    try:
        return call(), ""
    except ScenarioError as error:
        return None, str(error)


@given(thing=things)
@example(thing={"type": "GeometryCollection", "geometries": [None, [], {"type": "Polygon"}]})
@fuzzed
def test_any_json_is_read_or_refused_by_name(tmp_path, thing):
    for content in (thing, collection(thing), collection({"type": "Feature", "geometry": thing})):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found, message = attempt(lambda content=content: read(tmp_path, content))
        assert "map.geojson" in message if found is None else found.obstacles


# Polygons.


def test_pieces_of_random_polygons_with_holes_are_convex_and_cover_them_exactly():
    rng = np.random.default_rng(0)
    triangles = pieces = holes = 0
    for _ in range(500):
        for polygon in random_area(rng):
            found = cut(polygon, 12.0)
            parts = [shape(Polygon(tuple(ring))) for ring in found]  # which refuses what is not convex
            assert shapely.union_all(parts).symmetric_difference(polygon).area < 1e-12 * polygon.area
            assert math.fsum(one.area for one in parts) == pytest.approx(polygon.area, rel=1e-12)
            # Edges inside are shared as a whole; all others are the outline.
            edges = [edge for ring in found for edge in zip(ring, ring[1:] + ring[:1], strict=True)]
            known = set(edges)
            assert len(known) == len(edges)
            outline = [edge for edge in edges if edge[::-1] not in known]
            assert math.fsum(math.dist(*edge) for edge in outline) == pytest.approx(polygon.length, rel=1e-9)
            pieces += len(found)
            triangles += len(shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)))
            holes += len(polygon.interiors)
    assert holes > 50
    assert pieces < 0.6 * triangles


def test_the_plus_of_concave_corners_is_few_pieces(tmp_path):
    scenario = read(tmp_path, feature("Polygon", [[*PLUS, PLUS[0]]]))
    assert len(scenario.obstacles) <= 5
    assert blocked(scenario).symmetric_difference(shapely.Polygon(PLUS)).area < 1e-12


def test_straight_corners_and_repeated_points_do_not_make_more_pieces(tmp_path):
    ring = [[0, 0], [1, 0], [1, 0], [4, 0], [4, 0.1], [4, 4], [3, 4], [0, 4], [0, 4], [0, 2]]
    for turned in (ring, ring[::-1]):
        scenario = read(tmp_path, feature("Polygon", [[*turned, turned[0]]]))
        assert set(scenario.obstacles[0].vertices) == {(0, 0), (4, 0), (4, 4), (0, 4)}
    assert len(scenario.obstacles) == 1


def test_a_convex_ring_with_a_repeated_turn_is_not_taken_as_convex():
    star = [(math.cos(k * 0.8 * math.pi), math.sin(k * 0.8 * math.pi)) for k in range(5)]
    assert as_convex(star, 2.0) is None
    assert as_convex([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 2.0) is None
    assert as_convex([(0.0, 0.0), (2.0, 0.0), (1.0, 0.5 * FLAT)], 2.0) is None


@pytest.mark.parametrize(
    ("rings", "area"),
    [
        ([[[0, 0], [2, 2], [2, 0], [0, 2], [0, 0]]], 2.0),  # crosses itself: both parts
        (
            [[[0, 0], [4, 0], [4, 2], [1, 2], [1, 1], [3, 1], [3, 3], [0, 3], [0, 0]]],
            11.0,
        ),  # encloses 2 twice
        ([[*SQUARE, *SQUARE[1:]]], 16.0),  # goes around twice
        ([SQUARE, [[2, 2], [6, 2], [6, 3], [2, 3], [2, 2]]], 14.0),  # the hole leads outside
        ([SQUARE, [[5, 5], [6, 5], [6, 6], [5, 5]]], 16.0),  # the hole is elsewhere
        ([SQUARE, [[1, 1], [2, 1], [3, 1], [1, 1]]], 16.0),  # the hole has no area
        ([SQUARE, [[1, 1], [1, 1], [1, 1], [1, 1]]], 16.0),
        ([SQUARE, [[0, 2], [2, 1], [2, 3], [0, 2]]], 14.0),  # the hole touches an edge
        ([SQUARE, [[0, 0], [2, 1], [1, 2], [0, 0]]], 14.5),  # the hole touches a corner
        ([SQUARE, [[1e-15, 2], [2, 1], [2, 3], [1e-15, 2]]], 14.0),  # the hole nearly touches
        ([SQUARE, [[1, 1], [2, 2], [1, 3], [1, 1]], [[2, 2], [3, 1], [3, 3], [2, 2]]], 14.0),  # holes touch
    ],
)
def test_rings_that_cross_or_touch_enclose_an_area(tmp_path, rings, area):
    scenario = read(tmp_path, feature("Polygon", rings))
    assert blocked(scenario).area == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize(
    "ring",
    [
        [[0, 0], [1, 0], [2, 0], [0, 0]],
        [[0, 0.1], [1, 0.1 + 1 / 3], [3, 1.1], [2, 0.1 + 2 / 3], [0, 0.1]],
        [[0, 0], [3, 1e-15], [3, 2e-15], [0, 0]],
        [[0, 0], [3, 3], [0, 0], [3, 3], [0, 0]],
    ],
)
def test_a_polygon_without_area_is_a_wall(tmp_path, ring):
    scenario = read(tmp_path, feature("Polygon", [ring]))
    area, line = blocked(scenario), shapely.LineString(ring)
    assert area.contains(line)
    assert area.area < 1e-5


def test_a_part_of_a_polygon_without_width_is_a_wall(tmp_path):
    scenario = read(tmp_path, feature("Polygon", [[[0, 0], [1, 0], [3, 0], [1, 0], [1, 1], [0, 1], [0, 0]]]))
    area = blocked(scenario)
    assert area.area == pytest.approx(1.0, abs=1e-5)
    assert area.intersects(shapely.LineString([(2, -1), (2, 1)]))


@pytest.mark.parametrize("offset", [0.0, 4e5, 1e7])
def test_small_polygons_and_walls_are_obstacles_at_large_coordinates(tmp_path, offset):
    ring = np.array([[0, 0], [0.02, 0], [0.02, 0.01], [0.01, 0.004], [0, 0.01], [0, 0]]) + offset
    line = np.array([[1, 1], [1.3, 1.2], [1.2, 1.4]]) + offset
    content = collection(feature("Polygon", [ring.tolist()]), feature("LineString", line.tolist()))
    start, goal = (offset - 1.0, offset), (offset + 2.0, offset)
    area = shapely.transform(blocked(read(tmp_path, content, start, goal)), lambda points: points - offset)
    assert area.area == pytest.approx(shapely.Polygon(ring - offset).area, rel=1e-3)
    assert area.buffer(1e-9).contains(shapely.LineString(line - offset))


def test_only_polygons_that_have_to_be_cut_need_shapely(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "shapely", None)
    assert len(read(tmp_path, collection(feature("Polygon", [SQUARE]), WALL)).obstacles) == 3
    with pytest.raises(
        MissingExtraError, match="feature 0, a polygon with holes or concave corners, needs shapely"
    ):
        read(tmp_path, ROOM)


# Lines, points and ends.


def test_lines_are_as_thin_as_the_map_allows_and_joints_are_closed(tmp_path):
    line = [[0, 0], [10, 0], [10, 10], [3, 4], [3, 4], [-5, -0.001]]
    scenario = read(tmp_path, feature("LineString", line), (-100.0, 0.0), (100.0, 0.0))
    assert len(scenario.obstacles) == 4
    area, half_width = blocked(scenario), 200.0 * THIN
    assert area.contains(shapely.LineString(line).buffer(0.9 * half_width))
    assert shapely.LineString(line).buffer(3.0 * half_width).contains(area)


def test_points_and_lines_of_one_place_are_tiny_circles(tmp_path):
    content = collection(feature("Point", [3, 4]), feature("LineString", [[5, 6], [5, 6]]))
    scenario = read(tmp_path, content, (-100.0, 0.0), (100.0, 0.0))
    assert scenario.obstacles == (Circle(3.0, 4.0, 200.0 * THIN), Circle(5.0, 6.0, 200.0 * THIN))


@pytest.mark.parametrize(
    ("end", "margin", "message"),
    [
        ((2.5, 0.0), 0.0, "lies inside the polygon of {}: feature 0; move it outside"),
        ((5.0, 1.0), 0.0, "lies on the line of {}: feature 1 (id 7, name 'wall')"),
        ((8.0, 8.0), 0.0, "lies on the point of {}: feature 2"),
        (
            (2.0, 2.0),
            1.5,
            "is 1 from the polygon of {}: feature 0; expected at least 1.5, the robot's radius",
        ),
        ((6.0, 0.0), 1.5, "is 1 from the line of {}: feature 1 (id 7, name 'wall'); expected at least 1.5"),
        ((8.0, 9.0), 1.5, "is 1 from the point of {}: feature 2; expected at least 1.5"),
        ((2.0, 2.0), 1.0, None),
        ((2.0, 1.0), 0.0, None),
    ],
)
def test_an_end_at_a_feature_is_refused_by_its_name(tmp_path, end, margin, message):
    content = collection(feature("Polygon", [BOX]), WALL, feature("Point", [8, 8]))
    for ends, role in (((end, (50.0, 50.0)), "start"), (((50.0, 50.0), end), "goal")):
        if message is None:
            assert read(tmp_path, content, *ends, margin).obstacles
            continue
        with pytest.raises(ScenarioError) as caught:
            read(tmp_path, content, *ends, margin)
        assert f"{role} {end} {message.format(tmp_path / 'map.geojson')}" in str(caught.value)


def test_the_inside_of_a_room_is_free_and_its_walls_are_not(tmp_path):
    assert read(tmp_path, ROOM, (2.0, 2.0), (8.0, 6.0)).obstacles
    assert read(tmp_path, ROOM, (1.0, 1.0), (9.0, 7.0)).obstacles
    # On a diagonal between two pieces, too.
    for place in ((0.5, 0.5), (0.5, 4.0), (9.9, 7.9)):
        with pytest.raises(ScenarioError, match="lies inside the polygon"):
            read(tmp_path, ROOM, place, (8.0, 6.0))


# Whole plans.


def test_a_path_leads_around_a_line_and_a_robot_keeps_away_from_it(tmp_path, capsys):
    file = written(tmp_path, collection(WALL, feature("Polygon", [BOX]), None))
    command = ["--map", str(file), "--start=0,0", "--goal=10,0", "--output", str(tmp_path / "path.csv")]
    assert main(command) == 0
    path = np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1)
    assert shapely.LineString(path).length == pytest.approx(2.0 * math.hypot(5.0, 4.0), rel=1e-6)
    error = capsys.readouterr().err
    assert (
        error
        == f"warning: {file}: 1 feature of 3 has no geometry, or an empty part, which is left out: feature 2 "
        "(counted from 0)\n"
    )
    assert main([*command, "--robot-radius", "0.3"]) == 0
    path = shapely.LineString(np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1))
    walls = shapely.union_all([shapely.LineString([(5, -4), (5, 4), (6, 4.5)]), shapely.Polygon(BOX)])
    assert path.distance(walls) == pytest.approx(0.3, abs=3e-3)
    assert path.distance(walls) >= 0.3 - 1e-6


def test_a_robot_with_a_radius_goes_around_a_point(tmp_path):
    file = written(tmp_path, feature("Point", [5, 0]))
    found = plan(file, (0.0, 0.0), (10.0, 0.0), robot_radius=1.0)
    assert found.clearance >= 1.0 - 1e-6
    exact = 2.0 * (math.sqrt(24.0) + math.asin(1.0 / 5.0))
    assert found.length == pytest.approx(exact, rel=5e-3)
    assert found.length >= exact * (1.0 - 1e-6)


def test_a_plan_stays_in_a_room_that_is_a_polygon_with_a_hole(tmp_path):
    found = plan(written(tmp_path, ROOM), (2.0, 2.0), (8.0, 6.0), robot_radius=0.5)
    assert found.length == pytest.approx(math.hypot(6.0, 4.0), rel=1e-6)


# Pictures.


def test_pictures_show_pieces_without_seams_and_lines(tmp_path):
    image = pytest.importorskip("PIL.Image")
    content = collection(ROOM, WALL | {"geometry": {"type": "LineString", "coordinates": [[3, 3], [7, 3]]}})
    scenario = read(tmp_path, content, (2.0, 2.0), (8.0, 6.0))
    path = np.array([(2.0, 2.0), (2.0, 6.0), (8.0, 6.0)])
    found = Plan(scenario, path, 10.0, 1.0, 1, 1.0, None, "swarm")
    picture = ElementTree.fromstring(as_svg(found))
    (group,) = picture.findall("{*}g")
    assert group.get("stroke") == group.get("fill") == OBSTACLE
    (tmp_path / "room.png").write_bytes(as_png(found))
    with image.open(tmp_path / "room.png") as drawn:
        scale = drawn.width / (scenario.workspace[2] - scenario.workspace[0])

        def colours(x_min, y_min, x_max, y_max):
            (left, _), (_, top) = scenario.workspace[:2], scenario.workspace[2:]
            corners = (
                (x_min - left) * scale,
                (top - y_max) * scale,
                (x_max - left) * scale,
                (top - y_min) * scale,
            )
            colours = drawn.crop(tuple(map(round, corners))).getcolors()
            return {"#{:02x}{:02x}{:02x}".format(*colour) for _, colour in colours}

        for wall in ((0.1, 0.1, 9.9, 0.9), (0.1, 7.1, 9.9, 7.9), (0.1, 0.1, 0.9, 7.9), (9.1, 0.1, 9.9, 7.9)):
            assert colours(*wall) == {OBSTACLE}
        assert colours(3.5, 4.0, 8.5, 5.0) == {PAPER}
        assert PAPER in colours(4.0, 2.5, 6.0, 3.5)
        assert len(colours(4.0, 2.5, 6.0, 3.5)) > 1  # the line
