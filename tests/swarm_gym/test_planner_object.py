"""The planner as an object: several threads, cancelling, time limits, no compiling when it plans."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numba.core import event

from helpers.plans import assert_free
from helpers.public_maps import needed
from helpers.slow import slow_but
from swarm_gym.errors import NoPathError, ScenarioError, SettingError
from swarm_gym.planning import GradedMap, Planner, plan
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.reference import shortest
from swarm_gym.scenarios import GridMap, make_scenario

LATE = 2.0  # seconds that a call may take on a machine that does much else; see docs/planning-programs.md


def blocks(seed=0):
    blocked = np.random.default_rng(seed).random((40, 50)) < 0.15
    blocked[:4], blocked[-4:], blocked[:, :4], blocked[:, -4:] = False, False, False, False
    return GridMap("blocks", blocked)


@pytest.mark.parametrize("where", slow_but(["case2"], ["rooms:0", "case2"]))
def test_plans_are_those_of_the_function(where):
    planner = Planner(where, robot_radius=0.3, clearance=0.1)
    for options in ({}, {"alternatives": 3}):
        one, other = planner.plan(**options), plan(where, robot_radius=0.3, clearance=0.1, **options)
        np.testing.assert_array_equal(one.path, other.path)
        assert (one.length, one.clearance, one.gap, one.found_by) == (
            other.length, other.clearance, other.gap, other.found_by
        )  # fmt: skip
        assert len(one.alternatives) == len(other.alternatives)
        assert not one.stopped


def test_a_file_is_read_once():
    pytest.importorskip("yaml", reason="needs the extra `maps`")
    file = needed("turtlebot3_world.yaml")
    planner = Planner(file, robot_radius=0.1, unknown="free")
    found = planner.plan((-2.0, -0.5), (2.0, 0.5))
    assert_free(found, 0.1)
    assert found.found_by == "exact planner"  # free cells have no costs
    assert planner.with_map(file).plan((-2.0, -0.5), (2.0, 0.5)).map.map == found.map.map
    assert Planner(file).plan((-2.0, -0.5), (2.0, 0.5)).map.map != found.map.map
    assert planner.plan((-2.0, 0.5), (2.0, 0.5)).map.map is found.map.map
    with pytest.raises(ScenarioError, match="no file"):
        Planner("nowhere.yaml")
    with pytest.raises(ScenarioError, match="expected a start and a goal"):
        planner.plan()


def test_several_threads_plan_at_a_time():
    grid = blocks()
    free = np.argwhere(~grid.inflated(0.6).blocked)[:, ::-1].astype(float)
    rng = np.random.default_rng(5)
    ends = [tuple(map(tuple, free[rng.integers(len(free), size=2)].tolist())) for _ in range(40)]

    def length(planner, pair):
        try:
            return planner.plan(*pair).length
        except NoPathError:
            return None

    shortest._disc_planner.cache_clear()  # so that the threads find tangents together
    with ThreadPoolExecutor(8) as pool:
        planner = Planner(grid, robot_radius=0.6)
        together = list(pool.map(lambda pair: length(planner, pair), ends))
    shortest._disc_planner.cache_clear()
    alone = Planner(grid, robot_radius=0.6)
    assert together == [length(alone, pair) for pair in ends]
    assert sum(one is not None for one in together) > 20


@pytest.mark.parametrize("margin", [0.0, 0.4])
@pytest.mark.parametrize("where", ["rooms:1", "case1"])
def test_nothing_is_compiled_when_it_plans(where, margin):
    planner = Planner(where, robot_radius=margin)
    with event.install_recorder("numba:compile") as recorder:
        found = planner.plan(alternatives=2)
        planner.plan(previous=found.path)
    assert recorder.buffer == []


@pytest.mark.parametrize("how", ["event", "method", "time"])
def test_a_swarm_that_would_plan_for_ever_is_ended(how):
    planner = Planner("caves:1")
    planner.plan(planner="swarm", max_evaluations=1)  # loads the kernels of the swarm
    cancel, limit = threading.Event(), 0.4 if how == "time" else None
    options = {"planner": "swarm", "max_evaluations": 10**9, "cancel": cancel, "max_seconds": limit}
    if how != "time":
        threading.Timer(0.4, cancel.set if how == "event" else planner.cancel).start()
    began = time.monotonic()
    found = planner.plan(**options)
    assert found.stopped
    assert_path_is_free(found)
    assert 0.3 < time.monotonic() - began < 0.4 + LATE
    again = planner.plan()  # others are not cancelled
    assert not again.stopped


def assert_path_is_free(found):
    assert plan(found.map, previous=found.path, switch_margin=1.0).length <= found.length * (1.0 + 1e-9)
    np.testing.assert_array_equal(found.path[[0, -1]], [found.map.start, found.map.target])


def test_what_is_known_is_returned_when_the_time_is_up(monkeypatch):
    """A calculation that cannot be stopped is left behind."""
    planner = Planner(blocks())
    path = planner.plan((0.0, 0.0), (49.0, 39.0)).path
    closed = blocks().blocked.copy()
    closed[:, 25] = True
    closed[0, 25] = False
    on_closed = planner.with_map(GridMap("closed", closed))
    waiting = threading.Event()
    monkeypatch.setattr(PlanningRun, "run", lambda _: waiting.wait())
    began = time.monotonic()
    with pytest.raises(NoPathError, match=r"no path was known when the time of 0.1 s was up"):
        planner.plan((0.0, 0.0), (49.0, 39.0), max_seconds=0.1)
    found = planner.plan((0.0, 0.0), (49.0, 39.0), max_seconds=0.1, previous=path)
    assert time.monotonic() - began < 0.2 + LATE
    np.testing.assert_array_equal(found.path, path)
    assert (found.found_by, found.stopped, found.gap, found.switched) == ("previous path", True, None, None)
    assert np.isnan(found.clearance)
    blocked_now = [(0.0, 0.0), (0.0, 39.0), (49.0, 39.0)]
    with pytest.raises(NoPathError, match="was up"):
        on_closed.plan((0.0, 0.0), (49.0, 39.0), max_seconds=0.1, previous=blocked_now)
    waiting.set()


def test_a_robot_beside_its_path_goes_on_from_there():
    planner = Planner("rooms:0")
    scenario = make_scenario("rooms:0")
    path = planner.plan().path
    middle = path[:2].mean(axis=0)
    found = planner.plan(tuple(middle.tolist()), scenario.target, previous=path)
    assert found.length == pytest.approx(planner.plan().length - np.hypot(*(middle - path[0])))
    assert found.switched is False


def test_a_planner_on_another_map_keeps_robot_and_wishes():
    grid = blocks()
    planner = Planner(grid, robot_radius=0.6, clearance=0.1, wishes={"distance": 1.0})
    other = planner.with_map(GridMap("empty", np.zeros_like(grid.blocked)))
    found = other.plan((1.0, 1.0), (40.0, 30.0))
    assert found.costs["sum"] == found.costs["length"] == pytest.approx(np.hypot(39.0, 29.0))
    ground = planner.with_map(GradedMap(grid, np.ones(grid.blocked.shape)))
    assert ground.plan((1.0, 1.0), (46.0, 36.0)).clearance >= 0.7 - 1e-9


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Planner("rooms:0", robot_radius=-1.0), "robot_radius must lie in"),
        (lambda: Planner("rooms:0", wishes={"distance": -1}), "weight of distance"),
        (lambda: Planner("rooms:0", switch_margin=2.0), "switch_margin"),
        (lambda: Planner("rooms:0").plan(cancel=3), "cancel must be a threading.Event, got 3"),
        (lambda: Planner("rooms:0").plan(max_seconds=0.0), "max_seconds must lie in"),
        (lambda: Planner("rooms:0").plan((5.0, 5.0), previous="path"), "previous: expected points"),
    ],
)
def test_values_that_are_invalid_are_refused(make, words):
    with pytest.raises(SettingError, match=words):
        make()
