"""The glowworms of Brand and Yu: every option against plain Python, the robot, arrivals, maps that change."""

import gymnasium
import numpy as np
import pytest
from test_optimizers import run
from test_re_evaluation import change

from helpers.builders import (
    METRES,
    advance,
    assert_same_as_oracle,
    begin,
    oracle_twin,
    random_grid_scenario,
    walk_problem,
)
from helpers.grids import drawn_problem
from helpers.loops import looped
from helpers.slow import slow_but
from oracles import naive_swarm
from swarm_gym.action import make_action
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers.glowworm.glowworm import Glowworm
from swarm_gym.problem import WalkProblem
from swarm_gym.problem.geometry.traversal import path_is_free, segment_is_free
from swarm_gym.problem.tables import stack
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.settings import Settings

OPTIONS = [
    {},
    {"glow": "sight"},
    {"glow": "distance"},
    {"dimming": "exponential"},
    {"selection": "proportional"},
    {"selection": "proportional", "levels": "differences", "dimming": "exponential"},
    {"range_rule": "adaptive", "decision_range": 0.5},
    {"range_rule": "adaptive", "selection": "proportional", "glow": "distance", "gain": 3.0},
    {"wandering": "anywhere"},
    {"wandering": "anywhere", "selection": "proportional"},
    {"decision_range": 0.25, "absorption": 50.0},
    {"decay": 0.0, "dimming": "exponential", "absorption": 1000.0},
    {"decay": 0.0, "selection": "proportional", "levels": "differences"},
    {"gain": 0.0, "first_luciferin": 0.0},
]


def way_of(swarms, problem):
    """Return the best path so far, in cells."""
    points = [*swarms.walk[0, : swarms.best_walk[0]], problem.scenario.target]
    return problem.scenario.map.to_cells(points)


@pytest.mark.parametrize("parameters", slow_but(OPTIONS[::3], OPTIONS), ids=str)
def test_episodes_with_other_parameters_are_the_naive_ones(parameters):
    """The episodes are long enough for members to meet, and for some robots to arrive."""
    for seed, geometry in enumerate(({}, METRES)):
        problem = walk_problem("random", seed, shape=(9, 14), **geometry)
        plan = [(8, 0.5), (8, 0.0), (12, 0.0), (10, 1.0), (5, 0.0)] * 6
        options = {"size": 9, "seed": seed, "iterations": len(plan)}
        run("glowworm", problem, plan, {"step": 0.05, **parameters}, **options)


@pytest.mark.parametrize("seed", range(3))
def test_whole_episodes_up_to_the_arrival_are_the_naive_ones(seed):
    problem = WalkProblem(make_scenario("block:50"))
    plan = [(10, 0.0)] * 100
    options = {"size": 10, "seed": seed, "iterations": len(plan)}
    swarms, twin = run("glowworm", problem, plan, {"step": 0.03}, **options)
    assert swarms.budget[0] == swarms.evaluations[0] == twin.budget
    assert swarms.positions[0, 0, :2].tolist() == list(problem.scenario.target)
    assert (swarms.fitness[0, 0], swarms.best_collision[0]) == (0.0, 0.0)
    assert path_is_free(problem.scenario.map.blocked, way_of(swarms, problem))


WALL = (
    ".......",
    ".......",
    "######.",
    ".......",
    ".......",
)


@looped("seed", range(12))
def test_a_step_that_is_longer_than_a_wall_is_thick_leads_nobody_through_it(seed):
    problem = drawn_problem(*WALL, start=(1.0, 1.0), target=(1.0, 3.0))
    options = {"size": 5, "seed": seed, "iterations": 12}
    swarms, _ = run("glowworm", problem, [(5, 0.0)] * 12, {"step": 0.3}, **options)
    assert path_is_free(problem.scenario.map.blocked, way_of(swarms, problem)) == (
        swarms.best_collision[0] == 0.0
    )


def with_obstacle(scenario, point):
    """Return the scenario with more blocked cells around a point."""
    grid = scenario.map
    column, row = grid.cell_of(point)
    blocked = grid.blocked.copy()
    blocked[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2] = True
    for end in (scenario.start, scenario.target):
        column, row = grid.cell_of(end)
        blocked[row, column] = False
    changed = GridMap("changed", blocked, grid.resolution, grid.origin, grid.y_up)
    return GridScenario("changed", changed, scenario.start, scenario.target)


