"""The generational firefly algorithm; what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest
from test_optimizers import run

from helpers.builders import advance, begin, make_problem
from swarm_gym.optimizers.generational_firefly import GenerationalFirefly

NAME = "generational-firefly"


def test_the_defaults_are_the_printed_parameters():
    defaults = {"noise": 0.2, "attractiveness": 1.0, "absorption": 1.0, "least_attractiveness": 0.0}
    assert GenerationalFirefly.parameter_values({})._asdict() == defaults


@pytest.mark.parametrize(
    "parameters",
    [{"least_attractiveness": 0.2, "absorption": 30.0}, {"noise": 3.0, "attractiveness": 0.4}],
)
def test_episodes_with_other_parameters_are_the_naive_ones(parameters):
    run(NAME, make_problem("case3", 9), [(8, 0.0), (11, 0.5), (6, 1.0)], parameters, size=8)


def test_everybody_is_evaluated_once():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=20)
    advance(NAME, swarms, tables, 20, 0.0)
    assert swarms.evaluations[0] == 20 + 20


def test_equals_stay_where_they_are():
    problem = make_problem("case1", 9)
    population = np.tile(np.random.default_rng(0).uniform(*problem.bounds, 9), (4, 1))
    swarms, tables = begin(NAME, [problem], size=4, populations=[population])
    before = swarms.positions.copy()
    advance(NAME, swarms, tables, 4, 1.0)
    assert (swarms.positions == before).all()
    assert swarms.evaluations[0] == 4 + 4


def test_a_move_of_values_known_by_hand():
    """Two fireflies 300 map units apart, where half the attraction is left."""
    problem = make_problem("case1", 2)
    population = np.array([[-150.0, 40.0], [150.0, 40.0]])
    swarms, tables = begin(NAME, [problem], size=2, populations=[population])
    dim, bright = np.argsort(swarms.fitness[0, :2])[::-1]
    advance(NAME, swarms, tables, 2, 0.0, {"noise": 0.0, "absorption": math.log(2.0) / 300.0**2})
    expected = (population[dim] + population[bright]) / 2.0
    np.testing.assert_allclose(swarms.positions[0, dim, :2], expected)
    assert swarms.positions[0, bright, :2].tolist() == population[bright].tolist()


def test_with_the_printed_absorption_nothing_attracts_at_the_distances_of_maps():
    problem = make_problem("case1", 2)
    population = np.array([[-150.0, 40.0], [150.0, 40.0]])
    swarms, tables = begin(NAME, [problem], size=2, populations=[population])
    advance(NAME, swarms, tables, 2, 0.0, {"noise": 0.0})
    assert swarms.positions[0, :2, :2].tolist() == population.tolist()
