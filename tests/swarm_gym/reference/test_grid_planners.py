"""A* and the any-angle planner on occupancy grids, against graphs of everything and against known optima."""

import heapq
import json
import math
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.compiled import compiled
from helpers.grids import area_of, frozen, grid
from helpers.public_maps import needed
from swarm_gym.errors import ScenarioError
from swarm_gym.problem.geometry.traversal import is_gap, path_is_free, segment_is_free
from swarm_gym.reference import AnyAnglePlanner, shortest_grid_path, smooth
from swarm_gym.reference.priority_queue import enter, make_queue, take_first
from swarm_gym.scenarios.formats.moving_ai import read_map, read_scenarios

DIAGONAL = math.sqrt(2.0)
SEEDS = st.integers(0, 2**32 - 1)
# How far the walls of the free space are moved in for shapely; lengths change by a few times as much.
EROSION = 1e-6
# How much longer than the straight line an octile path is at most where nothing is in the way.
OCTILE_RATIO = math.sqrt(4.0 - 2.0 * math.sqrt(2.0))


def random_grid(rng, most, least=1):
    """Sparse, dense, or of blocks: gaps, corridors and open places all occur."""
    width, height = rng.integers(least, most, 2, endpoint=True)
    blocked = rng.random((height, width)) < rng.choice([0.1, 0.25, 0.4])
    if rng.random() < 0.3:
        blocked = np.kron(blocked, np.ones((2, 2), bool))[:height, :width].copy()
    blocked.flat[rng.integers(blocked.size)] = False
    return frozen(blocked)


def random_task(seed, most, least=1):
    """(blocked, start, goal) with ends that are free cells."""
    rng = np.random.default_rng(seed)
    blocked = random_grid(rng, most, least)
    rows, columns = np.nonzero(~blocked)
    start, goal = ((int(columns[k]), int(rows[k])) for k in rng.integers(0, rows.size, 2))
    return blocked, start, goal


def length_or_infinity(plan, *arguments):
    try:
        return plan(*arguments)[0]
    except ScenarioError as error:
        if "separate" not in str(error):
            raise
        return math.inf


def benchmark(name):
    """Return the blocked cells of a map, and its problems."""
    return read_map(needed(f"{name}.map")).blocked, read_scenarios(needed(f"{name}.map.scen"))


def dijkstra(num_nodes, begins, ends, lengths, start, goal):
    graph = scipy.sparse.csr_array((lengths, (begins, ends)), shape=(num_nodes, num_nodes))
    return float(scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=start)[goal])


def octile_optimum(blocked, start, goal):
    """Dijkstra over the explicit graph of all steps."""
    height, width = blocked.shape
    edges = []
    for row, column in np.argwhere(~blocked):
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            r, c = row + down, column + right
            if r < height and 0 <= c < width and not blocked[[row, r, r], [c, column, c]].any():
                edges.append((row * width + column, r * width + c, math.hypot(down, right)))
    columns = np.array(edges).T if edges else np.zeros((3, 0))
    ends = (start[1] * width + start[0], goal[1] * width + goal[0])
    return dijkstra(blocked.size, *columns[:2].astype(int), columns[2], *ends)


def shapely_optimum(blocked, start, goal):
    """Dijkstra over all lines between vertices of the free space, whose walls are moved in a little."""
    free = area_of(~blocked)
    nodes = shapely.get_coordinates(free.buffer(-EROSION, join_style="mitre"))
    nodes = np.vstack([start, goal, nodes])
    begins, ends = np.triu_indices(len(nodes), 1)
    lines = shapely.linestrings(np.stack([nodes[begins], nodes[ends]], axis=1))
    room = free.buffer(-EROSION / 2, join_style="mitre")
    shapely.prepare(room)
    visible = shapely.covers(room, lines)
    begins, ends, lengths = begins[visible], ends[visible], shapely.length(lines)[visible]
    # A length of zero would be no edge.
    return dijkstra(len(nodes), begins, ends, np.maximum(lengths, 1e-300), 0, 1)


