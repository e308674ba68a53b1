"""Differential evolution; what holds for every optimizer is in test_optimizers.py."""

import math

import gymnasium
import numpy as np
import pytest
from test_optimizers import PLAN, problems, run

from helpers.builders import (
    UNLIMITED,
    advance,
    assert_same_as_oracle,
    begin,
    make_problem,
    oracle_twin,
    workspace,
)
from helpers.loops import looped
from helpers.slow import slow_but
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import differential_evolution as de
from swarm_gym.optimizers import get_optimizer
from swarm_gym.problem.tables import select
from swarm_gym.registration import environment_id

NAME = "differential-evolution"
# (size, repair degree) of steps, in which the archive fills, is replaced in part and is trimmed.
LONG_PLAN = [(12, 0.0), (12, 0.5), *[(12, 0.0)] * 4, (5, 0.0), (9, 1.0), *[(4, 0.0)] * 6]


def archive_of(swarms, dimension, b=0):
    """Return the archived vectors, (m, dimension)."""
    return get_optimizer(NAME).decision_vectors(swarms, b, dimension)[2]


def memory_of(swarms, length, b=0):
    """Return the entries of scale factors and crossover rates."""
    field = swarms.field[b]
    return field[de.FACTORS : de.FACTORS + length], field[de.CROSSOVERS : de.CROSSOVERS + length]


def assert_same_memory(swarms, twin):
    """Entries of the memory, their means and the archive are those of the oracle."""
    assert_same_as_oracle(swarms, twin)
    close = {"rtol": 1e-10, "atol": 1e-9}
    rates = [de.TERMINAL if rate is None else rate for rate in twin.rates]
    factors, crossovers = memory_of(swarms, de.LONGEST_MEMORY)
    np.testing.assert_allclose(factors, twin.factors, **close)
    np.testing.assert_allclose(crossovers, rates, **close)
    archive = archive_of(swarms, twin.problem.dimension)
    assert len(archive) == len(twin.archive)
    np.testing.assert_allclose(archive, np.reshape(twin.archive, archive.shape), **close)
    means = twin.factors[: twin.length], np.maximum(rates[: twin.length], 0.0)
    expected = [*(np.mean(values) for values in means), twin.filled]
    np.testing.assert_allclose(swarms.field[0, : de.FACTORS], expected, **close)


def run_with_memory(problem, parameters=None, budget=UNLIMITED, plan=LONG_PLAN, seed=0):
    """Advance a swarm and its oracle along a plan, and compare all that they remember after every step."""
    swarms, tables = begin(NAME, [problem], size=12, budget=budget, seed=seed)
    twin = oracle_twin(NAME, problem, 12, budget, seed=seed)
    for size, repair_degree in plan:
        if swarms.evaluations[0] >= budget:
            break
        values = advance(NAME, swarms, tables, size, repair_degree, parameters)
        twin.step(size, repair_degree, values)
        assert_same_memory(swarms, twin)
    return swarms, tables


# Against plain Python.


@looped("budget", [13, 17, 30, 41, 60, UNLIMITED])
@pytest.mark.parametrize(
    "kind", slow_but(["analytic", "one waypoint"], ["analytic", "one waypoint", "curve"])
)
def test_memory_and_archive_are_the_naive_ones(kind, budget):
    run_with_memory(problems(NAME)[kind], budget=budget)


@looped(
    "parameters",
    [
        {"archive_rate": 0.0},
        {"archive_rate": 0.3, "best_share": 1.0},
        {"archive_rate": 3.0, "best_share": 0.0},
        {"memory_length": 1.0},
        {"memory_length": 100.0, "best_share": 0.3},
    ],
)
def test_episodes_of_all_parameters_are_the_naive_ones(parameters):
    for seed in range(3):
        run_with_memory(make_problem("case1", 9), parameters, seed=seed)


def test_parameters_may_change_between_generations_as_naive():
    problem = make_problem("case2", 9)
    swarms, tables = begin(NAME, [problem], size=12)
    twin = oracle_twin(NAME, problem, 12)
    for length, rate, share in [(6, 2.6, 0.1), (3, 0.5, 0.5), (8, 3.0, 0.2), (1, 0.1, 1.0), (6, 2.6, 0.1)]:
        parameters = {"memory_length": length, "archive_rate": rate, "best_share": share}
        for _ in range(3):
            values = advance(NAME, swarms, tables, 10, 0.0, parameters)
            twin.step(10, 0.0, values)
            assert_same_memory(swarms, twin)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_swarms_that_are_too_small_take_no_differences_of_members_that_are_not_there(size):
    """Environments refuse such sizes; a budget that ends can leave fewer members than the mutation needs."""
    run(NAME, make_problem("case1", 9), [(size, 0.0)] * 6, size=size)


