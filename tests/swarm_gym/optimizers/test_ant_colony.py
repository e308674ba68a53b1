"""The ant colony against plain Python; numbers of ants, budgets, limits of parameters, maps that change.

Walks are in test_ant_walk.py, pheromone is in test_trails.py.
"""

import os

import gymnasium
import numpy as np
import pytest
from test_optimizers import run

from helpers.ants import MAPS, NAME, length_of, optimum_of, path_of, problem_of, trails_of
from helpers.builders import (
    METRES,
    UNLIMITED,
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
from swarm_gym.errors import SettingError
from swarm_gym.optimizers.ant_colony import trails
from swarm_gym.optimizers.ant_colony.ant_colony import AntColony
from swarm_gym.problem import WalkProblem
from swarm_gym.problem.geometry.traversal import blocked_length
from swarm_gym.problem.tables import stack
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario

PARAMETERS = [
    {},
    {"trail_weight": 0.0},
    {"trail_weight": 2.5, "sight_weight": 1.0},
    {"sight_weight": 0.0},
    {"sight_weight": 10.0, "trail_weight": 10.0},
    {"evaporation": 0.0, "deposit": 30.0},
    {"evaporation": 1.0},
    {"elite_weight": 0.0},
    {"elite_weight": 5.0, "deposit": 0.1, "evaporation": 0.05},
]


@pytest.mark.parametrize("parameters", slow_but(PARAMETERS[::2], PARAMETERS), ids=str)
def test_episodes_with_other_parameters_are_the_naive_ones(parameters):
    for seed, geometry in enumerate(({}, METRES)):
        problem = walk_problem("random", seed, shape=(10, 14), **geometry)
        plan = [(8, 0.5), (3, 0.0), (12, 0.0), (10, 1.0), (1, 0.0)] * 3
        run("ant-colony", problem, plan, parameters, size=9, seed=seed, iterations=len(plan))


@looped("seed", range(12))
def test_rounding_does_not_choose_among_ways_that_are_equally_long(seed):
    """The elite lays its trail on one of these walks, and all later results depend on the choice."""
    problem = walk_problem("random", seed, shape=(10, 14), **METRES)
    run("ant-colony", problem, [(10, 0.0)] * 10, size=10, seed=seed, iterations=10)


def test_trails_that_evaporate_at_changing_rates_are_the_naive_ones():
    problem = walk_problem("random", 2, shape=(10, 14))
    swarms, tables = begin("ant-colony", [problem], 6)
    twin = oracle_twin("ant-colony", problem, 6)
    for rate in (0.5, 0.1, 0.1, 0.9, 0.0, 0.0, 0.3, 1.0, 0.2, 0.2):
        parameters = {"evaporation": rate, "deposit": 2.0, "sight_weight": 10 * rate}
        values = advance("ant-colony", swarms, tables, 6, 0.0, parameters)
        twin.step(6, 0.0, values)
        assert_same_as_oracle(swarms, twin)


SNAKE = [row for k in range(9) for row in ("." * 20, ("#" * 19 + ".", "." + "#" * 19)[k % 2])] + ["." * 20]


@pytest.mark.parametrize(
    ("rows", "start", "target"),
    [
        (("......", ".####.", "....#.", ".####.", "......"), (0.0, 2.0), (5.0, 2.0)),  # a dead end
        ((".....", ".###.", ".#.#.", ".#...", "....."), (2.0, 2.0), (0.2, 0.1)),
        (("...", ".#.", "..."), (-0.25, 0.3), (0.25, 0.25)),  # both ends in one cell
        (("..", "#."), (0.0, 0.0), (1.0, 1.0)),  # no corner is cut
        (SNAKE, (0.0, 0.0), (19.0, 18.0)),  # too long for the patience of ants
    ],
    ids=["dead end", "pocket", "one cell", "corner", "snake"],
)
def test_episodes_on_small_maps_are_the_naive_ones(rows, start, target):
    problem = drawn_problem(*rows, start=start, target=target)
    run("ant-colony", problem, [(4, 0.0)] * 4, size=3, iterations=4)


@pytest.mark.parametrize("geometry", [{}, METRES])
def test_ants_come_close_to_the_octile_optimum(geometry):
    scenario = random_grid_scenario(3, shape=(12, 16), **geometry)
    grid = scenario.map
    cells = [grid.cell_of(end) for end in (scenario.start, scenario.target)]
    ends = [tuple(grid.to_map(cell).tolist()) for cell in cells]
    swarms, tables = begin("ant-colony", [WalkProblem(GridScenario("centres", grid, *ends))], 30)
    for _ in range(40):
        advance("ant-colony", swarms, tables, 30, 0.0)
    optimum = shortest_grid_path(grid.blocked, *cells).length * grid.resolution
    assert optimum * (1 - 1e-9) <= swarms.best_fitness[0] <= 1.05 * optimum


# Numbers of ants, budgets, parameters.


def test_a_decided_size_is_the_number_of_ants_of_the_next_cohort():
    swarms, tables = begin(NAME, [MAPS["open"]], size=5)
    counted = 5
    for size in (5, 12, 1, 32, 3):
        advance(NAME, swarms, tables, size, 0.5)
        counted += size
        assert swarms.size[0] == size
        assert swarms.evaluations[0] == counted


@pytest.mark.parametrize("left", range(9))
def test_where_the_budget_ends_within_a_cohort_its_ants_are_the_members(left):
    swarms, tables = begin(NAME, [MAPS["open"]], size=5, budget=5 + left)
    for _ in range(3):
        advance(NAME, swarms, tables, 6, 0.0)
    assert swarms.evaluations[0] == 5 + left
    assert swarms.size[0] == (left if 0 < left < 6 else left - 6 if left > 6 else 5 if left == 0 else 6)


def test_without_evaluations_left_nothing_changes():
    swarms, tables = begin(NAME, [MAPS["open"]], size=5, budget=5)
    before = [np.copy(field) for field in (swarms.positions, swarms.fitness, swarms.field, swarms.stream)]
    advance(NAME, swarms, tables, 9, 0.0)
    after = (swarms.positions, swarms.fitness, swarms.field, swarms.stream)
    assert all((one == other).all() for one, other in zip(before, after, strict=True))


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("name", AntColony.parameters)
def test_parameters_at_their_limits_leave_finite_numbers(name, end):
    problem = MAPS["metres"]
    swarms, tables = begin(NAME, [problem], size=9)
    for _ in range(4):
        advance(NAME, swarms, tables, 9, 0.0, {name: getattr(AntColony.parameters[name], end)})
        assert np.isfinite(swarms.fitness[0, :9]).all()
        assert np.isfinite(swarms.field).all()
    tau = trails_of(swarms, problem)
    assert tau.min() >= 1e-4
    assert tau.max() <= 10.0


def test_strong_sight_leads_ants_straight_to_a_target_in_sight():
    problem = problem_of("S......... .......... .........T")
    swarms, tables = begin(NAME, [problem], size=10)
    advance(NAME, swarms, tables, 10, 0.0, {"sight_weight": 10.0})
    assert np.median(swarms.fitness[0, :10]) == pytest.approx(optimum_of(problem))


def test_parameters_that_change_from_one_iteration_to_the_next_are_followed():
    """Trails that were not read catch up with each round by the share of that round."""
    problem = problem_of("S.T......")
    swarms, tables = begin(NAME, [problem], size=1)
    tau = 0.8
    for evaporation in (0.5, 0.5, 0.1, 0.3, 0.3):
        advance(NAME, swarms, tables, 1, 0.0, {"evaporation": evaporation})
        tau *= 1.0 - evaporation
    assert trails_of(swarms, problem)[0, 5].tolist() == pytest.approx([tau] * 8, rel=1e-14)


def test_given_populations_are_refused():
    env = gymnasium.make("swarm_gym/AntColony-v0", scenario="block:20")
    with pytest.raises(
        SettingError, match="initial_population: ant-colony makes its first population itself"
    ):
        env.reset(options={"initial_population": np.ones((5, 2))})


# Maps that change.


def change_map(swarms, tables, cells):
    for column, row in cells:
        tables.blocked[0, row, column] = True
    # As a problem of the new map has it.
    grid = GridMap("changed", tables.blocked[0])
    scenario = GridScenario("changed", grid, tuple(tables.start[0]), tuple(tables.target[0]))
    changed = stack([WalkProblem(scenario).table])
    AntColony.re_evaluate(swarms, changed, np.array([True]), 0.1)
    return changed


def open_field():
    return problem_of("........... ........... S.........T ........... ...........")


def test_a_best_path_that_is_blocked_now_gives_way_to_one_that_is_not():
    swarms, tables = begin(NAME, [open_field()], size=30)
    advance(NAME, swarms, tables, 30, 0.0, {"sight_weight": 5.0})
    assert swarms.best_fitness[0] == pytest.approx(10.0)
    before, field = swarms.evaluations[0], swarms.field[0, : trails.trails_size(55)].copy()
    changed = change_map(swarms, tables, [(5, 1), (5, 2), (5, 3)])
    assert swarms.evaluations[0] == before + 31
    assert swarms.size[0] == 30
    assert swarms.best_collision[0] == 0.0
    path = path_of(swarms, open_field())
    assert blocked_length(changed.blocked[0], path) == 0.0
    assert swarms.best_fitness[0] == pytest.approx(length_of(path))
    # No trails were laid, only brought up to date.
    swarms.field[0, : trails.trails_size(55)] = field
    advance(NAME, swarms, changed, 30, 0.0)
    assert swarms.best_collision[0] == 0.0


def test_a_best_path_that_is_still_free_stays():
    swarms, tables = begin(NAME, [open_field()], size=30)
    advance(NAME, swarms, tables, 30, 0.0, {"sight_weight": 5.0})
    path = path_of(swarms, open_field()).tolist()
    change_map(swarms, tables, [(5, 0), (5, 4)])
    assert swarms.best_fitness[0] == pytest.approx(10.0)
    assert path_of(swarms, open_field()).tolist() == path


@pytest.mark.parametrize("left", [1, 4, 30, 31])
def test_re_evaluation_ends_where_the_budget_does(left):
    swarms, tables = begin(NAME, [open_field()], size=30, budget=60 + left)
    advance(NAME, swarms, tables, 30, 0.0)
    change_map(swarms, tables, [(5, 1), (5, 2), (5, 3)])
    assert swarms.evaluations[0] == 60 + left
    assert swarms.size[0] == min(left, 30)
    assert np.isfinite(swarms.best_fitness[0])


# What comes out.


@pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)
@pytest.mark.parametrize("side", [50, 100])
def test_a_run_finds_a_path_within_a_tenth_of_the_shortest_over_cells(side):
    problem = WalkProblem(make_scenario(f"block:{side}"))
    swarms, tables = begin(NAME, [problem], 50, capacity=50, budget=UNLIMITED)
    for _ in range(60):
        advance(NAME, swarms, tables, 50, 0.0)
    assert swarms.best_collision[0] == 0.0
    assert (swarms.collision[0, :50] == 0.0).mean() > 0.9
    assert swarms.best_fitness[0] <= 1.1 * optimum_of(problem)
