"""The generational firefly algorithm; what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest
from test_optimizers import run

from helpers.builders import advance, begin, make_problem

NAME = "generational-firefly"


@pytest.mark.parametrize(
    "parameters", [{"least_attractiveness": 0.2, "absorption": 30.0}, {"noise": 3.0, "attractiveness": 0.4}]
)
def test_episodes_with_other_parameters_are_the_naive_ones(parameters):
    run(NAME, make_problem("case3", 9), [(8, 0.0), (11, 0.5), (6, 1.0)], parameters, size=8)


def test_equals_stay_where_they_are():
    problem = make_problem("case1", 9)
    population = np.tile(np.random.default_rng(0).uniform(*problem.bounds, 9), (4, 1))
    swarms, tables = begin(NAME, [problem], size=4, populations=[population])
    before = swarms.positions.copy()
    advance(NAME, swarms, tables, 4, 1.0)
    assert (swarms.positions == before).all()
    assert swarms.evaluations[0] == 4 + 4


@pytest.mark.parametrize(
    ("absorption", "share"),
    [
        ({"absorption": math.log(2.0) / 300.0**2}, 0.5),
        ({}, 0.0),  # with the printed absorption nothing attracts at the distances of maps
    ],
)
def test_a_move_of_values_known_by_hand(absorption, share):
    """Two fireflies are 300 map units apart; this share of the attraction is left there."""
    problem = make_problem("case1", 2)
    population = np.array([[-150.0, 40.0], [150.0, 40.0]])
    swarms, tables = begin(NAME, [problem], size=2, populations=[population])
    dim, bright = np.argsort(swarms.fitness[0, :2])[::-1]
    advance(NAME, swarms, tables, 2, 0.0, {"noise": 0.0, **absorption})
    expected = (1.0 - share) * population[dim] + share * population[bright]
    np.testing.assert_allclose(swarms.positions[0, dim, :2], expected, rtol=1e-7 if share else 0.0)
    assert swarms.positions[0, bright, :2].tolist() == population[bright].tolist()
    assert swarms.evaluations[0] == 2 + 2  # everybody once
