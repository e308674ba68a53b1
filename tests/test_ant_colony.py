"""The ant colony: every parameter against plain Python, dead ends, ties, one cell for both ends."""

import numpy as np
import pytest
from builders import advance, assert_same_as_oracle, begin, oracle_twin, random_grid_scenario, walk_problem
from test_optimizers import run

from swarm_gym.problem import WalkProblem
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridMap, GridScenario

METRES = {"resolution": 0.05, "origin": (-1.0, 2.0), "y_up": True}
PARAMETERS = [
    {},
    {"trail_weight": 0.0},
    {"trail_weight": 2.5, "sight_weight": 1.0},
    {"sight_weight": 0.0},
    {"sight_weight": 20.0, "trail_weight": 10.0},
    {"evaporation": 0.0, "deposit": 30.0},
    {"evaporation": 1.0},
    {"elite_weight": 0.0},
    {"elite_weight": 5.0, "deposit": 0.1, "evaporation": 0.05},
]


def drawn_problem(rows, start, target):
    """Of a map of characters."""
    blocked = np.array([[character == "#" for character in row] for row in rows])
    return WalkProblem(GridScenario("drawn", GridMap("drawn", blocked), start, target))


@pytest.mark.parametrize("knobs", PARAMETERS, ids=str)
def test_episodes_with_other_parameters_are_the_naive_ones(knobs):
    for seed, geometry in enumerate(({}, METRES)):
        problem = walk_problem("random", seed, shape=(10, 14), **geometry)
        plan = [(8, 0.5), (3, 0.0), (12, 0.0), (10, 1.0), (1, 0.0)] * 3
        run("ant-colony", problem, plan, knobs, size=9, seed=seed, iterations=len(plan))


@pytest.mark.parametrize("seed", range(12))
def test_rounding_does_not_choose_among_ways_that_are_equally_long(seed):
    """The elite lays its trail on one of them, and all after it depends on which."""
    problem = walk_problem("random", seed, shape=(10, 14), **METRES)
    run("ant-colony", problem, [(10, 0.0)] * 10, size=10, seed=seed, iterations=10)


def test_trails_that_evaporate_at_changing_rates_are_the_naive_ones():
    problem = walk_problem("random", 2, shape=(10, 14))
    swarms, tables = begin("ant-colony", [problem], 6)
    twin = oracle_twin("ant-colony", problem, 6)
    for rate in (0.5, 0.1, 0.1, 0.9, 0.0, 0.0, 0.3, 1.0, 0.2, 0.2):
        knobs = {"evaporation": rate, "deposit": 2.0, "sight_weight": 10 * rate}
        values = advance("ant-colony", swarms, tables, 6, 0.0, knobs)
        twin.step(6, 0.0, values.tolist())
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
    run("ant-colony", drawn_problem(rows, start, target), [(4, 0.0)] * 4, size=3, iterations=4)


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
