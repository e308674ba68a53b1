"""Robots that drive along the best path so far, with every optimizer but glowworms."""

import itertools

import numpy as np
import pytest
import shapely
from gymnasium.vector import AutoresetMode
from test_dynamic_environments import (
    OPEN,
    SEED,
    actions,
    assert_goes_on_alike,
    assert_same_steps,
    assert_what_is_stored_is_true,
    copied,
    episode,
)

from helpers.builders import (
    ALIKE,
    random_circle,
    random_grid_scenario,
    random_path,
    random_polygon,
    random_scenario,
    slow_if_alike,
    small_grid_problem,
)
from helpers.loops import looped
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError, SettingError, StepOrderError
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.problem import AnalyticProblem, GridProblem
from swarm_gym.problem.geometry.polylines import is_clear
from swarm_gym.problem.geometry.rotated_axes import resampled
from swarm_gym.problem.tables import put, stack
from swarm_gym.rendering import Scene
from swarm_gym.robots import piece_of
from swarm_gym.scenarios import (
    Appear,
    Circle,
    Disappear,
    Drive,
    DynamicScenario,
    Polygon,
    Scenario,
    expand_name,
    make_scenario,
)
from swarm_gym.vector_env import SwarmVectorEnv

ITERATIONS = 8
SMALL = {"initial_population_size": 8, "max_population_size": 20, "iterations": ITERATIONS}
TOLERANCE = 1e-9  # how deep a path may enter obstacles, in map units
FREE = Scenario("free", (20.0, 300.0), (980.0, 300.0), (Circle(500, 560, 30),), initial_range=(-90.0, 90.0))
ON_THE_WAY = DynamicScenario(
    "on-the-way",
    FREE,
    [Appear(2, Polygon.rectangle(700, 200, 720, 330)), Appear(5, Circle(800, 250, 30)), Disappear(6, 1)],
    Drive(2, 2, 150.0),
)
ON_CELLS = DynamicScenario(
    "on-cells", OPEN, [Appear(3, Polygon.rectangle(19, 5, 21, 12)), Disappear(6, 0)], Drive(1, 2, 4.5)
)

DRIVING = [name for name in OPTIMIZERS if not get_optimizer(name).begins_with_robot]

all_optimizers = pytest.mark.parametrize("optimizer", [slow_if_alike(name) for name in DRIVING])


def small(optimizer="firefly", **options):
    return SwarmEnv(optimizer, **{**SMALL, "scenario": ON_THE_WAY, **options})


def on_maps(optimizer):
    """Return options of environments in which robots drive and which the optimizer accepts."""
    found = []
    for options in (
        {"scenario": ON_THE_WAY},
        {"scenario": ON_CELLS, "encoding": "bezier"},
        {"scenario": ON_CELLS, "encoding": "waypoints", "num_waypoints": 7},
        {"scenario": ON_CELLS, "encoding": "walk"},
    ):
        try:
            small(optimizer, **options)
        except ValueError as refused:
            assert "encoding" in str(refused)  # noqa: PT017
            continue
        found.append(options)
    assert found
    return found


def random_problem(seed, encoding):
    if encoding == "analytic":
        return AnalyticProblem(random_scenario(np.random.default_rng(seed)), 7)
    return GridProblem(random_grid_scenario(seed, shape=(30, 40)), encoding, 5)


def somewhere(rng, problem):
    """Return a free point of the map that is not the target."""
    x_min, y_min, x_max, y_max = problem.scenario.workspace
    while True:
        place = tuple(rng.uniform((x_min, y_min), (x_max, y_max)).tolist())
        try:
            return problem.begun_at(place)
        except ScenarioError:
            continue


# Pieces.


def test_a_piece_is_the_first_part_of_a_path_that_is_so_long():
    path = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 10.0], [13.0, 10.0]])
    for distance, expected in (
        (2.5, [[0, 0], [1.5, 2]]),
        (5.0, [[0, 0], [3, 4]]),
        (8.0, [[0, 0], [3, 4], [3, 7]]),
        (20.0, [[0, 0], [3, 4], [3, 10], [12, 10]]),
    ):
        piece, arrives = piece_of(path, distance)
        np.testing.assert_allclose(piece, expected)
        assert not arrives
    for distance in (21.0, 21.0 - 1e-12, 100.0):
        piece, arrives = piece_of(path, distance)
        assert piece is path
        assert arrives


