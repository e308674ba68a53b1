"""The oracle of shortest paths around unions, held against values by hand and against other methods."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from helpers.trouble_grids import blocked_of
from helpers.trouble_scenes import make_scene
from oracles.entered_depth import Blocked, entered_depth
from oracles.shapely_paths import shortest_length, shortest_route

DATA = Path(__file__).parents[1] / "data"
RIGHT_ANGLED = ("comb", "spiral", "letter", "terrace", "staggered", "slices", "walls", "rooms")
SQUARES = [shapely.box(0, 0, 2, 2), shapely.box(2, 2, 4, 4)]  # touch in a point
EMPTY = shapely.Polygon()
CORNERS = 16  # per quarter of the polygons that stand for round shapes
STEPS = [(1, 0), (0, 1), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1)]


def read(name, origin):
    """Return the union of a file of `tests/data`, moved so that a point is at the origin."""
    features = json.loads((DATA / f"{name}.geojson").read_text())["features"]
    rings = [np.array(one["geometry"]["coordinates"][0]) - origin for one in features]
    return shapely.union_all([shapely.Polygon(ring) for ring in rings])


def ends_of(scene):
    return (scene.start.real, scene.start.imag), (scene.goal.real, scene.goal.imag)


@pytest.mark.parametrize(
    ("name", "start", "goal", "length"),
    [
        ("plus", (0.0, 2.0), (9.0, -3.0), 15.5474),
        ("terrace", (0.0, 0.0), (9.0, 0.0), 23.2106),
        # By hand: around (6, 1), (8, 1) and (14, -2).
        (
            "utm_20",
            (388096.5, 3948996.25),
            (388116.5, 3948996.25),
            math.sqrt(37) + 2 + math.sqrt(45) + math.sqrt(40),
        ),
    ],
)
def test_the_oracle_finds_the_right_lengths_of_files(name, start, goal, length):
    blocked = Blocked(read(name, np.array(start)))
    assert shortest_length(blocked, (0.0, 0.0), np.subtract(goal, start)) == pytest.approx(length, abs=6e-5)


def test_a_point_passes_where_corners_touch_and_a_robot_does_not():
    area = shapely.union_all(SQUARES)
    ends = (0.5, 3.0), (3.5, 1.0)
    assert shortest_length(Blocked(area), *ends) == pytest.approx(math.dist(*ends))
    around = shortest_length(Blocked(area, radius=0.1), *ends)
    assert around == pytest.approx(shortest_length(Blocked(area.buffer(0.1, quad_segs=64)), *ends), rel=1e-4)
    assert around > 4.0


def test_cells_that_touch_at_a_corner_leave_no_gap():
    cells = np.zeros((4, 5), dtype=np.bool_)
    cells[0, 2] = cells[1, 1] = True
    # The straight line passes the corner (1.5, 0.5). The way around turns at (0.5, 0.5) and (1.5, 1.5).
    ends = (1.0, 0.0), (2.0, 1.0)
    blocked = blocked_of(cells, 0.0)
    expected = math.dist(ends[0], (0.5, 0.5)) + 1.0 + 1.0 + math.dist((1.5, 1.5), ends[1])
    assert shortest_length(blocked, *ends) == pytest.approx(expected)
    # A cell at the border leaves no gap there, though its side is on the boundary of the area.
    cells[1:, 1] = True
    assert shortest_length(blocked_of(cells, 0.0), *ends) == math.inf


def test_paths_around_discs_have_known_lengths_and_one_passes_between_two_that_touch():
    disc = np.array([[0.0, 0.0, 1.0]])
    half = math.sqrt(3.0) + math.pi / 6
    assert shortest_length(Blocked(EMPTY, disc), (-2.0, 0.0), (2.0, 0.0)) == pytest.approx(2 * half)
    assert shortest_length(Blocked(EMPTY, disc), (-1.0, 0.0), (1.0, 0.0)) == pytest.approx(math.pi)
    two = np.array([[0.0, 1.0, 1.0], [0.0, -1.0, 1.0]])
    assert shortest_length(Blocked(EMPTY, two), (-1.0, 0.0), (1.0, 0.0)) == pytest.approx(2.0)
    assert shortest_length(Blocked(EMPTY, two), (-1.0, 1.0), (1.0, -1.0)) == pytest.approx(math.pi)
    grown = Blocked(EMPTY, two - [0.0, 0.0, 0.5], radius=0.5)
    assert shortest_length(grown, (-1.0, 1.0), (1.0, -1.0)) == pytest.approx(math.pi)


def test_depths_of_paths_are_those_known_by_hand():
    union = Blocked(shapely.union_all([shapely.box(0, 0, 4, 2), shapely.box(0, 2, 4, 4)]))
    for path, depth in (
        ([(-1, 2), (5, 2)], 2.0),  # along the shared edge
        ([(-1, 1), (5, 1)], 1.0),
        ([(-1, 4), (5, 4)], 0.0),
        ([(-1, -1), (1, -1), (1, 0), (3, 0), (3, 1e-7), (3.5, 0), (5, 0)], 1e-7),
        ([(-1, 0), (1, 2)], 1.0),
    ):
        assert entered_depth(union, np.array(path, dtype=float)) == pytest.approx(depth, abs=1e-12)
    disc = Blocked(EMPTY, np.array([[1.0, 1.0, 1.0]]), radius=0.5)
    assert entered_depth(disc, np.array([(-2.0, 2.0), (4.0, 2.0)])) == pytest.approx(0.5, abs=1e-12)
    grown = Blocked(union.area, radius=0.5)
    assert entered_depth(grown, np.array([(-1.0, 4.25), (5.0, 4.25)])) == pytest.approx(0.25, abs=1e-12)
    assert entered_depth(grown, np.array([(-1.0, 3.75), (5.0, 3.75)])) == pytest.approx(0.75, abs=1e-12)


def test_depths_are_those_of_many_samples():
    for seed in range(8):
        scene = make_scene(seed, convex=True)
        path = np.array(ends_of(scene))
        points = shapely.points(path[0] + np.linspace(0.0, 1.0, 20_001)[:, None] * (path[1] - path[0]))
        blocked = Blocked(scene.lattice.area)
        inside = shapely.contains(blocked.area, points)
        sampled = (shapely.distance(blocked.outline, points) * inside).max()
        step = math.dist(*path) / 20_000
        assert sampled - 1e-9 <= entered_depth(blocked, path) <= sampled + step


def test_lengths_are_those_of_a_graph_whose_edges_shapely_checks():
    compared = 0
    for seed in range(120):
        scene = make_scene(seed, radius=False)
        if len(scene.discs) or len(scene.polygons) > 12:
            continue
        compared += 1
        area = scene.lattice.area
        points = np.unique(np.concatenate([np.array(ends_of(scene)), shapely.get_coordinates(area)]), axis=0)
        i, j = np.triu_indices(len(points), 1)
        found = _by_dijkstra(scene, points, i, j)
        assert shortest_length(scene.lattice, *ends_of(scene)) == pytest.approx(found, rel=1e-9), scene.seed
    assert compared > 50


def test_lengths_are_those_of_a_fine_lattice_or_less():
    compared = 0
    for seed in range(60):
        scene = make_scene(seed, radius=False)
        if len(scene.discs) or scene.kind not in RIGHT_ANGLED:
            continue
        every = np.concatenate([scene.lattice.around, ends_of(scene)])
        low, high = every.min(axis=0) // 2 * 2 - 4, every.max(axis=0) + 6
        x, y = (np.arange(low[k], high[k], 2) for k in range(2))
        lattice = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        points = np.concatenate([lattice.reshape(-1, 2), np.array(ends_of(scene))])
        numbers = np.arange(lattice[..., 0].size).reshape(len(x), len(y))
        i, j = np.concatenate([_neighbours(numbers, *step) for step in STEPS], axis=1)
        for end in (len(points) - 2, len(points) - 1):
            near = np.flatnonzero(np.hypot(*(points[:-2] - points[end]).T) < 8.0)
            i, j = np.concatenate([i, np.full(len(near), end)]), np.concatenate([j, near])
        longer = _by_dijkstra(scene, points, i, j)
        length = shortest_length(scene.lattice, *ends_of(scene))
        if math.isinf(length):
            assert math.isinf(longer)
            continue
        compared += 1
        assert length * (1 - 1e-9) <= longer <= length * 1.03 + 4.0, scene.seed
    assert compared > 15


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 10])
def test_grown_lengths_lie_between_those_of_polygons_inside_and_outside(number):
    compared, wider = 0, 1.0 / math.cos(math.pi / (4 * CORNERS))
    for seed in range(400):
        scene = make_scene(seed)
        if len(scene.polygons) + len(scene.discs) > 6 or (scene.radius == 0.0 and not len(scene.discs)):
            continue
        length = shortest_length(scene.grown_lattice(), *ends_of(scene))
        least, most = (
            shortest_length(Blocked(_round(scene, factor)), *ends_of(scene)) for factor in (1.0, wider)
        )
        assert least * (1 - 1e-9) <= length <= most * (1 + 1e-9), seed  # also where there is none
        assert math.isinf(most) or most < 1.005 * least
        compared += 1
        if compared == number:
            return
    raise AssertionError("too few scenes with round shapes")


def test_a_route_enters_nothing_and_is_as_long_as_it_says():
    for seed in range(40):
        scene = make_scene(seed, radius=False)
        length, route = shortest_route(scene.lattice, *ends_of(scene))
        if len(scene.discs) or math.isinf(length):
            continue
        assert entered_depth(scene.lattice, route) <= scene.lattice.tolerance
        assert shapely.LineString(route).length == pytest.approx(length)


def _by_dijkstra(scene, points, i, j):
    """Return the length between the ends in the graph of pairs that do not cross the shrunk union."""
    shrunk = scene.lattice.area.buffer(-1e-5, join_style="mitre")
    shapely.prepare(shrunk)
    free = ~shapely.intersects(shrunk, shapely.linestrings(np.stack([points[i], points[j]], axis=1)))
    i, j = i[free], j[free]
    weights = np.hypot(*(points[i] - points[j]).T)
    graph = coo_array((weights, (i, j)), shape=(len(points), len(points))).tocsr()
    start, goal = (int(np.flatnonzero((points == end).all(axis=1))[-1]) for end in ends_of(scene))
    return dijkstra(graph, directed=False, indices=start)[goal]


def _neighbours(numbers, right, up):
    """Return pairs of numbers of a table that are a step apart, (2, k)."""
    width, height = numbers.shape
    first = numbers[: width - right, max(0, -up) : height - max(0, up)]
    second = numbers[right:, max(0, up) : height - max(0, -up)]
    return np.stack([first.ravel(), second.ravel()])


def _round(scene, factor):
    """Return the grown union with polygons for round shapes, whose corners have the radius times a factor."""
    radius = factor * scene.lattice_radius
    area = scene.lattice.area.buffer(radius, quad_segs=CORNERS) if radius else scene.lattice.area
    radii = factor * (scene.discs[:, 2] + scene.lattice_radius)
    discs = shapely.buffer(shapely.points(scene.discs[:, :2]), radii, quad_segs=CORNERS)
    return shapely.union_all([area, *discs])
