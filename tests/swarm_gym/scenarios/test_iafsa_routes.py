"""Routes like those of the IAFSA paper: on known maps, clear of obstacles by the robot's radius."""

import math

import numpy as np
import pytest
import shapely

from helpers.public_maps import needed
from helpers.refusals import refused
from swarm_gym.errors import ScenarioError
from swarm_gym.problem.geometry.clearance import clearance
from swarm_gym.problem.geometry.traversal import blocked_length
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.papers.iafsa import SITES, inflation, read_site_map

# Tables 4 and 5 of the IAFSA paper.
NAMES = {"turtlebot3": ("A-B", "B-C", "C-D", "D-E"), "playground": ("A-B", "A-C", "E-D", "D-B")}


@pytest.fixture(params=SITES)
def site(request):
    needed(f"{SITES[request.param].map}.yaml")
    return request.param


@pytest.mark.parametrize("name", SITES)
def test_a_map_stands_for_the_routes_of_the_paper(name):
    routes = tuple(f"routes:{name}-{pair}" for pair in NAMES[name])
    assert expand_name(f"routes:{name}") == routes
    assert all(expand_name(route) == (route,) for route in routes)


@pytest.mark.parametrize(
    "name", ["routes", "routes:", "routes:den400d", "routes:playground-A", "routes:playground-A-D",
             "routes:playground-A-B-C", "routes:turtlebot3-A-C"],
)  # fmt: skip
def test_a_route_that_there_is_not_is_refused_with_those_that_there_are(name):
    refused(lambda: make_scenario(name), repr(name), "playground: A-B, A-C, E-D, D-B")


def test_a_missing_map_is_refused_with_its_file(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    with pytest.raises(ScenarioError, match=r"playground\.yaml"):
        make_scenario("routes:playground-A-B")


def test_another_map_of_the_name_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    (tmp_path / "playground.pgm").write_bytes(b"P5\n2 2\n255\n" + bytes([255] * 4))
    (tmp_path / "playground.yaml").write_text(
        "image: playground.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with pytest.raises(ScenarioError, match=r"playground\.yaml is not the public map"):
        make_scenario("routes:playground-A-B")


@pytest.mark.parametrize("radius", [0.1, 0.105, 0.25])
def test_maps_are_inflated_by_the_radius_and_half_a_diagonal_at_least(radius):
    needed = radius + 0.05 * math.sqrt(0.5)
    assert needed <= inflation(radius, 0.05) < needed + 0.01


def squares_of(grid):
    """Return the areas of the blocked cells, in map coordinates."""
    rows, columns = np.nonzero(grid.blocked)
    return shapely.STRtree(_squares(grid, columns, rows))


def _squares(grid, columns, rows):
    centres, half = grid.to_map(np.stack([columns, rows], axis=1)), 0.5 * grid.resolution
    return shapely.box(*(centres - half).T, *(centres + half).T)


def test_a_path_anywhere_in_free_cells_is_clear_of_obstacles_by_the_radius(site):
    raw, grid = read_site_map(site), make_scenarios(f"routes:{site}")[0].map
    rows, columns = np.nonzero(~grid.blocked)
    _, distances = squares_of(raw).query_nearest(
        _squares(grid, columns, rows), return_distance=True, all_matches=False
    )
    assert distances.min() >= SITES[site].radius


def test_the_robot_fits_along_the_shortest_paths(site):
    raw = read_site_map(site)
    obstacles = squares_of(raw)
    for scenario in make_scenarios(f"routes:{site}"):
        _, points = shortest_path(scenario)
        swept = shapely.LineString(points).buffer(SITES[site].radius, quad_segs=32)
        assert obstacles.query(swept, predicate="intersects").size == 0
        _, (distance, *_) = obstacles.query_nearest(shapely.LineString(points), return_distance=True)
        assert clearance(raw.blocked, raw.to_cells(points)) * raw.resolution == pytest.approx(distance)
        assert distance > SITES[site].radius


def test_maps_are_cut_to_what_the_robot_can_reach(site):
    for scenario in make_scenarios(f"routes:{site}"):
        assert scenario.view == scenario.workspace
        assert scenario.map.height < 200


def test_obstacles_lie_between_the_ends_and_lengths_differ(site):
    lengths = []
    for scenario in make_scenarios(f"routes:{site}"):
        cells = scenario.map.to_cells([scenario.start, scenario.target])
        assert blocked_length(scenario.map.blocked, cells) * scenario.map.resolution > 0.5
        # At the centres of cells, where A* starts.
        np.testing.assert_allclose(cells, np.round(cells), atol=1e-9)
        lengths.append(shortest_path(scenario)[0])
    assert min(np.diff(np.sort(lengths))) > 0.3
