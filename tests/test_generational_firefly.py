"""The generational firefly algorithm; what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest
from builders import advance, begin, make_problem, small_grid_problem
from test_optimizers import run

from swarm_gym.optimizers.generational_firefly import GenerationalFirefly

NAME = "generational-firefly"


def test_the_defaults_are_the_printed_parameters():
    assert GenerationalFirefly.knob_values({}).tolist() == [0.2, 1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    "knobs",
    [{"least_attractiveness": 0.2, "absorption": 30.0}, {"noise": 3.0, "attractiveness": 0.4}],
)
def test_episodes_with_other_parameters_are_the_naive_ones(knobs):
    run(NAME, make_problem("case3", 9), [(8, 0.0), (11, 0.5), (6, 1.0)], knobs, size=8)


def test_all_but_the_brightest_are_evaluated_once():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=20)
    advance(NAME, swarms, tables, 20, 0.0)
    assert swarms.evaluations[0] == 20 + 19


def test_equals_stay_where_they_are():
    problem = make_problem("case1", 9)
    population = np.tile(np.random.default_rng(0).uniform(*problem.bounds, 9), (4, 1))
    swarms, tables = begin(NAME, [problem], size=4, populations=[population])
    before = swarms.positions.copy()
    advance(NAME, swarms, tables, 4, 1.0)
    assert (swarms.positions == before).all()
    assert swarms.evaluations[0] == 4


def test_a_move_of_values_known_by_hand():
    """Two fireflies half a range apart in one of two components: the attraction is exp(-1/4)."""
    problem = make_problem("case1", 2)
    low, high = (bound[0] for bound in problem.bounds)
    assert (low, high) == (-300.0, 300.0)
    population = np.array([[-150.0, 40.0], [150.0, 40.0]])
    swarms, tables = begin(NAME, [problem], size=2, populations=[population])
    dim, bright = np.argsort(swarms.fitness[0, :2])[::-1]
    advance(NAME, swarms, tables, 2, 0.0, {"noise": 0.0})
    pull = math.exp(-0.25)
    expected = population[dim] + pull * (population[bright] - population[dim])
    np.testing.assert_allclose(swarms.positions[0, dim, :2], expected)
    assert swarms.positions[0, bright, :2].tolist() == population[bright].tolist()


def test_units_of_the_map_do_not_matter():
    """Distances and noise are in ranges: a map of another resolution is walked alike."""
    fine, coarse = (small_grid_problem(resolution=side) for side in (1.0, 2.0))
    walks = []
    for problem in (fine, coarse):
        swarms, tables = begin(NAME, [problem], size=8)
        for _ in range(2):
            advance(NAME, swarms, tables, 8, 0.0, {"noise": 0.01})
        walks.append(
            problem.scenario.map.to_cells(swarms.positions[0, :8, :6].reshape(8, 2, 3).swapaxes(1, 2))
        )
    # Where who is brighter is the same: the penalty is not in units of the map, and outweighs the length.
    np.testing.assert_allclose(walks[0], walks[1])
