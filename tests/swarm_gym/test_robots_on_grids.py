"""Plans of robots with a radius on grids: no longer than the exact path, and as far from blocked cells."""

import math

import numpy as np
import pytest
import shapely

from helpers.grids import area_of
from helpers.plans import assert_free, obstacles_of
from helpers.public_maps import needed
from helpers.robot_maps import door_map, office_map, write_ros_map
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.final_repair import FinalRepair
from swarm_gym.plan import main
from swarm_gym.planning import certificate, plan, search, tasks
from swarm_gym.planning.tasks import read_task
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.reference import shortest_robot_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.scenarios.formats.moving_ai import read_map
from swarm_gym.scenarios.formats.ros_map import read_ros_map

DOOR = {"start": (-1.5, 0.2), "goal": (1.5, 0.2), "max_evaluations": 1}


def assert_certified(found, margin):
    """The path is free, is not longer than the exact one, and keeps the margin, exactly."""
    assert_free(found, margin)
    resolution = found.map.map.resolution
    assert clearance_of(found.map, found.path) >= margin - 1e-9 * resolution
    assert shapely.LineString(found.path).distance(obstacles_of(found.map)) >= margin - 1e-8 * resolution
    length, _ = shortest_robot_path(found.map, margin)
    assert -1e-9 <= found.gap <= 3e-7
    assert found.gap == pytest.approx(found.length / length - 1.0, abs=1e-12)


@pytest.mark.parametrize(("cells", "radius"), [(9, 0.22), (10, 0.22), (10, 0.25), (9, 0.225)])
def test_a_robot_passes_a_door_that_it_fits_through(tmp_path, capsys, cells, radius):
    pytest.importorskip("yaml")
    file = write_ros_map(tmp_path, door_map(cells))
    found = plan(file, robot_radius=radius, **DOOR)
    assert found.map.map == door_map(cells)
    assert_certified(found, radius)
    assert found.length < 3.01
    arguments = ["--map", str(file), "--start=-1.5,0.2", "--goal=1.5,0.2", "--budget", "1"]
    assert main([*arguments, "--robot-radius", str(radius)]) == 0
    assert f"length       {found.length:.6g}" in capsys.readouterr().out
    assert main([*arguments, "--robot-radius", "0.2501"]) == 3
    assert "for a disc of diameter 0.5002" in capsys.readouterr().err


@pytest.mark.parametrize("seconds", [0.05, 1.0])
def test_the_way_of_a_robot_through_an_office_is_the_shortest_whatever_the_budget(tmp_path, seconds):
    pytest.importorskip("yaml")
    file = write_ros_map(tmp_path, office_map())
    found = plan(file, (-1.0, 0.8), (15.2, 11.0), robot_radius=0.2, clearance=0.05, max_seconds=seconds)
    assert_certified(found, 0.25)
    assert found.length == pytest.approx(23.0084, abs=1e-3)


def tasks_at_walls(number):
    """Yield tasks whose ends are often exactly as far from walls as the robot needs."""
    for seed in range(number):
        rng = np.random.default_rng(seed)
        blocked = rng.random((20, 24)) < 0.06
        cells = float(rng.choice([0.5, 0.7, 1.0]))
        made = GridMap("walls", blocked, 0.5)
        area = area_of(blocked)
        ring = np.array(shapely.get_coordinates(area.buffer(cells, quad_segs=1)))
        inside = (ring > -0.5).all(axis=1) & (ring < np.array([23.5, 19.5])).all(axis=1)
        points = ring[inside & (shapely.distance(shapely.points(ring), area) >= cells)]
        if len(points) > 1:
            start, goal = made.to_map(points[rng.choice(len(points), 2, replace=False)]).tolist()
            if start != goal:
                yield (
                    GridScenario("walls", GridMap("walls", blocked, 0.5), tuple(start), tuple(goal)),
                    cells / 2,
                )


def test_every_path_keeps_the_margin_also_from_ends_at_walls(monkeypatch):
    known = unknown = refused = 0
    for scenario, margin in tasks_at_walls(12):
        try:
            found = plan(scenario, robot_radius=margin, max_evaluations=1)
        except NoPathError:
            with pytest.raises(NoPathError):
                shortest_robot_path(scenario, margin)
            refused += 1
            continue
        assert_certified(found, margin)
        known += 1
        with monkeypatch.context() as patched:  # as on maps whose exact path takes too much work
            patched.setattr(tasks, "known_robot_path", lambda *_: None)
            try:
                found = plan(scenario, robot_radius=margin, max_evaluations=1)
            except NoPathError:
                continue
        assert found.gap is None
        assert found.found_by != "exact planner"
        assert clearance_of(scenario, found.path) >= margin - 1e-9
        assert found.length >= shortest_robot_path(scenario, margin)[0] - 1e-9
        unknown += 1
    assert known >= 6
    assert unknown >= known - 2


