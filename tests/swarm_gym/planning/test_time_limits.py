"""Time limits of planning: searches look at the clock, other threads run meanwhile, and no thread is left."""

import gc
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
from numba.core import event
from scipy import sparse
from scipy.sparse import csgraph

from swarm_gym.errors import NoPathError
from swarm_gym.planning import GradedMap, Planner, plan
from swarm_gym.planning.cell_graph import cheapest_way
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.request import Request
from swarm_gym.planning.tasks import read_task
from swarm_gym.reference import DiscPlanner
from swarm_gym.reference.disc_planner import StoppedError
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


def random_blocks(side, share):
    blocked = np.random.default_rng(side).random((side, side)) < share
    blocked[:8, :8] = blocked[-8:, -8:] = False
    return blocked


def stretches_of_a_disc(blocked):
    """Seconds of processor time between two looks of a search that has prepared nothing."""
    planner, looks = DiscPlanner(blocked, 0.4), []

    def is_stopped():
        looks.append(time.thread_time())
        return False

    side = len(blocked)
    gc.collect()
    gc.freeze()  # as docs/planning-programs.md advises
    try:
        planner.shortest_path((1.0, 1.0), (side - 2.0, side - 2.0), is_stopped)
    finally:
        gc.unfreeze()
    return np.diff(looks)


def test_the_search_of_a_disc_looks_at_the_clock():
    stretches_of_a_disc(random_blocks(30, 0.1))  # loads the kernels
    stretches = [stretches_of_a_disc(random_blocks(400, 0.1)) for _ in range(REPEATS)]
    assert min(map(len, stretches)) > 50
    assert min(one.max() for one in stretches) < LONGEST


def test_a_search_of_a_disc_that_was_stopped_leaves_the_planner_as_good():
    blocked, looks = random_blocks(100, 0.1), []
    planner = DiscPlanner(blocked, 0.4)

    def is_stopped():
        looks.append(1)
        return len(looks) > 20

    with pytest.raises(StoppedError):
        planner.shortest_path((1.0, 1.0), (98.0, 98.0), is_stopped)
    assert len(looks) == 21
    length, path = planner.shortest_path((1.0, 1.0), (98.0, 98.0))
    expected, points = DiscPlanner(blocked, 0.4).shortest_path((1.0, 1.0), (98.0, 98.0))
    assert length == expected
    np.testing.assert_array_equal(path, points)


def test_a_disc_that_is_cancelled_has_no_path(monkeypatch):
    planner = Planner(GridMap("random", random_blocks(100, 0.1)), robot_radius=0.4)
    monkeypatch.setattr(DiscPlanner, "shortest_path", lambda *_: (_ for _ in ()).throw(StoppedError))
    with pytest.raises(NoPathError, match="no path was known when planning was cancelled"):
        planner.plan((1.0, 1.0), (98.0, 98.0))


AT_THE_END = """
    import atexit, threading, time

    @atexit.register  # called after the planner's, which is registered later
    def plan_too_late():
        try:
            planner.plan((0.0, 0.0), (8.0, 8.0))
        except RuntimeError as error:
            print(error)

    import numpy as np
    from swarm_gym.errors import NoPathError
    from swarm_gym.planning import Planner
    from swarm_gym.planning.planning_run import PlanningRun
    from swarm_gym.scenarios import GridMap

    def run(self):
        while not self._is_stopped():
            time.sleep(0.001)
        time.sleep(0.5)  # what cannot be stopped
        print("a run has ended")

    planner = Planner(GridMap("empty", np.zeros((9, 9), dtype=np.bool_)))
    PlanningRun.run = run
    call = lambda: planner.plan((0.0, 0.0), (8.0, 8.0))
    threading.Thread(target=call, daemon=True).start()
    try:
        planner.plan((0.0, 0.0), (8.0, 8.0), max_seconds=0.1)
    except NoPathError:
        print("the program ends")
"""


def test_the_interpreter_waits_for_runs_when_it_ends():
    """Python frees compiled code and LLVM's objects at its end: a thread that used them crashed."""
    command = [sys.executable, "-c", textwrap.dedent(AT_THE_END)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
    expected = ["the program ends", "a run has ended", "a run has ended"]
    assert done.stdout.splitlines() == [
        *expected,
        "the interpreter ends: expected calls of plan before the program's end",
    ]