@pytest.mark.parametrize("geometry", [{}, METRES])
def test_a_robot_in_a_new_obstacle_goes_on_beside_it_as_naive(geometry):
    scenario = random_grid_scenario(1, shape=(20, 30), rock=0.05, **geometry)
    problem, parameters = WalkProblem(scenario), {"step": 0.03}
    options = {"size": 8, "iterations": 30}
    swarms, tables = begin("glowworm", [problem], **options)
    twin = oracle_twin("glowworm", problem, **options, parameters=parameters)

    def go_on(steps):
        for _ in range(steps):
            values = advance("glowworm", swarms, tables, 8, 0.0, parameters)
            twin.step(8, 0.0, values)
            assert_same_as_oracle(swarms, twin)

    go_on(10)
    here = swarms.positions[0, 0, :2].copy()
    other = WalkProblem(with_obstacle(scenario, here.tolist()))
    assert not other.scenario.map.is_free(other.scenario.map.cell_of(here.tolist()))
    tables = stack([problem.table, other.table])
    for number, now in enumerate([other, problem, other, problem]):
        change("glowworm", swarms, tables, (number + 1) % 2)
        twin.re_evaluate(naive_swarm.oracle_of(now))
        assert_same_as_oracle(swarms, twin)
        robot = swarms.positions[0, 0, :2]
        assert now.scenario.map.is_free(now.scenario.map.cell_of(robot.tolist()))
        walked = swarms.walk[0, : swarms.walked[0]]
        assert (walked[-1] == robot).all()
        robots = np.linalg.norm(np.diff(walked, axis=0), axis=1).sum() + swarms.fitness[0, 0]
        assert swarms.best_fitness[0] <= robots * (1 + 1e-9)
        go_on(2)


def test_the_way_out_of_a_new_obstacle_is_part_of_the_path():
    """The path of the robot is the best if the others are blocked."""
    before = np.zeros((9, 30), dtype=np.bool_)
    after = before.copy()
    problem = WalkProblem(GridScenario("open", GridMap("open", before), (2.0, 4.0), (27.0, 4.0)))
    options, parameters = {"size": 5, "iterations": 40}, {"step": 0.03}
    swarms, tables = begin("glowworm", [problem], **options)
    twin = oracle_twin("glowworm", problem, **options, parameters=parameters)
    while swarms.positions[0, 0, 0] < 8.0:
        values = advance("glowworm", swarms, tables, 5, 0.0, parameters)
        twin.step(5, 0.0, values)
    column, row = problem.scenario.map.cell_of(swarms.positions[0, 0, :2].tolist())
    after[row - 1 : row + 2, 4 : column + 1] = True
    other = WalkProblem(GridScenario("blocked", GridMap("blocked", after), (2.0, 4.0), (27.0, 4.0)))
    change("glowworm", swarms, stack([problem.table, other.table]), 1)
    twin.re_evaluate(naive_swarm.oracle_of(other))
    assert_same_as_oracle(swarms, twin)
    assert (swarms.best_position[0, :2] == swarms.positions[0, 0, :2]).all()
    assert swarms.best_walk[0] == swarms.walked[0]
    assert swarms.best_collision[0] == 0.0


def small_env(**options):
    sizes = {"initial_population_size": 8, "max_population_size": 20}
    return gymnasium.make("swarm_gym/Glowworm-v0", **{"scenario": "block:50", **sizes, **options})


def test_the_robot_begins_at_the_start_and_is_never_deleted():
    """Growing and shrinking leave the robot at its place, as the first member, even far from the target."""
    problem = walk_problem("random", 2)
    swarms, tables = begin("glowworm", [problem], 12, iterations=30)
    assert swarms.positions[0, 0, :2].tolist() == list(problem.scenario.start)
    for size in (12, 3, 2, 15, 2, 6, 2):
        here = swarms.positions[0, 0, :2].copy()
        advance("glowworm", swarms, tables, size, 0.0, {"step": 0.01})
        assert swarms.size[0] == size
        walk = swarms.walk[0, : swarms.walked[0]]
        assert (walk[-1] == swarms.positions[0, 0, :2]).all()
        side = max(problem.scenario.map.width, problem.scenario.map.height)
        assert np.linalg.norm(walk[-1] - here) <= 0.01 * side * (1 + 1e-9)
    assert (swarms.walk[0, 0] == problem.scenario.start).all()


@pytest.mark.parametrize("selection", ["brightest", "proportional"])
def test_nobody_walks_into_an_obstacle(selection):
    """Members neither stop in an obstacle nor cross one."""
    problem = walk_problem("random", 6, rock=0.3)
    grid, parameters = problem.scenario.map, {"step": 0.03, "selection": selection}
    swarms, tables = begin("glowworm", [problem], 16, iterations=25)
    for _ in range(25):
        before = grid.to_cells(swarms.positions[0, :16, :2])
        advance("glowworm", swarms, tables, 16, 0.0, parameters)
        after = grid.to_cells(swarms.positions[0, :16, :2])
        # The last step of the robot may end at the target, which it sees from where it would have been.
        for old, new in list(zip(before, after, strict=True))[1:]:
            assert segment_is_free(grid.blocked, *old, *new)
    walk = grid.to_cells(swarms.walk[0, : swarms.walked[0]])
    assert len(walk) > 2
    assert path_is_free(grid.blocked, walk)