def test_a_path_that_is_too_close_at_its_ends_is_mended_there():
    wall = np.zeros((20, 30), dtype=np.bool_)
    wall[10:, 12] = True
    scenario = GridScenario("wall", GridMap("wall", wall), (10.5, 9.5), (26.0, 5.0))
    task = read_task(scenario, None, None, 1.0)
    corner = np.array([(10.5, 9.5), (11.6, 8.75), (26.0, 5.0)])
    assert clearance_of(scenario, corner) < 1.0
    mended = certificate.certified(task, corner)
    assert clearance_of(scenario, mended) >= 1.0 - 1e-9
    np.testing.assert_array_equal(mended[[0, -1]], corner[[0, -1]])
    backwards = certificate.certified(read_task(scenario, scenario.target, scenario.start, 1.0), corner[::-1])
    assert clearance_of(scenario, backwards) >= 1.0 - 1e-9
    through = np.array([(10.5, 9.5), (10.5, 15.0), (14.5, 15.0), (26.0, 5.0)])
    assert certificate.certified(task, through) is None


def test_a_robot_that_does_not_fit_has_no_path_and_the_diameter_is_named():
    with pytest.raises(NoPathError, match=r"for a disc of diameter 0.46, twice the robot's radius"):
        plan(GridScenario("door", door_map(9), (-1.5, 0.2), (1.5, 0.2)), robot_radius=0.2, clearance=0.03)
    with pytest.raises(ScenarioError, match=r"start \(-1.5, 0.2\) is 0.95 from the nearest blocked cell"):
        plan(GridScenario("door", door_map(9), (-1.5, 0.2), (1.5, 0.2)), robot_radius=2.0)


def test_rounding_to_cells_is_named_where_the_exact_path_is_unknown(monkeypatch):
    monkeypatch.setattr(tasks, "known_robot_path", lambda *_: None)
    scenario = GridScenario("door", door_map(9), (-1.5, 0.2), (1.5, 0.2))
    with pytest.raises(NoPathError, match=r"rounding to small cells closes.*diameter is 0.45.*finer"):
        assert read_task(scenario, None, None, 0.225).grown
    assert read_task(scenario, None, None, 0.22).grown.map.resolution == pytest.approx(0.01)


def test_an_exact_planner_stands_in_where_a_swarm_has_nothing(monkeypatch):
    scenario = make_scenario("rooms:0")
    monkeypatch.setattr(search, "final_repair", lambda *_: None)
    found = plan(scenario, robot_radius=0.4, max_evaluations=1)
    assert found.found_by == "exact planner"
    assert_certified(found, 0.4)
    with pytest.raises(NoPathError, match="no free path found"):
        plan(scenario, robot_radius=0.4, max_evaluations=1, planner="swarm")
    monkeypatch.setattr(tasks, "known_robot_path", lambda *_: None)
    found = plan(scenario, robot_radius=0.4, max_evaluations=1)
    assert found.found_by == "exact planner"
    assert clearance_of(scenario, found.path) >= 0.4 - 1e-9
    assert found.gap is None


def test_a_swarm_alone_keeps_its_path(monkeypatch):
    scenario = make_scenario("rooms:0")
    _, path = shortest_robot_path(scenario, 0.4)
    monkeypatch.setattr(search, "final_repair", lambda *_: FinalRepair(path, math.inf, 0, 0))
    found = plan(scenario, robot_radius=0.4, max_evaluations=1, planner="swarm")
    assert found.found_by != "exact planner"
    np.testing.assert_array_equal(found.path, path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "radius"), [("ros/turtlebot3_world.yaml", 0.105), ("movingai/den400d.map", 1.0)]
)
def test_paths_of_robots_on_public_maps_are_the_shortest(name, radius):
    file = needed(name)
    made = read_map(file) if file.suffix == ".map" else read_ros_map(file)
    rng, found = np.random.default_rng(0), 0
    sizes = np.bincount(made.components.ravel())
    sizes[0] = 0
    cells = np.argwhere(made.components == sizes.argmax())[:, ::-1]
    while found < 5:
        start, goal = made.to_map(cells[rng.choice(len(cells), 2, replace=False)]).tolist()
        try:
            planned = plan(file, tuple(start), tuple(goal), robot_radius=radius, max_evaluations=1)
        except ScenarioError:  # an end is too close to a wall, or the robot does not fit through
            continue
        assert_certified(planned, radius)
        found += 1