@looped("seed", range(20))
def test_pieces_that_enter_an_obstacle_are_not_clear_as_in_shapely(seed):
    rng = np.random.default_rng(seed)
    for _ in range(30):
        obstacle = (random_circle if rng.random() < 0.5 else random_polygon)(rng, (0.0, 0.0), 10.0)
        points = rng.uniform(-15, 15, (rng.integers(2, 5), 2))
        line = shapely.LineString(points)
        if isinstance(obstacle, Circle):
            gap = line.distance(shapely.Point(obstacle.x, obstacle.y)) - obstacle.radius
            assert is_clear(points, [obstacle], TOLERANCE) == (gap >= 0.0)
        else:
            shape = shapely.Polygon(obstacle.vertices)
            assert is_clear(points, [obstacle], TOLERANCE) == (line.intersection(shape).length == 0.0)


def test_what_touches_is_clear_and_what_enters_is_not():
    square, disc = Polygon.rectangle(0, 0, 10, 10), Circle(0, 0, 5)
    for points, obstacle, expected in (
        ([(-5, 10), (15, 10)], square, True),
        ([(-5, 10 - 1e-6), (15, 10 - 1e-6)], square, False),
        ([(-5, 15), (5, 10), (15, 15)], square, True),
        ([(2, 3), (4, 5)], square, False),
        ([(0, 0), (10, 10)], square, False),
        ([(-9, 5), (9, 5)], disc, True),
        ([(-9, 5 - 1e-6), (9, 5 - 1e-6)], disc, False),
        ([(5, 0), (9, 0)], disc, True),
        ([(1, 1), (1, 1)], disc, False),
    ):
        assert is_clear(np.array(points, dtype=np.float64), [obstacle], TOLERANCE) == expected, (
            points,
            obstacle,
        )
    assert not is_clear(np.array([(-9.0, 5.0), (9.0, 5.0)]), [disc, square], TOLERANCE)


# Paths carried over to other starts.


def last_offset(path, start, target, x):
    """Return y' of the point at which a path passes x' for the last time, in plain Python."""
    length = np.hypot(target[0] - start[0], target[1] - start[1])
    cosine, sine = (target[0] - start[0]) / length, (target[1] - start[1]) / length
    found = None
    points = [
        ((px - start[0]) * cosine + (py - start[1]) * sine, (py - start[1]) * cosine - (px - start[0]) * sine)
        for px, py in [start, *path]
    ]
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        if (x0 <= x) != (x1 <= x):
            found = y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return found


@looped("seed", range(10))
def test_paths_pass_the_new_waypoints_where_they_pass_last(seed):
    rng = np.random.default_rng(seed)
    before = random_problem(seed, "analytic")
    after = somewhere(rng, before)
    paths = np.array([before.points(random_path(rng, before)) for _ in range(8)])
    found = resampled(paths, after.scenario, 7)
    length = after.scenario.straight_line
    for path, offsets in zip(paths, found, strict=True):
        for j, offset in enumerate(offsets, 1):
            ends = after.scenario.start, after.scenario.target
            assert offset == pytest.approx(last_offset(path.tolist(), *ends, length * j / 8), abs=1e-8)


@pytest.mark.parametrize("encoding", ["analytic", "waypoints"])
def test_a_robot_on_a_path_keeps_the_rest_of_it(encoding):
    """Check that new waypoints lie on the old path, or at the edge of the map."""
    rng = np.random.default_rng(1)
    for seed in range(10):
        before = random_problem(seed, encoding)
        vector = 0.1 * random_path(rng, before)
        path = before.points(vector)
        piece, _ = piece_of(path, rng.uniform(0.1, 0.6) * before.scenario.straight_line)
        try:
            after = before.begun_at(tuple(piece[-1].tolist()))
        except ScenarioError:
            continue
        (carried,) = after.carried_over(vector[None], before)
        lower, upper = after.bounds
        assert ((lower <= carried) & (carried <= upper)).all()
        inside = (lower < carried) & (carried < upper)
        rest = shapely.LineString(path)
        for point, is_inside in zip(after.points(carried)[1:-1], inside, strict=True):
            assert not is_inside or rest.distance(shapely.Point(point)) < 1e-7
        assert inside.any()


