"""The glowworms of Brand and Yu: every option against plain Python, arrivals, maps that change."""

import naive_swarm
import numpy as np
import pytest
from builders import (
    advance,
    assert_same_as_oracle,
    begin,
    oracle_twin,
    random_grid_scenario,
    walk_problem,
)
from test_optimizers import run
from test_re_evaluation import change

from swarm_gym.problem import WalkProblem
from swarm_gym.problem.tables import stack
from swarm_gym.problem.traversal import path_is_free
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario

METRES = {"resolution": 0.05, "origin": (-1.0, 2.0), "y_up": True}
OPTIONS = [
    {},
    {"glow": "sight"},
    {"glow": "distance"},
    {"dimming": "exponential"},
    {"selection": "proportional"},
    {"selection": "proportional", "levels": "differences", "dimming": "exponential"},
    {"range_rule": "adaptive", "decision_range": 0.5},
    {"range_rule": "adaptive", "selection": "proportional", "glow": "distance", "gain": 3.0},
    {"decision_range": 0.25, "absorption": 50.0},
    {"decay": 0.0, "dimming": "exponential", "absorption": 1000.0},
    {"decay": 0.0, "selection": "proportional", "levels": "differences"},
    {"gain": 0.0, "first_luciferin": 0.0},
]


def way_of(swarms, problem):
    """The best path so far, in cells."""
    points = [*swarms.walk[0, : swarms.best_walk[0]], problem.scenario.target]
    return problem.scenario.map.to_cells(points)


@pytest.mark.parametrize("knobs", OPTIONS, ids=str)
def test_episodes_with_other_parameters_are_the_naive_ones(knobs):
    """Long enough for members to meet, and for the robot to arrive in some of them."""
    for seed, geometry in enumerate(({}, METRES)):
        problem = walk_problem("random", seed, shape=(9, 14), **geometry)
        plan = [(8, 0.5), (8, 0.0), (12, 0.0), (10, 1.0), (5, 0.0)] * 6
        options = {"size": 9, "seed": seed, "iterations": len(plan)}
        run("glowworm", problem, plan, {"step": 0.05, **knobs}, **options)


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


@pytest.mark.parametrize("seed", range(12))
def test_a_step_that_is_longer_than_a_wall_is_thick_leads_nobody_through_it(seed):
    blocked = np.array([[character == "#" for character in row] for row in WALL])
    problem = WalkProblem(GridScenario("wall", GridMap("wall", blocked), (1.0, 1.0), (1.0, 3.0)))
    options = {"size": 5, "seed": seed, "iterations": 12}
    swarms, _ = run("glowworm", problem, [(5, 0.0)] * 12, {"step": 0.3}, **options)
    assert path_is_free(blocked, way_of(swarms, problem)) == (swarms.best_collision[0] == 0.0)


def with_obstacle(scenario, point):
    """The scenario with more blocked cells around a point."""
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
    problem, knobs = WalkProblem(scenario), {"step": 0.03}
    options = {"size": 8, "iterations": 30}
    swarms, tables = begin("glowworm", [problem], **options)
    twin = oracle_twin("glowworm", problem, **options, knobs=knobs)

    def go_on(steps):
        for _ in range(steps):
            values = advance("glowworm", swarms, tables, 8, 0.0, knobs)
            twin.step(8, 0.0, values.tolist())
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
        walked = swarms.walk[0, : swarms.registers[0, 0]]
        assert (walked[-1] == robot).all()
        robots = np.linalg.norm(np.diff(walked, axis=0), axis=1).sum() + swarms.fitness[0, 0]
        assert swarms.best_fitness[0] <= robots * (1 + 1e-9)
        go_on(2)


def test_the_way_out_of_a_new_obstacle_is_part_of_the_path():
    """Of the robot's, which is the best where the way there is blocked for others."""
    before = np.zeros((9, 30), dtype=np.bool_)
    after = before.copy()
    problem = WalkProblem(GridScenario("open", GridMap("open", before), (2.0, 4.0), (27.0, 4.0)))
    options, knobs = {"size": 5, "iterations": 40}, {"step": 0.03}
    swarms, tables = begin("glowworm", [problem], **options)
    twin = oracle_twin("glowworm", problem, **options, knobs=knobs)
    while swarms.positions[0, 0, 0] < 8.0:
        values = advance("glowworm", swarms, tables, 5, 0.0, knobs)
        twin.step(5, 0.0, values.tolist())
    column, row = problem.scenario.map.cell_of(swarms.positions[0, 0, :2].tolist())
    after[row - 1 : row + 2, 4 : column + 1] = True
    other = WalkProblem(GridScenario("blocked", GridMap("blocked", after), (2.0, 4.0), (27.0, 4.0)))
    change("glowworm", swarms, stack([problem.table, other.table]), 1)
    twin.re_evaluate(naive_swarm.oracle_of(other))
    assert_same_as_oracle(swarms, twin)
    assert (swarms.best_position[0, :2] == swarms.positions[0, 0, :2]).all()
    assert swarms.best_walk[0] == swarms.registers[0, 0]
    assert swarms.best_collision[0] == 0.0
