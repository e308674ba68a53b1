"""Alternatives: no two paths lead through the same corridor, by the winding numbers of an oracle."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from helpers.grids import area_of, grid, points_in_obstacles, posts_of, random_blocks
from helpers.plans import obstacles_of
from oracles import naive_alternatives
from swarm_gym.errors import SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.planning.corridor_search import meets_itself, shortest_by_corridor
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Polygon, Scenario, make_scenario


def assert_apart(paths, posts):
    for path, other in itertools.combinations(paths, 2):
        assert any(naive_alternatives.sides_between(path, other, posts))


def never():
    return False


def lengths_of(paths):
    return [float(np.hypot(*np.diff(path, axis=0).T).sum()) for path in paths]


def test_all_doors_of_a_wall_are_found_with_the_exact_shortest_paths():
    blocked = np.zeros((61, 41), dtype=bool)
    blocked[:, 20] = True
    doors = (5, 27, 33, 50)  # rows
    blocked[list(doors), 20] = False
    scenario = GridScenario("doors", GridMap("doors", blocked), (2.0, 30.0), (38.0, 30.0))

    def through(row):
        # The near edge of the door from start and target, symmetric: two slopes and the wall's width.
        rise = min(abs(row - 0.5 - 30.0), abs(row + 0.5 - 30.0))
        return 2.0 * math.hypot(17.5, rise) + 1.0

    found = plan(scenario, alternatives=4)
    assert [one.length for one in found.alternatives] == pytest.approx(sorted(map(through, doors)))
    np.testing.assert_array_equal(found.alternatives[0].path, found.path)
    assert {one.clearance for one in found.alternatives} == {0.0}
    assert [one.costs for one in found.alternatives] == [{"length": one.length} for one in found.alternatives]


@pytest.mark.parametrize("across", [19.0, 19.5])  # the second lies between two rows of cells
def test_all_ways_through_a_lattice_of_corridors_are_found(across):
    # Four blocks leave three streets in each direction: the ways are those of a 3 x 3 lattice.
    blocked = np.zeros((40, 40), dtype=bool)
    for row, column in itertools.product((4, 22), (4, 22)):
        blocked[row : row + 14, column : column + 14] = True
    scenario = GridScenario("streets", GridMap("streets", blocked), (1.0, across), (38.0, across))

    def ways(*nodes):
        if nodes[-1] == (2, 1):
            return [nodes]
        around = [(nodes[-1][0] + dx, nodes[-1][1] + dy) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        onward = [one for one in around if min(one) >= 0 and max(one) <= 2 and one not in nodes]
        return [way for one in onward for way in ways(*nodes, one)]

    expected = ways((0, 1))
    middles = [
        [scenario.start, *((1.5 + 18.0 * x, 1.5 + 18.0 * y) for x, y in way), scenario.target]
        for way in expected
    ]
    posts = posts_of(blocked)
    found = [one.path for one in plan(scenario, alternatives=len(expected)).alternatives]
    sides = [
        {naive_alternatives.sides_between(path, found[0], posts) for path in paths}
        for paths in (found, middles)
    ]
    assert len(sides[0]) == len(expected) == 9
    assert sides[0] == sides[1]


def length(path):
    return lengths_of([path])[0]


@pytest.mark.parametrize("seed", range(6))
def test_small_maps_have_exactly_the_corridors_that_an_oracle_finds(seed):
    rng = np.random.default_rng(seed)
    blocked = random_blocks(rng, 12, 16, 3)
    start, goal = (0.0, rng.integers(0, 23) / 2.0), (15.0, rng.integers(0, 23) / 2.0)
    scenario = GridScenario("small", GridMap("small", blocked), start, goal)
    posts, longest = posts_of(blocked), 1.8 * shortest_path(scenario)[0]
    known = naive_alternatives.shortest_by_sides(area_of(blocked), posts, start, goal, longest)
    on_map = shapely.box(-0.5, -0.5, 15.5, 11.5)
    first = min(known.values())[1]
    expected = {
        naive_alternatives.sides_between(points, first, posts): length
        for length, points in known.values()
        if shapely.LineString(points).is_simple and on_map.covers(shapely.LineString(points))
    }
    found = {}
    for path in shortest_by_corridor(scenario, never):
        if length(path) <= longest:
            found.setdefault(naive_alternatives.sides_between(path, first, posts), length(path))
    assert len(expected) >= 2
    assert found == pytest.approx(expected)


@pytest.mark.parametrize(("name", "radius"), [("caves:1", 0.0), ("rooms:0", 0.7), ("caves:4", 0.7)])
def test_alternatives_are_free_and_apart_for_robots_too(name, radius):
    found = plan(name, robot_radius=radius, alternatives=4)
    blocked = obstacles_of(found.map)
    assert len(found.alternatives) == 4
    for one in found.alternatives:
        line = shapely.LineString(one.path)
        np.testing.assert_array_equal(one.path[[0, -1]], [found.map.start, found.map.target])
        assert line.intersection(blocked.buffer(-1e-5)).length == 0.0
        assert line.distance(blocked) >= radius - 1e-6
        assert one.clearance == pytest.approx(line.distance(blocked), abs=1e-6)
        assert one.length == pytest.approx(line.length)
    posts = points_in_obstacles(found.map)
    assert_apart([one.path for one in found.alternatives], posts)
    assert found.length == min(one.length for one in found.alternatives)


def test_the_gaps_between_circles_are_all_found():
    circles = tuple(Circle(0.0, y, 3.0) for y in (-8.0, 0.0, 8.0))
    scenario = Scenario("row", (-20.0, 1.0), (20.0, 1.5), circles, (-25.0, -25.0, 25.0, 25.0))
    found = plan(scenario, alternatives=6)
    # The other gaps are closed by walls: the exact planner has one way left. Above and below are open.
    gaps = ((-40.0, -8.0), (-8.0, 0.0), (0.0, 8.0), (8.0, 40.0))
    expected = []
    for gap in gaps:
        walls = tuple(Polygon.rectangle(-0.1, *(low, 0.1, high)) for low, high in gaps if (low, high) != gap)
        expected.append(shortest_path(replace(scenario, obstacles=(*circles, *walls)))[0])
    assert [one.length for one in found.alternatives[:4]] == pytest.approx(sorted(expected), rel=2e-3)
    assert_apart([one.path for one in found.alternatives], [(circle.x, circle.y) for circle in circles])


def test_one_corridor_gives_one_path():
    corridor = GridScenario(
        "corridor", GridMap("corridor", grid("#####", ".....", "#####")), (0.0, 1.0), (4.0, 1.0)
    )
    found = plan(corridor, alternatives=5)
    assert len(found.alternatives) == 1
    assert plan(corridor).alternatives == ()


def test_a_path_meets_itself_where_pieces_touch_or_cross():
    crossing = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, -2)], dtype=float)
    touching = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 0)], dtype=float)
    apart = np.array([(0, 0), (4, 0), (4, 2), (2, 2), (2, 1)], dtype=float)
    assert [meets_itself(path) for path in (crossing, touching, apart)] == [True, True, False]


@pytest.mark.parametrize("number", [0, 101, True, 2.0])
def test_another_number_of_alternatives_is_refused(number):
    with pytest.raises(SettingError, match="alternatives must"):
        plan("rooms:0", alternatives=number)


def test_the_command_writes_all_alternatives(tmp_path, capsys):
    files = [tmp_path / name for name in ("way.csv", "way.geojson", "way.svg", "way.yaml")]
    outputs = [text for file in files for text in ("--output", str(file))]
    assert main(["--map", "rooms:0", "--alternatives", "3", *outputs]) == 0
    printed = capsys.readouterr().out
    found = plan("rooms:0", alternatives=3)
    for number, one in enumerate(found.alternatives[1:], 2):
        assert f"path {number}       length {one.length:.6g}, clearance 0\n" in printed
        lines = (tmp_path / f"way-{number}.csv").read_text().splitlines()[1:]
        np.testing.assert_array_equal([list(map(float, line.split(","))) for line in lines], one.path)
        assert (tmp_path / f"way-{number}.svg").is_file()
        assert (tmp_path / f"way-{number}.yaml").is_file()
    assert not (tmp_path / "way-2.geojson").exists()
    features = json.loads((tmp_path / "way.geojson").read_text())["features"]
    assert [one["properties"]["length"] for one in features] == [one.length for one in found.alternatives]
    assert [one["properties"]["found_by"] for one in features] == [
        "exact planner",
        "alternative",
        "alternative",
    ]
    assert "way-3.csv" in printed


def test_the_first_scenario_has_more_than_one_corridor():
    found = plan(make_scenario("case1"), alternatives=3)
    centres = [(one.x, one.y) for one in found.map.obstacles if isinstance(one, Circle)]
    assert len(found.alternatives) == 3
    assert_apart([one.path for one in found.alternatives], centres)
    assert lengths_of([one.path for one in found.alternatives]) == sorted(
        one.length for one in found.alternatives
    )