def test_control_points_stay_where_they_are():
    before = small_grid_problem("bezier", 3)
    after = somewhere(np.random.default_rng(0), before)
    vectors = np.random.default_rng(0).uniform(*before.bounds, (5, 6))
    np.testing.assert_array_equal(after.carried_over(vectors, before), vectors)
    assert after.points(vectors)[:, 0].tolist() == [list(after.scenario.start)] * 5


@pytest.mark.parametrize("encoding", ["analytic", "waypoints", "bezier"])
def test_the_same_problem_from_another_start_is_bounded_as_from_anywhere(encoding):
    rng = np.random.default_rng(2)
    for seed in range(5):
        before = random_problem(seed, encoding)
        after = somewhere(rng, before)
        assert after.scenario.target == before.scenario.target
        assert after.dimension == before.dimension
        anywhere = before.collision_bound_anywhere
        assert anywhere >= max(before.collision_bound, after.collision_bound)
        for _ in range(20):
            assert after.evaluate(rng.uniform(*after.bounds))[1] <= anywhere


@pytest.mark.parametrize("encoding", ["analytic", "waypoints"])
def test_a_table_put_into_a_row_is_as_if_stacked(encoding):
    """Check tables that need more room than the others, and tables that need less."""
    rng = np.random.default_rng(3)
    first = random_problem(0, encoding)
    for _ in range(6):
        problems = [somewhere(rng, first) for _ in range(3)]
        tables = stack([first.table] * 3)
        for row, problem in enumerate(problems):
            tables = put(tables, row, problem.table)
        for field, found, expected in zip(
            tables._fields, tables, stack([p.table for p in problems]), strict=True
        ):
            assert found.dtype == expected.dtype
            common = tuple(map(slice, np.minimum(found.shape, expected.shape)))
            np.testing.assert_array_equal(found[common], expected[common], err_msg=field)
            found[common] = 0
            assert not found.any()


# Episodes.


# Other encodings compile their kernels first.
QUICK = ("firefly", "ant-colony")


@pytest.mark.parametrize(
    "optimizer", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in DRIVING]
)
def test_robots_drive_and_what_is_stored_is_true_from_where_they_are(optimizer):
    for options in on_maps(optimizer):
        env = small(optimizer, **options)
        drive = options["scenario"].drive
        _, info = env.reset(seed=SEED)
        assert tuple(info["robot"]) == options["scenario"].base.start
        moves = 0
        for iteration, action in enumerate(actions(SEED, ITERATIONS, optimizer), 1):
            place, driven, way = info["robot"], info["driven"], env.simulation.trajectory(0)
            observation, reward, terminated, _, info = env.step(action)
            assert observation in env.observation_space
            assert np.isfinite(reward)
            problem = env.simulation.problem_of(0)
            is_time = iteration >= drive.first and (iteration - drive.first) % drive.every == 0
            if (info["robot"] == place).all():
                assert info["driven"] == driven
            else:
                moves += 1
                assert is_time
                new = env.simulation.trajectory(0)[len(way) - 1 :]
                assert problem.is_clear(new)
                assert shapely.LineString(new).length == pytest.approx(info["driven"] - driven)
                if not terminated:
                    assert info["driven"] - driven == pytest.approx(drive.distance)
            if not terminated:
                assert problem.scenario.start == tuple(info["robot"])
            assert info["best_path"][0].tolist() == list(problem.scenario.start)
            assert_what_is_stored_is_true(optimizer, env.simulation)
            if terminated:
                break
        assert moves > 1


@pytest.mark.slow  # compiles its kernels first
@all_optimizers
def test_a_robot_that_never_drives_changes_nothing(optimizer):
    for options in on_maps(optimizer):
        scenario = options["scenario"]
        late = DynamicScenario("late", scenario.base, scenario.events, Drive(ITERATIONS, 1, 5.0))
        still = DynamicScenario("still", scenario.base, scenario.events)
        decisions = actions(SEED, ITERATIONS, optimizer)
        steps = [
            episode(small(optimizer, **{**options, "scenario": one}), decisions=decisions)
            for one in (late, still)
        ]
        assert_same_steps(*steps)