def test_an_arrival_ends_the_episode():
    env = small_env(iterations=400, step=0.02)
    env.reset(seed=1)
    steps, terminated = 0, False
    while not terminated:
        _, _, terminated, _, info = env.step(np.array([8.0, 0.0]))
        steps += 1
    assert steps < 400
    scenario = env.unwrapped.simulation.problems[0].scenario
    cells = scenario.map.to_cells(info["best_path"])
    assert path_is_free(scenario.map.blocked, cells)
    assert tuple(info["best_path"][0]) == scenario.start
    assert tuple(info["best_path"][-1]) == scenario.target
    length = np.linalg.norm(np.diff(info["best_path"], axis=0), axis=1).sum()
    assert info["best_fitness"] == pytest.approx(length, rel=1e-12)
    assert info["best_collision"] == 0.0
    # The next episode begins with the whole budget again.
    _, info = env.reset()
    assert info["evaluations"] == 8
    assert not env.step(np.array([8.0, 0.0]))[2]


def test_the_first_population_is_a_lattice_out_of_the_obstacles():
    env = small_env(initial_population_size=17)
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    grid = simulation.problems[0].scenario.map
    places = np.array([((a + 0.5) / 4, (b + 0.5) / 4) for a in range(4) for b in range(4)]) * 50.0 - 0.5
    members = simulation.positions(0)[1:]
    in_the_way = [not grid.is_free(grid.cell_of(place.tolist())) for place in places]
    assert 0 == sum(in_the_way) < len(places)
    np.testing.assert_allclose(members, places)
    env.reset(seed=0, options={"initial_population_size": 10})  # of three by three, one is in the block
    members = simulation.positions(0)[1:]
    assert all(grid.is_free(grid.cell_of(member)) for member in members.tolist())
    assert np.linalg.norm(members[4] - (24.5, 24.5)) > 2.0
    np.testing.assert_allclose(members[0], [50 / 6 - 0.5] * 2)


def test_given_members_in_obstacles_are_put_beside_them_and_the_first_at_the_start():
    env = small_env()
    given = np.array([[3.0, 3.0], [24.9, 24.1], [40.25, 7.5], [49.5, 49.5]])
    _, info = env.reset(seed=0, options={"initial_population": given})
    simulation = env.unwrapped.simulation
    scenario = simulation.problems[0].scenario
    members = simulation.positions(0)
    assert info["evaluations"] == 4
    assert tuple(members[0]) == scenario.start
    assert (members[2:] == given[2:]).all()
    assert scenario.map.is_free(scenario.map.cell_of(members[1].tolist()))
    assert np.linalg.norm(members[1] - given[1]) < 5.0


def test_options_have_names_and_kernels_their_indices():
    values = Glowworm.parameter_values({"glow": "distance", "levels": "differences"})
    assert (values.glow, values.levels, values.selection) == (2.0, 1.0, 0.0)
    for parameter in Glowworm.parameters.values():
        assert parameter.default == 0.0 or not parameter.choices
    env = small_env(glow="sight", iterations=3)
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    assert simulation.history[0, 0, simulation.columns.index("glow")] == 1.0


def test_extended_actions_leave_named_options_as_they_are():
    decided = Glowworm.decided_parameters()
    assert decided
    assert not any(parameter.choices for parameter in decided.values())
    settings = Settings.from_options(Glowworm, {"action": "extended", "glow": "sight"})
    assert make_action(settings, Glowworm).labels == ("population size", "repair degree", *decided)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"glow": "moon"}, UnknownNameError, r"glow.*'moon'.*distance, relay, sight"),
        ({"glow": 1}, UnknownNameError, r"glow.*1.*distance, relay, sight"),
        ({"selection": "Brightest"}, UnknownNameError, r"selection.*'Brightest'.*brightest, proportional"),
        ({"step": 0.0}, SettingError, r"step.*1e-06"),
        ({"decay": "much"}, SettingError, r"decay.*'much'"),
        ({"encoding": "waypoints"}, UnknownNameError, r"glowworm.*'waypoints'.*walk"),
        ({"min_population_size": 1}, SettingError, r"min_population_size.*1"),
        ({"scenario": "function:rastrigin-2"}, SettingError, r"walk.*rastrigin"),
    ],
)
def test_wrong_options_are_refused_by_name_and_value(options, error, message):
    with pytest.raises(error, match=message):
        small_env(**options)