@pytest.mark.parametrize(
    ("rates", "counts"),
    [
        ([None, 0.5, 0.5], (1, 2)),  # an entry that has it keeps it, whatever improves
        ([-10.0, -10.0, None], (3,)),  # where all rates are 0, a replaced entry gets it
    ],
)
def test_the_terminal_crossover_rate_comes_and_stays_as_naive(rates, counts):
    """On one waypoint all components change whatever the rate is, so that a rate of 0 can improve, too."""
    problem = make_problem("case1", 1)
    swarms, tables = begin(NAME, [problem], size=12)
    twin = oracle_twin(NAME, problem, 12)
    stored = [de.TERMINAL if rate is None else rate for rate in rates]
    swarms.field[0, de.CROSSOVERS : de.CROSSOVERS + 3], twin.rates[:3] = stored, rates
    for _ in range(12):
        values = advance(NAME, swarms, tables, 12, 0.0, {"memory_length": 3.0})
        twin.step(12, 0.0, values)
        assert_same_memory(swarms, twin)
    _, crossovers = memory_of(swarms, 3)
    assert crossovers[rates.index(None)] == de.TERMINAL
    assert (crossovers == de.TERMINAL).sum() in counts
    assert swarms.field[0, de.MEAN_CROSSOVER] == pytest.approx(np.maximum(crossovers, 0.0).mean())
    assert (memory_of(swarms, 3)[0] != 0.5).all()


# By hand.


def test_lehmer_means_are_those_computed_by_hand():
    swarms, _ = begin(NAME, [make_problem("case1", 9)], size=4)
    factors, rates = np.array([0.2, 0.9, 0.4, 0.8]), np.array([0.5, 0.1, 1.0, 0.0])
    gains = np.array([1.0, 0.0, 3.0, 4.0])
    de._remember(swarms, 0, factors, rates, gains, 6)
    # Weights 1/8, 3/8, 1/2 of F = 0.2, 0.4, 0.8 and CR = 0.5, 1, 0.
    assert swarms.field[0, de.FACTORS] == pytest.approx((0.04 + 3 * 0.16 + 4 * 0.64) / (0.2 + 1.2 + 3.2))
    assert swarms.field[0, de.CROSSOVERS] == pytest.approx((0.25 + 3.0) / (0.5 + 3.0))
    assert swarms.registers[0, de.NEXT_ENTRY] == 1
    before = swarms.field[0].copy()
    de._remember(swarms, 0, factors, rates, np.zeros(4), 6)  # nothing improved
    assert (swarms.field[0] == before).all()
    assert swarms.registers[0, de.NEXT_ENTRY] == 1


def test_scale_factors_and_crossover_rates_have_their_distributions():
    rng = np.random.default_rng(0)
    shares = rng.random((4000, 3))
    factors = np.array([de._scale_factor(0.5, share) for share in shares[:, 0]])
    rates = np.array([de._crossover_rate(0.5, *pair) for pair in shares[:, 1:]])
    assert factors.max() == 1.0
    assert (factors == 1.0).mean() == pytest.approx(0.5 - math.atan(5.0) / math.pi, abs=0.02)
    assert np.quantile(factors, [0.25, 0.5, 0.75]) == pytest.approx([0.4, 0.5, 0.6], abs=0.015)
    assert de._scale_factor(0.5, 0.0) == 1.0  # the Cauchy number is infinite
    assert (rates.mean(), rates.std()) == (pytest.approx(0.5, abs=0.01), pytest.approx(0.1, abs=0.005))
    assert {de._crossover_rate(2.0, *pair) for pair in shares[:9, 1:]} == {1.0}
    assert {de._crossover_rate(de.TERMINAL, *pair) for pair in shares[:9, 1:]} == {0.0}


def test_other_vectors_differ_from_the_member_and_are_equally_likely():
    size, archived, counts = 5, 3, {}
    grid = (np.arange(24) + 0.5) / 24
    for i in range(size):
        for u in grid:
            for v in grid:
                pair = de._draw_others(size, archived, i, u, v)
                counts[i, *pair] = counts.get((i, *pair), 0) + 1
    assert len(counts) == 5 * 4 * 6
    assert all(i != first != second != i and first < size for i, first, second in counts)
    assert set(counts.values()) == {24 * 24 // 24}


def test_best_members_are_sorted_and_ties_go_to_the_earlier():
    fitness = np.array([3.0, 1.0, 2.0, 1.0, 5.0])
    assert de._best_members(fitness, 3).tolist() == [1, 3, 2]
    assert de._best_members(fitness, 0).tolist() == [1, 3]
    assert de._best_members(fitness, 9).tolist() == [1, 3, 2, 0, 4]
    assert de._best_members(fitness[:1], 1).tolist() == [0]


# Properties.


def test_members_never_get_worse_and_their_number_is_the_size():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=20)
    before = swarms.fitness[0, :20].copy()
    for step in range(10):
        advance(NAME, swarms, tables, 20, 0.5 * (step % 2))
        assert (swarms.fitness[0, :20] <= before).all()
        before = swarms.fitness[0, :20].copy()
        assert swarms.evaluations[0] == 20 * (step + 2)