def test_driving_costs_as_many_evaluations_as_there_is_remembered():
    for optimizer, remembered in (("firefly", 1), ("particle-swarm", 2)):
        driving = DynamicScenario("driving", FREE, (), Drive(1, 5, 100.0))
        spent = [
            episode(small(optimizer, scenario=scenario), decisions=[[9, 0.0]])[-1][2]["evaluations"]
            for scenario in (driving, FREE)
        ]
        assert spent[0] - spent[1] == remembered * 9 + 1


def test_the_episode_ends_when_the_robot_arrives():
    env = small("particle-swarm", scenario=DynamicScenario("short", FREE, (), Drive(1, 1, 300.0)))
    env.reset(seed=SEED, options={"initial_population": np.zeros((8, 31))})
    driven = []
    terminated = False
    while not terminated:
        _, _, terminated, _, info = env.step(np.array([8, 0.0]))
        driven.append(info["driven"])
    assert driven[:3] == [300.0, 600.0, 900.0]
    assert driven[3] == pytest.approx(960.0, abs=5.0)
    assert len(driven) == 4 < ITERATIONS
    assert tuple(info["robot"]) == FREE.target
    assert "optimality_gap" not in info
    with pytest.raises(StepOrderError, match="ended"):
        env.step(np.array([8, 0.0]))
    assert env.reset(seed=1)[1]["robot"].tolist() == list(FREE.start)


def straight_ahead(scenario, **options):
    """Return an episode of fireflies that are all on the straight line and stay there."""
    env = small(scenario=scenario, **options)
    env.reset(seed=0, options={"initial_population": np.zeros((2, 31))})
    return env


def test_a_robot_waits_before_what_is_in_its_way():
    """Check an obstacle that repair does not lead around."""
    wall = (Polygon.rectangle(400, 0, 420, 310), Polygon.rectangle(400, 305, 420, 600))
    closed = Scenario("closed", FREE.start, FREE.target, wall)
    env = straight_ahead(DynamicScenario("waiting", closed, (), Drive(1, 1, 120.0)))
    places, spent = [], []
    for _ in range(5):
        _, _, _, _, info = env.step(np.array([2, 0.0]))
        places.append(info["robot"].tolist())
        spent.append(info["evaluations"])
    assert places == [[140.0, 300.0], [260.0, 300.0]] + [[380.0, 300.0]] * 3
    assert spent[2:] == [spent[2]] * 3


def test_a_robot_drives_the_repaired_path_where_that_is_free():
    """Check that an obstacle which the best path only grazes does not stop the robot."""
    grazed = Scenario("grazed", FREE.start, FREE.target, (Circle(500, 250, 50.3),))
    env = straight_ahead(DynamicScenario("grazing", grazed, (), Drive(1, 1, 600.0)))
    problem = env.simulation.problem_of(0)
    assert not problem.is_clear(problem.points(np.zeros(31)))
    _, _, _, _, info = env.step(np.array([2, 0.0]))
    assert info["robot"][0] == pytest.approx(620.0, abs=1.0)
    assert problem.is_clear(env.simulation.trajectory(0))
    assert env.simulation.trajectory(0)[:, 1].max() > 300.2


def test_a_robot_drives_the_best_feasible_path_where_neither_the_best_nor_its_repair_is_free():
    high = Scenario(
        "high",
        FREE.start,
        FREE.target,
        (Polygon.rectangle(500, 150, 520, 310), Polygon.rectangle(500, 305, 520, 590)),
    )
    env = straight_ahead(DynamicScenario("around", high, (), Drive(1, 1, 600.0)))
    problem, swarms = env.simulation.problem_of(0), env.simulation.swarms
    assert not problem.is_clear(problem.points(problem.repaired(np.zeros(31), 1.0)))
    around = -200.0 * np.sin(np.linspace(0.0, np.pi, 33)[1:-1])
    assert problem.is_clear(problem.points(around))
    swarms.feasible_position[0, :31], swarms.feasible_fitness[0] = around, 350.0
    _, _, _, _, info = env.step(np.array([2, 0.0]))
    assert info["driven"] == pytest.approx(600.0)
    assert problem.is_clear(env.simulation.trajectory(0))
    assert env.simulation.trajectory(0)[:, 1].min() < 110.0


