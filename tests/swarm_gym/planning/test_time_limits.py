"""Time limits of planning: the search of wishes looks at the clock, and other threads run while it works."""

import time

import numpy as np
import pytest
from numba.core import event
from scipy import sparse
from scipy.sparse import csgraph

from swarm_gym.planning import GradedMap, Planner, plan
from swarm_gym.planning.cell_graph import cheapest_way
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.request import Request
from swarm_gym.planning.tasks import read_task
from swarm_gym.scenarios import GridMap

LONGEST = 0.02  # seconds of processor time between two looks of the search at the clock
REPEATS = 3  # of which the best counts, since neighbours on the processor slow it down


def never():
    return False


def step_costs(blocked, field):
    """Costs of steps by plain loops: {(cell, other): cost}, cells as (column, row)."""
    height, width = blocked.shape
    moves = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (2, -1), (1, 2), (1, -2)]
    found = {}
    for y in range(height):
        for x in range(width):
            for dx, dy in moves:
                # Cells whose area a segment between the middles passes, those that it only touches included.
                xs = {x, x + dx} if dx < 2 else {x, x + 1, x + 2}
                ys = {y, y + dy} if abs(dy) < 2 else {y, y + dy // 2, y + dy}
                cells = [
                    (a, b)
                    for a in xs
                    for b in ys
                    if abs((a - x) * dy - (b - y) * dx) <= (abs(dx) + abs(dy)) / 2.0
                ]
                if max(map(abs, (dx, dy))) == 2:
                    cells = [(a, b) for a, b in cells if abs((a - x) * dy - (b - y) * dx) < 1.5]
                if all(0 <= a < width and 0 <= b < height and not blocked[b, a] for a, b in cells):
                    mean = sum(field[b, a] for a, b in cells) / len(cells)
                    found[(x, y), (x + dx, y + dy)] = float(np.hypot(dx, dy)) * mean
    return found


@pytest.mark.parametrize("seed", range(4))
def test_the_way_has_the_least_sum_of_a_library(seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random((14, 17)) < 0.2
    blocked[0, 0] = blocked[-1, -1] = False
    field = 1.0 + rng.integers(0, 4, blocked.shape)
    costs = step_costs(blocked, field)
    begins, ends = (np.array([pair[k][1] * 17 + pair[k][0] for pair in costs]) for k in range(2))
    graph = sparse.csr_matrix((list(costs.values()), (begins, ends)), shape=(blocked.size,) * 2)
    least = csgraph.dijkstra(graph, directed=False, indices=0)[-1]
    way = cheapest_way(blocked, field, (0, 0), (16, 13), never)
    if np.isinf(least):
        assert way is None
        return
    pairs = [tuple(map(tuple, pair)) for pair in np.stack([way[:-1], way[1:]], axis=1).tolist()]
    total = sum(costs[pair] if pair in costs else costs[pair[::-1]] for pair in pairs)
    assert total == pytest.approx(least, rel=1e-12)
    assert (way[0].tolist(), way[-1].tolist()) == ([0, 0], [16, 13])


def test_walls_leave_no_way():
    blocked = np.zeros((9, 9), dtype=np.bool_)
    blocked[:, 4] = True
    assert cheapest_way(blocked, np.ones((9, 9)), (0, 0), (8, 8), never) is None
    blocked[4, 4] = False
    assert cheapest_way(blocked, np.ones((9, 9)), (0, 0), (8, 8), never) is not None


def longest_stretch(blocked, field):
    """Longest seconds of processor time between two looks of a search, and the number of looks."""
    looks = []

    def is_over():
        looks.append(time.thread_time())
        return False

    height, width = blocked.shape
    assert cheapest_way(blocked, field, (0, 0), (width - 1, height - 1), is_over) is not None
    return float(np.diff(looks).max(initial=0.0)), len(looks)


def test_the_search_looks_at_the_clock():
    blocked = np.zeros((600, 600), dtype=np.bool_)
    field = 1.0 + np.random.default_rng(0).random(blocked.shape)
    longest_stretch(blocked[:9, :9], field[:9, :9])  # loads the kernel
    stretches, numbers = zip(*(longest_stretch(blocked, field) for _ in range(REPEATS)), strict=True)
    assert min(numbers) > 50
    assert min(stretches) < LONGEST


def test_the_search_ends_when_time_is_up():
    looks = []

    def is_over():
        looks.append(1)
        return len(looks) > 3

    blocked = np.zeros((600, 600), dtype=np.bool_)
    assert cheapest_way(blocked, np.ones(blocked.shape), (0, 0), (599, 599), is_over) is None
    assert len(looks) == 4


def test_the_shortest_path_stands_in_when_time_is_up():
    blocked = np.zeros((40, 40), dtype=np.bool_)
    blocked[10:30, 18:22] = True
    task = read_task(GridMap("block", blocked), (2.0, 20.0), (37.0, 20.0), 0.6)
    wishes = {"distance": 5.0}
    late = PlanningRun(task, Request(wishes=wishes, max_seconds=1e-3), time.monotonic() - 1.0, never).run()
    shortest = plan(task.given, robot_radius=0.6)
    assert late.found_by == "exact planner"
    np.testing.assert_array_equal(late.path, shortest.path)
    assert plan(task.given, robot_radius=0.6, wishes=wishes).found_by == "wishes"


@pytest.mark.parametrize("margin", [0.0, 0.4])
def test_nothing_is_compiled_for_wishes(margin):
    values = np.zeros((30, 30), dtype=np.int8)
    values[10:20, 10:20], values[:8] = 100, 40
    graded = GradedMap.of_values("graded", values, "occupancy", 1.0, (0.0, 0.0))
    by_name = Planner(graded.grid, robot_radius=margin, wishes={"distance": 1.0})
    for planner in (Planner(graded, robot_radius=margin), by_name):
        with event.install_recorder("numba:compile") as recorder:
            found = planner.plan((2.0, 2.0), (27.0, 27.0), alternatives=2)
        assert recorder.buffer == []
        assert found.costs["sum"] >= found.length
