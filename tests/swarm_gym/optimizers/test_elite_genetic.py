"""The elite genetic algorithm; what holds for every optimizer is in test_optimizers.py."""

import itertools

import numpy as np
import pytest
from test_optimizers import PLAN, problems, run

from helpers.builders import advance, begin, make_problem
from helpers.slow import slow_but
from swarm_gym.optimizers.elite_genetic import _spin, _wheel

NAME = "elite-genetic"


@pytest.mark.parametrize(("crossover", "mutation"), [(1.0, 0.0), (0.0, 0.5), (0.5, 0.2)])
@pytest.mark.parametrize("kind", slow_but(["one waypoint"], ["analytic", "one waypoint", "polyline"]))
def test_episodes_with_other_parameters_are_the_naive_ones(kind, crossover, mutation):
    parameters = {"crossover": crossover, "mutation": mutation}
    run(NAME, problems(NAME)[kind], PLAN[:6], parameters, size=7)


@pytest.mark.parametrize("kind", ["analytic", "curve"])
def test_the_best_member_survives_every_generation(kind):
    swarms, tables = begin(NAME, [problems(NAME)[kind]], size=12)
    for _, repair_degree in PLAN:
        advance(NAME, swarms, tables, 12, repair_degree, {"mutation": 0.2})
        assert swarms.fitness[0, 0] <= swarms.fitness[0, :12].max()
        assert swarms.fitness[0, :12].min() == swarms.best_fitness[0]


def test_the_wheel_is_windowed_and_gives_the_worst_a_hundredth_of_the_spread():
    wheel = _wheel(np.array([10.0, 30.0, 20.0]))
    np.testing.assert_allclose(np.diff(wheel, prepend=0.0), np.array([20.2, 0.2, 10.2]) / 30.6)
    np.testing.assert_allclose(_wheel(np.full(4, 7.0)), [0.25, 0.5, 0.75, 1.0])


@pytest.mark.parametrize(
    ("share", "expected"), [(0.0, 0), (0.19, 0), (0.2, 1), (0.69, 1), (0.7, 2), (0.999, 2)]
)
def test_the_wheel_stops_where_the_share_is(share, expected):
    assert _spin(np.array([0.2, 0.7, 1.0]), share) == expected


def test_every_member_is_evaluated_also_copies():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=12)
    drawn = {tuple(position) for position in swarms.positions[0, :12]}
    advance(NAME, swarms, tables, 12, 0.0, {"crossover": 0.0, "mutation": 0.0})
    assert swarms.evaluations[0] == 12 + 12
    assert {tuple(position) for position in swarms.positions[0, :12]} <= drawn


def test_children_have_the_first_genes_of_one_parent_and_the_last_of_another():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=12)
    parents = swarms.positions[0, :12, :9].copy()
    advance(NAME, swarms, tables, 12, 0.0, {"crossover": 1.0, "mutation": 0.0})
    crossed = 0
    for child in swarms.positions[0, 1:12, :9]:
        origin = [int(np.argmax((parents[:, k] == child[k]) & True)) for k in range(9)]
        assert all((parents[origin[k], k] == child[k]) for k in range(9))
        switches = sum(a != b for a, b in itertools.pairwise(origin))
        assert switches <= 1
        crossed += switches
    assert crossed > 0


def test_the_share_of_children_is_rounded_to_whole_members():
    """With 64 members beside the best, the printed share makes 12.8 children: at most 13 are new."""
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=65, capacity=65)
    parents = {tuple(position) for position in swarms.positions[0, :65]}
    advance(NAME, swarms, tables, 65, 0.0, {"mutation": 0.0})
    new = [position for position in swarms.positions[0, :65] if tuple(position) not in parents]
    assert 6 < len(new) <= 13


def test_with_every_gene_drawn_anew_nothing_but_the_best_is_left():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=12)
    before = swarms.positions[0, :12, :9].copy()
    best = before[swarms.fitness[0, :12].argmin()]
    advance(NAME, swarms, tables, 12, 0.0, {"mutation": 1.0})
    after = swarms.positions[0, :12, :9]
    assert after[0].tolist() == best.tolist()
    assert not np.isin(after[1:], before).any()
    assert swarms.evaluations[0] == 12 + 12