def test_what_would_come_down_on_a_robot_waits_until_it_has_driven_on():
    events = [Appear(3, Circle(320, 300, 40)), Appear(4, Circle(700, 150, 40))]
    env = straight_ahead(DynamicScenario("waiting", FREE, events, Drive(1, 4, 300.0)))
    numbers = []
    for _ in range(6):
        env.step(np.array([2, 0.0]))
        numbers.append(len(env.simulation.problem_of(0).scenario.obstacles))
    # The robot is at (320, 300) until iteration 5 is done; then one comes after the other.
    assert numbers == [1, 1, 1, 1, 1, 2]
    env.step(np.array([2, 0.0]))
    assert len(env.simulation.problem_of(0).scenario.obstacles) == 3


@pytest.mark.parametrize("optimizer", slow_but(["firefly"], DRIVING))
def test_a_budget_may_end_anywhere_in_what_is_carried_over(optimizer):
    (options, *_) = on_maps(optimizer)
    driving = DynamicScenario("driving", options["scenario"].base, (), Drive(1, 5, 1.0))
    still = small(optimizer, **{**options, "scenario": driving.base})
    before = episode(still, decisions=[[8, 0.0]])[-1][2]["evaluations"]
    for left in range(20):
        env = small(optimizer, **{**options, "scenario": driving}, max_evaluations=before + left)
        _, _, info = episode(env, decisions=[[8, 0.0]] * 4)[-1]
        assert info["evaluations"] == before + left
        assert (info["driven"] > 0) == (left > 0)  # otherwise the episode ended before
        assert_what_is_stored_is_true(optimizer, env.simulation)


# Same seed, same bits.


def scenarios_of(options):
    return [options["scenario"], options["scenario"].base]


@pytest.mark.parametrize(
    "optimizer", slow_but([name for name in DRIVING if name not in (*ALIKE, "ant-colony")], DRIVING)
)
@pytest.mark.parametrize("place", [0, pytest.param(1, marks=pytest.mark.slow)], ids=["first-map", "cells"])
def test_episodes_are_the_same_in_a_vector_with_threads_as_alone(optimizer, place, numba_threads):
    for options in on_maps(optimizer)[place : place + 1]:
        mixed = {**options, "scenario": scenarios_of(options)}
        decisions = [actions(SEED + row, ITERATIONS, optimizer) for row in range(4)]
        alone = [
            episode(small(optimizer, **mixed), SEED + row, decision) for row, decision in enumerate(decisions)
        ]
        envs = SwarmVectorEnv(
            4,
            optimizer,
            num_threads=min(numba_threads, 2),
            autoreset_mode=AutoresetMode.DISABLED,
            **{**SMALL, **mixed},
        )
        envs.reset(seed=SEED)
        for k, decision in enumerate(np.stack(decisions, axis=1), 1):
            observations, rewards, ended = envs.step_running(decision)
            robots = envs.simulation.robots
            for row, steps in enumerate(alone):
                if k < len(steps):
                    np.testing.assert_array_equal(observations[row], steps[k][0])
                    assert rewards[row] == steps[k][1]
                    np.testing.assert_array_equal(robots.places[row], steps[k][2]["robot"])
                    assert robots.driven[row] == steps[k][2]["driven"]
                    assert ended[row] == (k == len(steps) - 1)
        names = [steps[0][2]["scenario"] for steps in alone]
        assert len(set(names)) == 2
        for row, name in enumerate(names):
            assert (robots.driven[row] > 0) == (name == options["scenario"].name)


@copied
@pytest.mark.parametrize("optimizer", slow_but(["particle-swarm"], ["firefly", "particle-swarm"]))
def test_a_copy_made_on_the_way_goes_on_alike(duplicate, optimizer):
    env = small(optimizer)
    env.reset(seed=SEED)
    decisions = actions(SEED, ITERATIONS)
    for action in decisions[:3]:
        _, _, _, _, info = env.step(action)
    assert info["driven"] > 0
    assert_goes_on_alike(env, duplicate(env), decisions[3:])