def sight_optimum(blocked, start, goal):
    """Dijkstra over all free segments between ends and crossings of grid lines that are no gaps."""
    height, width = blocked.shape
    crossings = [
        (i - 0.5, j - 0.5)
        for j in range(height + 1)
        for i in range(width + 1)
        if not compiled(is_gap)(blocked, i, j)
        and segment_is_free(blocked, i - 0.5, j - 0.5, i - 0.5, j - 0.5)
    ]
    nodes = np.array([start, goal, *crossings], dtype=float)
    edges = [
        (a, b) for b in range(len(nodes)) for a in range(b) if segment_is_free(blocked, *nodes[a], *nodes[b])
    ]
    begins, ends = np.array(edges).reshape(-1, 2).T
    lengths = np.linalg.norm(nodes[begins] - nodes[ends], axis=1)
    return dijkstra(len(nodes), begins, ends, np.maximum(lengths, 1e-300), 0, 1)


class TestGridPath:
    @settings(deadline=None)
    @given(SEEDS)
    def test_is_as_short_as_in_the_graph_of_all_steps(self, seed):
        task = random_task(seed, 14)
        assert length_or_infinity(shortest_grid_path, *task) == pytest.approx(
            octile_optimum(*task), rel=1e-12
        )

    @settings(deadline=None)
    @given(SEEDS)
    def test_goes_over_free_cells_in_steps_that_cut_no_corner(self, seed):
        blocked, start, goal = random_task(seed, 20, least=3)
        assume(math.isfinite(length_or_infinity(shortest_grid_path, blocked, start, goal)))
        path = shortest_grid_path(blocked, start, goal)
        assert tuple(path.cells[0]) == start
        assert tuple(path.cells[-1]) == goal
        num_diagonal = 0
        for (c, r), (d, s) in pairwise(path.cells):
            assert max(abs(d - c), abs(s - r)) == 1
            assert not blocked[[r, s, s, r], [c, d, c, d]].any()
            num_diagonal += c != d and r != s
        num_straight = len(path.cells) - 1 - num_diagonal
        assert path.length == pytest.approx(num_straight + num_diagonal * DIAGONAL, rel=1e-12)
        assert len(path.cells) <= path.expansions <= (~blocked).sum()

    def test_a_planner_expands_the_cells_of_the_path_alone_where_nothing_is_in_the_way(self):
        path = shortest_grid_path(np.zeros((30, 40), bool), (2, 3), (35, 20))
        assert path.expansions == len(path.cells) == 34
        assert path.length == 16 + 17 * DIAGONAL

    @settings(deadline=None)
    @given(st.integers(0, 99), st.integers(0, 99))
    def test_is_longer_than_the_line_by_a_known_ratio_at_most_where_nothing_is_in_the_way(self, column, row):
        octile = shortest_grid_path(np.zeros((100, 100), bool), (0, 0), (column, row)).length
        assert octile <= OCTILE_RATIO * math.hypot(column, row) * (1 + 1e-12)

    def test_is_the_same_every_time(self):
        task = random_task(3, 60, least=60)
        first, second = shortest_grid_path(*task), shortest_grid_path(*task)
        np.testing.assert_array_equal(first.cells, second.cells)
        assert first.expansions == second.expansions

    def test_from_a_cell_to_itself_is_that_cell(self):
        path = shortest_grid_path(grid(".#"), (0, 0), (0, 0))
        assert path.length == 0.0
        assert path.cells.tolist() == [[0, 0]]

    @pytest.mark.parametrize("maker", [lambda b: b.tolist(), lambda b: b.astype(int), lambda b: b[0]])
    def test_a_grid_that_is_none_is_refused(self, maker):
        given_grid = maker(grid("..", ".."))
        if isinstance(given_grid, list):
            assert shortest_grid_path(given_grid, (0, 0), (1, 0)).length == 1.0
        else:
            with pytest.raises(ScenarioError, match="expected booleans"):
                shortest_grid_path(given_grid, (0, 0), (1, 0))

    @pytest.mark.parametrize(
        ("start", "goal", "message"),
        [
            ((1, 0), (0, 0), r"start \(1, 0\) is a blocked cell"),
            ((0, 0), (1, 0), r"goal \(1, 0\) is a blocked cell"),
            ((0, 0), (3, 0), r"goal \(3, 0\) is outside the grid of 3 columns and 2 rows"),
            ((0, -1), (0, 0), r"start \(0, -1\) is outside"),
            ((0, 0.5), (0, 0), r"start is \(0, 0.5\); expected the integers"),
            ((0, 0, 0), (0, 0), r"start is \(0, 0, 0\); expected two"),
            ((0, 0), "ab", "goal is 'ab'; expected two"),
            ((0, 0), (2, 0), r"separate start \(0, 0\) and goal \(2, 0\)"),
        ],
    )
    def test_impossible_ends_are_refused_by_name(self, start, goal, message):
        with pytest.raises(ScenarioError, match=message):
            shortest_grid_path(grid(".#.", ".#."), start, goal)