def test_the_archive_has_former_members_and_shrinks_along_with_the_population():
    problem = make_problem("case1", 9)
    swarms, tables = begin(NAME, [problem], size=20)
    known = {tuple(row) for row in swarms.positions[0, :20, :9]}
    for size in [20] * 12 + [10, 7, 4, 12, 12]:
        advance(NAME, swarms, tables, size, 0.0, {"archive_rate": 1.5})
        archive = archive_of(swarms, 9)
        assert {tuple(row) for row in archive} <= known
        assert len(archive) <= math.floor(1.5 * size + 0.5)
        assert swarms.field[0, de.ARCHIVE_USE] == len(archive) / math.floor(1.5 * size + 0.5)
        known |= {tuple(row) for row in swarms.positions[0, :size, :9]}
    assert len(archive) > 6


def test_a_shrinking_population_keeps_the_archive_that_is_within_its_limit():
    """The archive is stored beside the members; those that are deleted take none of it with them."""
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=20)
    for _ in range(3):
        advance(NAME, swarms, tables, 20, 0.0)
    before = archive_of(swarms, 9).copy()
    assert 10 < len(before) < 39
    swarms.budget[0] = swarms.evaluations[0]  # no more trials
    advance(NAME, swarms, tables, 15, 0.0)
    assert (archive_of(swarms, 9) == before).all()


def test_a_new_episode_forgets_memory_and_archive():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=12)
    for _ in range(9):
        advance(NAME, swarms, tables, 12, 0.0)
    assert len(archive_of(swarms, 9)) > 0
    assert (memory_of(swarms, 6)[0] != 0.5).all()
    get_optimizer(NAME).initialise(swarms, tables, np.full(1, True), np.full(1, 6), 0.1)
    assert len(archive_of(swarms, 9)) == 0
    assert (np.concatenate(memory_of(swarms, de.LONGEST_MEMORY)) == 0.5).all()
    assert swarms.field[0, : de.FACTORS].tolist() == [0.5, 0.5, 0.0]


def test_components_beyond_a_bound_are_put_midway_between_it_and_the_member():
    problem = make_problem("case1", 9)
    low, high = problem.bounds[0][0], problem.bounds[1][0]
    members = np.random.default_rng(0).uniform(0.99 * low, 0.99 * high, (6, 9))
    swarms, tables = begin(NAME, [problem], 6, populations=[members])
    swarms.field[0, de.FACTORS :] = 1.0
    table, work, parents = select(tables, 0), workspace(9), swarms.positions[0, :6].copy()
    halves = {"low": 0, "high": 0}
    for k in range(120):
        i = k % 6
        de._make_trial(swarms, 0, table, work, parents, de._archive(swarms, 0), np.array([0, 1]), i, 6)
        trial = work.path[1:10]
        assert (low < trial).all()
        assert (trial < high).all()
        halves["low"] += (trial == 0.5 * (low + members[i])).sum()
        halves["high"] += (trial == 0.5 * (high + members[i])).sum()
    assert min(halves.values()) > 20


# Through the environments.


def test_sizes_below_what_the_mutation_needs_are_refused_by_name():
    with pytest.raises(SettingError, match=r"min_population_size must lie in \[4, .*got 3"):
        gymnasium.make(environment_id(NAME), scenario="case1", min_population_size=3)
    with pytest.raises(SettingError, match="initial_population_size"):
        gymnasium.make(environment_id(NAME), scenario="case1", initial_population_size=3)
    env = gymnasium.make(environment_id(NAME), scenario="case1", iterations=3, initial_population_size=4)
    env.reset(seed=0)
    *_, info = env.step(np.array([4.0, 0.0]))
    assert info["population_size"] == 4
    env.close()


@looped(
    ("name", "value"),
    [("best_share", 1.1), ("memory_length", 0.0), ("memory_length", 101.0), ("archive_rate", 3.5)],
)
def test_parameters_outside_their_ranges_are_refused_by_name(name, value):
    with pytest.raises(SettingError, match=name):
        get_optimizer(NAME).parameter_values({name: value})
    assert get_optimizer(NAME).parameter_values({name: 1.0})


def test_the_plan_of_all_optimizers_fills_the_archive():
    swarms, _ = run(NAME, make_problem("case1", 9), PLAN, size=7)
    assert len(archive_of(swarms, 9)) > 0