def test_copied_swarms_go_on_from_where_the_robot_of_the_original_is():
    envs = SwarmVectorEnv(4, scenario=[ON_THE_WAY, "case2"], autoreset_mode=AutoresetMode.DISABLED, **SMALL)
    envs.reset(seed=[0, 1, 2, 3])
    for _ in range(3):
        envs.step(np.tile([8, 0.5], (4, 1)))
    simulation = envs.simulation
    driven = simulation.robots.driven
    drivers, others = np.flatnonzero(driven > 0), np.flatnonzero(driven == 0)
    assert len(drivers) > 0 < len(others)
    source, other = int(drivers[-1]), int(others[0])
    rows = np.array([source, other, source, source])
    expected = simulation.robots.places[rows].copy(), [simulation.trajectory(row) for row in rows]
    observations = envs.copy_swarms(rows)
    np.testing.assert_array_equal(observations, observations[[0, 1, 0, 0]])
    np.testing.assert_array_equal(simulation.robots.places, expected[0])
    for row, way in enumerate(expected[1]):
        np.testing.assert_array_equal(simulation.trajectory(row), way)
        assert simulation.problem_of(row).scenario.start == tuple(way[-1].tolist())
    for _ in range(3):
        observations, rewards, *_ = envs.step(np.tile([8, 0.5], (4, 1)))
        np.testing.assert_array_equal(observations, observations[[0, 1, 0, 0]])
        assert (rewards == rewards[[0, 1, 0, 0]]).all()
    # Each swarm has a problem of its own, so that one of them can continue differently.
    assert len(set(simulation.swarms.problem[[0, 2, 3]])) == 3


# Errors, and pictures.


@pytest.mark.parametrize(
    "numbers",
    [(0, 1, 1.0), (1, 0, 1.0), (1, 1, 0.0), (1, 1, -3.0), (1.5, 1, 1.0), (1, 1, np.inf), (1, 1, "far")],
)
def test_other_than_valid_numbers_are_refused(numbers):
    with pytest.raises(SettingError, match=r"Drive\(.*(first|every|distance)"):
        Drive(*numbers)


def test_only_a_drive_tells_how_a_robot_drives_and_no_reward_may_need_the_optimum():
    with pytest.raises(ScenarioError, match="drive must be"):
        DynamicScenario("made", FREE, (), (1, 2, 3.0))
    with pytest.raises(SettingError, match="optima"):
        small(reward="optimality")


def test_the_name_says_how_the_robot_drives():
    made = make_scenario("dynamic:case1-block@70-drive@40,every=5,distance=60.5")
    assert made.drive == Drive(40, 5, 60.5)
    assert made.events == make_scenario("dynamic:case1-block@70").events
    alone = make_scenario("dynamic:case2-drive@1,every=10,distance=7")
    assert (alone.base, alone.events, alone.drive) == (make_scenario("case2"), (), Drive(1, 10, 7.0))
    assert expand_name("dynamic:random-fields:test:3-4-drive@1,every=2,distance=30") == (
        "dynamic:random-fields:test:3-drive@1,every=2,distance=30",
        "dynamic:random-fields:test:4-drive@1,every=2,distance=30",
    )


NO_NAMES = ["dynamic:case1-drive@40", "dynamic:function:easom-2-drive@5,every=5,distance=1"]
NO_DRIVES = ("0,every=5,distance=60", "5,every=0,distance=60", "5,every=5,distance=60.0", "5,every=5",
             "5,every=5,distance=-1", "5,every=5,distance=60-block@70", "5,every=5,distance=0")  # fmt: skip


@pytest.mark.parametrize("name", [*NO_NAMES, *(f"dynamic:case1-drive@{drive}" for drive in NO_DRIVES)])
def test_other_names_are_refused(name):
    with pytest.raises(ValueError, match=r"case1|easom|distance"):
        make_scenario(name)


def test_pictures_show_where_the_robot_is_and_has_driven():
    env = small(render_mode="rgb_array")
    env.reset(seed=SEED)
    assert Scene.of(env.simulation).trajectory.tolist() == [list(FREE.start)]
    for action in actions(SEED, 3):
        env.step(action)
    scene = Scene.of(env.simulation)
    assert len(scene.trajectory) > 1
    assert scene.scenario.start == tuple(scene.trajectory[-1].tolist())
    before = env.render()
    env.step(np.array([8, 0.0]))
    assert (env.render() != before).any()
    still = SwarmEnv(scenario="case1", **SMALL)
    still.reset(seed=SEED)
    assert Scene.of(still.simulation).trajectory.shape == (0, 2)