class TestAnyAnglePath:
    @settings(max_examples=50, deadline=None)
    @given(SEEDS)
    def test_is_as_short_as_shapely_finds(self, seed):
        """Ends are anywhere inside of free cells."""
        blocked, start, goal = random_task(seed, 7)
        rng = np.random.default_rng(seed)
        start, goal = np.array([start, goal]) + rng.choice([0.0, 0.49]) * rng.uniform(-1.0, 1.0, (2, 2))
        found = length_or_infinity(AnyAnglePlanner(blocked).shortest_path, start, goal)
        assert found == pytest.approx(shapely_optimum(blocked, start, goal), abs=100 * EROSION)

    @settings(max_examples=60, deadline=None)
    @given(SEEDS)
    def test_is_as_short_as_over_all_crossings_in_sight(self, seed):
        """Ends are at centres, corners and edges of cells."""
        blocked, start, goal = random_task(seed, 12, least=4)
        rng = np.random.default_rng(seed)
        start, goal = np.array([start, goal]) + rng.integers(-1, 1, (2, 2), endpoint=True) / 2
        found = length_or_infinity(AnyAnglePlanner(blocked).shortest_path, start, goal)
        assert found == pytest.approx(sight_optimum(blocked, start, goal), rel=1e-12)

    @settings(deadline=None)
    @given(SEEDS)
    def test_is_free_as_long_as_said_and_turns_at_corners_only(self, seed):
        blocked, start, goal = random_task(seed, 40, least=5)
        rng = np.random.default_rng(seed)
        start, goal = np.array([start, goal]) + rng.choice([0.0, 0.5]) * rng.uniform(-1.0, 1.0, (2, 2))
        planner = AnyAnglePlanner(blocked)
        assume(math.isfinite(length_or_infinity(planner.shortest_path, start, goal)))
        length, points = planner.shortest_path(start, goal)
        np.testing.assert_array_equal(points[[0, -1]], [start, goal])
        assert path_is_free(blocked, points)
        assert length == pytest.approx(np.linalg.norm(np.diff(points, axis=0), axis=1).sum(), rel=1e-12)
        ringed = np.pad(blocked, 1, constant_values=True)
        for before, here, after in zip(points, points[1:], points[2:], strict=False):
            i, j = (here + 0.5).astype(int)
            assert ringed[j : j + 2, i : i + 2].sum() == 1
            assert np.linalg.det([here - before, after - here]) != 0.0

    @settings(deadline=None)
    @given(SEEDS)
    def test_is_no_longer_than_the_grid_path_and_no_shorter_than_the_line(self, seed):
        blocked, start, goal = random_task(seed, 30, least=5)
        octile = length_or_infinity(shortest_grid_path, blocked, start, goal)
        length = length_or_infinity(AnyAnglePlanner(blocked).shortest_path, start, goal)
        assert math.isinf(octile) == math.isinf(length)
        assert math.dist(start, goal) * (1 - 1e-12) <= length <= octile * (1 + 1e-12)

    @settings(deadline=None)
    @given(SEEDS)
    def test_is_as_long_backwards_and_on_the_mirrored_or_turned_grid(self, seed):
        blocked, start, goal = random_task(seed, 25, least=5)
        length = length_or_infinity(AnyAnglePlanner(blocked).shortest_path, start, goal)
        last = blocked.shape[1] - 1
        for other, begin, end in (
            (blocked, goal, start),
            (blocked[:, ::-1], (last - start[0], start[1]), (last - goal[0], goal[1])),
            (blocked.T, start[::-1], goal[::-1]),
        ):
            found = length_or_infinity(AnyAnglePlanner(other).shortest_path, begin, end)
            assert found == pytest.approx(length, rel=1e-12)

    def test_goes_around_a_gap(self):
        blocked = grid(
            "...#.",
            "..#..",
            "...#.",
            ".....",
        )
        _, points = AnyAnglePlanner(blocked).shortest_path((2, 0), (4, 1))
        assert points.tolist() == [[2, 0], [1.5, 0.5], [1.5, 1.5], [2.5, 2.5], [3.5, 2.5], [4, 1]]
        assert path_is_free(blocked, points)

    @pytest.mark.parametrize("turn", [np.asarray, np.transpose, np.fliplr, lambda grid: np.fliplr(grid).T])
    def test_a_planner_squeezes_between_walls_whose_corners_are_on_one_line(self, turn):
        """Only the ray along both walls passes; the path bends where they begin and end."""
        blocked = turn(grid("....", "##..", "....", "..##", "...."))
        start, goal = np.argwhere(turn(grid("#...", "....", "....", "....", "...#")))[:, ::-1]
        length, points = AnyAnglePlanner(blocked).shortest_path(start, goal)
        assert length == pytest.approx(3.0 + 2.0 * math.hypot(1.5, 0.5), rel=1e-12)
        assert len(points) == 4

    def test_may_begin_in_a_gap_to_either_side(self):
        planner = AnyAnglePlanner(grid(".#", "#."))
        assert planner.shortest_path((0.5, 0.5), (0, 0))[0] == math.sqrt(0.5)
        assert planner.shortest_path((1, 1), (0.5, 0.5))[0] == math.sqrt(0.5)
        with pytest.raises(ScenarioError, match="separate"):
            planner.shortest_path((0, 0), (1, 1))

    def test_runs_along_walls_and_the_border(self):
        planner = AnyAnglePlanner(grid("....", ".##.", ".##."))
        length, points = planner.shortest_path((0.5, 2.5), (2.5, 2.5))
        assert points.tolist() == [[0.5, 2.5], [0.5, 0.5], [2.5, 0.5], [2.5, 2.5]]
        assert length == 6.0
        assert planner.shortest_path((-0.5, -0.5), (3.5, -0.5))[0] == 4.0

    def test_an_end_beside_a_wall_by_a_rounding_error_is_at_the_wall(self):
        planner = AnyAnglePlanner(grid("....", ".##.", "...."))
        at_wall = planner.shortest_path((0.5, 0.5), (3.0, 2.0))[0]
        for error in (-1e-12, 1e-12):
            length, _ = planner.shortest_path((0.5 + error, 0.5 + error), (3.0, 2.0))
            assert length == pytest.approx(at_wall, abs=1e-11)

    @pytest.mark.parametrize(
        ("start", "message"),
        [
            ((1.2, 0.0), r"start \(1.2, 0\) is not in a free cell"),
            ((0.0, 1.6), r"start \(0, 1.6\) is not in a free cell"),
            ((math.nan, 0.0), "expected two finite numbers"),
            ((2.5, 0.2), "separate"),
        ],
    )
    def test_impossible_ends_are_refused_by_name(self, start, message):
        with pytest.raises(ScenarioError, match=message):
            AnyAnglePlanner(grid(".#.", ".#.")).shortest_path(start, (0, 0))

    def test_later_changes_of_the_grid_do_not_reach_the_planner(self):
        blocked = grid("...").copy()
        planner = AnyAnglePlanner(blocked)
        blocked[:] = True
        assert planner.shortest_path((0, 0), (2, 0))[0] == 2.0


