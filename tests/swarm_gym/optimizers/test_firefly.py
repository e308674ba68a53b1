"""Fireflies of the SPSFA paper; what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from test_optimizers import assert_same_bits, run

from helpers.builders import (
    CASES,
    MEAN_WEIGHT,
    advance,
    as_path,
    assert_same_swarm,
    begin,
    make_problem,
    make_twins,
    padded,
    problem_of,
    random_population,
    workspace,
)
from helpers.compiled import compiled
from helpers.loops import looped
from oracles import naive
from swarm_gym.optimizers.firefly import Firefly, FireflyParameters, move_towards
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import select

PAPER = FireflyParameters(noise=2.0, attractiveness=0.1, absorption=5e-6)
STRONG = {"noise": 30.0, "attractiveness": 0.9, "absorption": 1e-7}
SOURCES = (*CASES, "random")


# Parameters.


def test_parameters_have_the_printed_symbols():
    assert {name: parameter.symbol for name, parameter in Firefly.parameters.items()} == {
        "noise": "alpha",
        "attractiveness": "beta0",
        "absorption": "gamma",
    }


def test_chosen_parameters_take_the_place_of_the_defaults():
    chosen = {"absorption": 1, "noise": 0.5}
    assert Firefly.parameter_values(chosen) == PAPER._replace(noise=0.5, absorption=1.0)


# One move.


@given(data=st.data(), num_waypoints=st.integers(1, 9))
@settings(deadline=None, derandomize=True)
def test_a_move_is_the_naive_one(data, num_waypoints):
    offsets = arrays(np.float64, num_waypoints, elements=st.floats(-300, 300))
    position, brighter = data.draw(offsets), data.draw(offsets)
    noise = data.draw(arrays(np.float64, num_waypoints, elements=st.floats(0, 1, exclude_max=True)))
    parameters = data.draw(
        st.builds(FireflyParameters, st.floats(0, 500), st.floats(0, 1), st.floats(0, 1e-4))
    )
    table = make_problem("case1", num_waypoints).table
    work = workspace(num_waypoints)
    work.path[:], work.noise[:] = as_path(position), padded(noise)
    compiled(move_towards)(parameters, table, work, padded(brighter))
    expected = naive.firefly_move(
        position, brighter, noise, [-300.0] * num_waypoints, [300.0] * num_waypoints, *parameters
    )
    np.testing.assert_allclose(work.path, as_path(expected), rtol=1e-12, atol=1e-9)
    assert work.path[0] == 0.0
    assert (work.path[num_waypoints + 1 :] == 0.0).all()


def test_a_move_of_values_known_by_hand():
    table = make_problem("case1", 2).table
    work = workspace(2)
    work.path[:], work.noise[:] = as_path([0.0, 10.0]), padded([0.5, 1.0])
    # Squared distance 30^2 + 40^2 = 2500: the attraction is 0.8 exp(-1).
    parameters = FireflyParameters(noise=6.0, attractiveness=0.8, absorption=1 / 2500)
    compiled(move_towards)(parameters, table, work, padded([30.0, 50.0]))
    pull = 0.8 * math.exp(-1)
    assert work.path.tolist() == pytest.approx(as_path([30 * pull, 10 + 40 * pull + 3]).tolist())


# One iteration.


def fireflies(source, size, seed, num_waypoints=31, **options):
    """(swarms, tables, twin) of a random population."""
    problem = problem_of(source, num_waypoints)
    return make_twins(problem, random_population(np.random.default_rng(seed), problem, size), seed, **options)


def iterated(source, size, seed, repair_degree, parameters, num_waypoints=31):
    """Swarms before an iteration of fireflies and after it, held against the oracle."""
    swarms, tables, twin = fireflies(source, size, seed, num_waypoints)
    before = Swarms(*map(np.copy, swarms))
    values = advance("firefly", swarms, tables, size, repair_degree, parameters)
    twin.step(size, repair_degree, values)
    assert_same_swarm(swarms, twin)
    return before, swarms


@looped("seed", range(2))
@looped("repair_degree", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("parameters", [{}, STRONG], ids=["paper", "strong"])
@pytest.mark.parametrize("source", SOURCES)
def test_an_iteration_is_the_naive_one(source, parameters, repair_degree, seed):
    iterated(source, 6, seed, repair_degree, parameters)


@looped("num_waypoints", [1, 2, 3, 4, 5, 8])
@looped("repair_degree", [0.0, 0.5])
def test_iterations_with_few_waypoints_are_the_naive_ones(num_waypoints, repair_degree):
    run("firefly", problem_of("random", num_waypoints), [(8, repair_degree)] * 3, size=8)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("source", SOURCES)
def test_an_iteration_of_a_large_swarm_is_the_naive_one(source, seed):
    iterated(source, 25, seed, (seed % 3) / 2, {})


@looped("seed", range(5))
@pytest.mark.parametrize("source", SOURCES)
def test_each_move_costs_one_evaluation_and_one_random_number_per_column(source, seed):
    swarms, tables, _ = fireflies(source, 20, seed, 31)
    before, counter = swarms.evaluations[0], swarms.stream[0, 3].copy()
    advance("firefly", swarms, tables, 20, 0.0)
    moves = swarms.evaluations[0] - before
    assert 0 < moves <= 20 * 19
    # The last words of the stream are counters.
    assert (swarms.stream[0, 3] - counter).sum() == 32 * moves


def test_with_no_attraction_and_no_noise_each_pair_moves_once_and_nobody_leaves():
    still = {"noise": 0.0, "attractiveness": 0.0, "absorption": 0.0}
    before, swarms = iterated("case1", 20, 0, 0.0, still)
    assert len(set(swarms.fitness[0, :20])) == 20
    assert swarms.evaluations[0] == 20 + 20 * 19 // 2
    assert (swarms.positions == before.positions).all()


def test_with_full_attraction_all_gather_at_the_brightest():
    _, swarms = iterated("case1", 20, 0, 0.0, {"noise": 0.0, "attractiveness": 1.0, "absorption": 0.0})
    expected = np.broadcast_to(swarms.best_position[0], (20, 32))
    np.testing.assert_allclose(swarms.positions[0, :20], expected, atol=1e-9)


@pytest.mark.parametrize("size", [1, 4])
def test_equals_do_not_move(size):
    problem = make_problem("case1")
    population = np.tile(random_population(np.random.default_rng(0), problem, 1), (size, 1))
    swarms, tables, _ = make_twins(problem, population, 0)
    before = Swarms(*map(np.copy, swarms))
    advance("firefly", swarms, tables, size, 1.0)
    swarms.iteration[:] = before.iteration
    assert_same_bits(swarms, before)


def test_moves_stay_in_the_workspace_however_strong_the_noise():
    swarms, tables, _ = fireflies("random", 15, 1, 31)
    advance("firefly", swarms, tables, 15, 0.5, {"noise": 1e4})
    table = compiled(select)(tables, 0)
    assert (swarms.positions[0, :15] >= table.lower).all()
    assert (swarms.positions[0, :15] <= table.upper).all()
    inner = swarms.positions[0, :15, :31]
    at_border = (inner == table.lower[:31]) | (inner == table.upper[:31])
    assert at_border.mean() > 0.5


# Whole steps of batches.


def batch(num):
    """Swarms on different maps."""
    problems = [problem_of(SOURCES[b % len(SOURCES)], 9) for b in range(num)]
    return begin("firefly", problems, 5)


def test_a_swarm_with_parameters_of_its_own_gives_the_same_bits_in_a_batch_of_any_width():
    wide, tables = batch(7)
    narrow, narrow_tables = batch(2)
    for step in range(4):
        for swarms, of_problems in ((wide, tables), (narrow, narrow_tables)):
            b = np.arange(len(swarms.size))
            parameters = np.array(Firefly.parameter_values({})) * (1 + b[:, np.newaxis])
            sizes, repair_degrees = 2 + (5 * b + 7 * step) % 20, (b + step) % 3 / 2
            Firefly.step(swarms, of_problems, b >= 0, sizes, repair_degrees, parameters, MEAN_WEIGHT)
    assert_same_bits(Swarms(*(field[:2] for field in wide)), narrow)


def test_steps_are_a_resize_an_iteration_and_a_summary_as_naive():
    swarms, tables, twin = fireflies("case3", 6, 1, 9, budget=160)
    np.testing.assert_allclose(swarms.summary[0], naive.summary(twin, MEAN_WEIGHT), rtol=1e-10)
    for size, repair_degree in ((10, 0.0), (4, 0.5), (4, 1.0), (9, 0.0), (12, 0.0), (14, 0.0)):
        values = advance("firefly", swarms, tables, size, repair_degree)
        twin.step(size, repair_degree, values)
        assert_same_swarm(swarms, twin)
        expected = naive.summary(twin, MEAN_WEIGHT)
        np.testing.assert_allclose(swarms.summary[0], expected, rtol=1e-10, atol=1e-9)
    assert swarms.evaluations[0] == 160


@pytest.mark.parametrize("source", SOURCES)
def test_the_first_population_is_uniform_in_the_initial_range_as_naive_and_ends_with_the_budget(source):
    for size in (12, 20):
        swarms, twin = run("firefly", problem_of(source, 9), [], size=size, budget=15, seed=4)
        assert swarms.size[0] == min(size, 15)
        np.testing.assert_allclose(swarms.summary[0], naive.summary(twin, MEAN_WEIGHT), rtol=1e-10)


def test_only_the_chosen_swarms_begin():
    swarms, tables = batch(3)
    before = Swarms(*map(np.copy, swarms))
    chosen = np.array([False, True, False])
    Firefly.initialise(swarms, tables, chosen, np.array([9, 9, 9]), MEAN_WEIGHT)
    assert_same_bits(Swarms(*(f[~chosen] for f in swarms)), Swarms(*(f[~chosen] for f in before)))
    assert swarms.size.tolist() == [5, 9, 5]