class TestSmoothPath:
    @settings(deadline=None)
    @given(SEEDS)
    def test_is_free_and_no_shorter_than_the_optimum_and_no_longer_than_the_grid_path(self, seed):
        blocked, start, goal = random_task(seed, 30, least=5)
        assume(math.isfinite(length_or_infinity(shortest_grid_path, blocked, start, goal)))
        path = shortest_grid_path(blocked, start, goal)
        points = smooth(blocked, path.cells).astype(float)
        np.testing.assert_array_equal(points[[0, -1]], [start, goal])
        assert path_is_free(blocked, points)
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        optimum, _ = AnyAnglePlanner(blocked).shortest_path(start, goal)
        assert optimum * (1 - 1e-12) <= length <= path.length * (1 + 1e-12)

    def test_turns_where_the_next_cell_is_out_of_sight_only(self):
        blocked = grid(".....", ".###.", ".....")
        path = shortest_grid_path(blocked, (0, 2), (3, 0))
        assert smooth(blocked, path.cells).tolist() == [[0, 2], [0, 0], [3, 0]]


class TestBenchmark:
    """Optima of the Moving AI benchmark (Sturtevant 2012), where its files are there."""

    @pytest.mark.parametrize(
        ("name", "every"),
        [("arena", 1), ("den400d", 10), pytest.param("den400d", 1, marks=pytest.mark.slow)],
    )
    def test_grid_paths_have_the_published_lengths_and_any_angle_paths_are_not_longer(self, name, every):
        blocked, problems = benchmark(name)
        planner = AnyAnglePlanner(blocked)
        for problem in problems[::every]:
            ends = problem.start, problem.goal
            assert shortest_grid_path(blocked, *ends).length == pytest.approx(problem.length, abs=1e-3)
            length, points = planner.shortest_path(*ends)
            assert path_is_free(blocked, points)
            assert math.dist(*ends) - 1e-9 <= length <= problem.length + 1e-3

    def test_any_angle_paths_have_the_known_lengths(self):
        tasks = json.loads(needed("den400d_p1_p6.json").read_text())
        blocked, _ = benchmark("den400d")
        planner = AnyAnglePlanner(blocked)
        for task in tasks.values():
            ends = task["start"], task["goal"]
            length, points = planner.shortest_path(*ends)
            assert length == pytest.approx(task["any_angle"], abs=1e-4)
            assert path_is_free(blocked, points)
            assert shortest_grid_path(blocked, *ends).length == pytest.approx(task["octile"], abs=1e-3)


@settings(max_examples=50, deadline=None)
@given(SEEDS)
def test_the_queue_gives_the_cheapest_first_and_of_these_the_longest_way(seed):
    rng = np.random.default_rng(seed)
    num_nodes = int(rng.integers(1, 60))
    queue, size, expected = make_queue(num_nodes), 0, {}
    for _ in range(200):
        if expected and rng.random() < 0.3:
            first = min(expected, key=expected.__getitem__)
            assert compiled(take_first)(queue, size) == first
            size -= 1
            del expected[first]
        else:
            node = int(rng.integers(num_nodes))
            cost = min(float(rng.integers(20)), expected[node][0] if node in expected else math.inf)
            queue.cost[node], queue.length[node] = cost, float(rng.integers(3))
            if node in expected:
                queue.length[node] = -expected[node][1]
            expected[node] = (cost, -queue.length[node], node)
            size = compiled(enter)(queue, size, node)
    heap = list(expected.values())
    heapq.heapify(heap)
    while heap:
        assert compiled(take_first)(queue, size) == heapq.heappop(heap)[2]
        size -= 1
    assert size == 0
