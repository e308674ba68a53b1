import math
import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from helpers.builders import (
    CASES,
    MEAN_WEIGHT,
    as_path,
    assert_same_swarm,
    make_problem,
    make_swarms,
    make_twins,
    padded,
    problem_of,
    random_population,
    twins_of,
    workspace,
)
from helpers.compiled import compiled
from oracles import naive
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.errors import SettingError
from swarm_gym.optimizers.firefly import Firefly, FireflyParameters, iterate, move_towards
from swarm_gym.optimizers.loop import step_chosen
from swarm_gym.population import Swarms
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.tables import select, stack

PAPER = FireflyParameters(noise=2.0, attractiveness=0.1, absorption=5e-6)
STRONG = FireflyParameters(noise=30.0, attractiveness=0.9, absorption=1e-7)
SOURCES = (*CASES, "random")


def words_drawn(swarms, before):
    """Return how many random numbers were drawn since; the last words of the stream are counters."""
    return int((swarms.stream[0, 3] - before).sum())


# Parameters.


def test_the_defaults_are_the_printed_parameters():
    assert Firefly.parameter_values({}) == PAPER
    assert {name: parameter.symbol for name, parameter in Firefly.parameters.items()} == {
        "noise": "alpha",
        "attractiveness": "beta0",
        "absorption": "gamma",
    }


def test_chosen_parameters_take_the_place_of_the_defaults():
    chosen = {"absorption": 1, "noise": 0.5}
    assert Firefly.parameter_values(chosen) == PAPER._replace(noise=0.5, absorption=1.0)


@pytest.mark.parametrize("name", ["noise", "attractiveness", "absorption"])
@pytest.mark.parametrize("value", [-1e-9, 1e9, math.nan, math.inf])
def test_a_parameter_out_of_its_range_is_refused_by_name_and_value(name, value):
    with pytest.raises(SettingError) as caught:
        Firefly.parameter_values({name: value})
    assert name in str(caught.value)
    assert repr(value) in str(caught.value)


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
        position, brighter, noise, [-300.0] * num_waypoints, [300.0] * num_waypoints, parameters
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


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("repair_degree", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("parameters", [PAPER, STRONG], ids=["paper", "strong"])
@pytest.mark.parametrize("source", SOURCES)
def test_an_iteration_is_the_naive_one(source, parameters, repair_degree, seed):
    swarms, table, work, twin = twins_of(source, 6, seed, 31)
    compiled(iterate)(parameters, swarms, 0, table, work, repair_degree)
    twin.iterate(repair_degree, parameters)
    assert_same_swarm(swarms, twin)


@pytest.mark.parametrize("num_waypoints", [1, 2, 3, 4, 5, 8])
@pytest.mark.parametrize("repair_degree", [0.0, 0.5])
def test_iterations_with_few_waypoints_are_the_naive_ones(num_waypoints, repair_degree):
    swarms, table, work, twin = twins_of("random", 8, 0, num_waypoints)
    for _ in range(3):
        compiled(iterate)(PAPER, swarms, 0, table, work, repair_degree)
        twin.iterate(repair_degree, PAPER)
        assert_same_swarm(swarms, twin)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("source", SOURCES)
def test_an_iteration_of_a_large_swarm_is_the_naive_one(source, seed):
    swarms, table, work, twin = twins_of(source, 25, seed, 31)
    repair_degree = (seed % 3) / 2
    compiled(iterate)(PAPER, swarms, 0, table, work, repair_degree)
    twin.iterate(repair_degree, PAPER)
    assert_same_swarm(swarms, twin)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("source", SOURCES)
def test_each_move_costs_one_evaluation_and_one_random_number_per_column(source, seed):
    swarms, table, work, _ = twins_of(source, 20, seed, 31)
    before, counter = swarms.evaluations[0], swarms.stream[0, 3].copy()
    compiled(iterate)(PAPER, swarms, 0, table, work, 0.0)
    moves = swarms.evaluations[0] - before
    assert 0 < moves <= 20 * 19
    assert words_drawn(swarms, counter) == 32 * moves


def test_with_no_attraction_and_no_noise_each_pair_moves_once_and_nobody_leaves():
    swarms, table, work, _ = twins_of("case1", 20, 0, 31)
    before = swarms.positions.copy()
    compiled(iterate)(FireflyParameters(0.0, 0.0, 0.0), swarms, 0, table, work, 0.0)
    assert len(set(swarms.fitness[0, :20])) == 20
    assert swarms.evaluations[0] == 20 + 20 * 19 // 2
    assert (swarms.positions == before).all()


def test_with_full_attraction_all_gather_at_the_brightest():
    swarms, table, work, _ = twins_of("case1", 20, 0, 31)
    compiled(iterate)(
        FireflyParameters(noise=0.0, attractiveness=1.0, absorption=0.0), swarms, 0, table, work, 0.0
    )
    expected = np.broadcast_to(swarms.best_position[0], (20, 32))
    np.testing.assert_allclose(swarms.positions[0, :20], expected, atol=1e-9)


@pytest.mark.parametrize("size", [1, 4])
def test_equals_do_not_move(size):
    problem = make_problem("case1")
    population = np.tile(random_population(np.random.default_rng(0), problem, 1), (size, 1))
    swarms, tables, _ = make_twins(problem, population, 0)
    before = [np.copy(field) for field in swarms]
    compiled(iterate)(PAPER, swarms, 0, compiled(select)(tables, 0), workspace(31), 1.0)
    for field, old in zip(swarms, before, strict=True):
        assert (field == old).all()


@pytest.mark.parametrize("repair_degree", [0.0, 0.5])
def test_stored_values_belong_to_the_stored_positions(repair_degree):
    swarms, table, work, twin = twins_of("case3", 15, 1, 31)
    problem = AnalyticProblem(twin.scenario)
    for _ in range(5):
        compiled(iterate)(STRONG, swarms, 0, table, work, repair_degree)
    for i in range(15):
        assert (swarms.fitness[0, i], swarms.collision[0, i]) == problem.evaluate(swarms.positions[0, i, :31])
    best = swarms.best_fitness[0], swarms.best_collision[0]
    assert best == problem.evaluate(swarms.best_position[0, :31])
    assert best[0] <= swarms.fitness[0, :15].min()


def test_moves_stay_in_the_workspace_however_strong_the_noise():
    swarms, table, work, _ = twins_of("random", 15, 1, 31)
    compiled(iterate)(PAPER._replace(noise=1e4), swarms, 0, table, work, 0.5)
    assert (swarms.positions[0, :15] >= table.lower).all()
    assert (swarms.positions[0, :15] <= table.upper).all()
    inner = swarms.positions[0, :15, :31]
    at_border = (inner == table.lower[:31]) | (inner == table.upper[:31])
    assert at_border.mean() > 0.5


@pytest.mark.parametrize("left", [0, 1, 2, 7, 20])
def test_an_iteration_ends_exactly_where_the_budget_does(left):
    swarms, table, work, twin = twins_of("case2", 8, 0, 31, budget=8 + left)
    compiled(iterate)(PAPER, swarms, 0, table, work, 0.2)
    twin.iterate(0.2, PAPER)
    assert swarms.evaluations[0] == 8 + left
    assert_same_swarm(swarms, twin)


# Whole steps of batches.


def batch(num, num_waypoints=9, size=5, budgets=None):
    """Return swarms on different maps; each begins the same in a batch of any width."""
    problems, populations = [], []
    for b in range(num):
        problem = problem_of(SOURCES[b % len(SOURCES)], num_waypoints)
        problems.append(problem)
        populations.append(random_population(np.random.default_rng(b), problem, size + b))
    return make_swarms(problems, populations, seeds=range(num), budgets=budgets)


def arguments(num, step):
    """Return (sizes, repair degrees, parameters, weight of the mean) of a step; they differ by swarm."""
    b = np.arange(num)
    sizes = 2 + (5 * b + 7 * step) % 20
    repair_degrees = (b + step) % 3 / 2
    parameters = np.array(PAPER) * (1 + b[:, np.newaxis])
    return sizes, repair_degrees, parameters, MEAN_WEIGHT


def advance(swarms, tables, steps=4):
    num = len(swarms.size)
    for step in range(steps):
        step_chosen(PAPER, swarms, tables, np.full(num, True), *arguments(num, step))


def bits(field):
    return np.ascontiguousarray(field).view(np.uint64)


def test_a_swarm_gives_the_same_bits_in_a_batch_of_any_width():
    wide, tables = batch(7)
    narrow, narrow_tables = batch(2)
    advance(wide, tables)
    advance(narrow, narrow_tables)
    for name, field, other in zip(Swarms._fields, wide, narrow, strict=True):
        assert (bits(field[:2]) == bits(other)).all(), name


def test_only_the_chosen_swarms_take_part():
    swarms, tables = batch(4)
    before = [np.copy(field) for field in swarms]
    chosen = np.array([True, False, True, False])
    step_chosen(PAPER, swarms, tables, chosen, *arguments(4, 1))
    for field, old in zip(swarms, before, strict=True):
        assert (bits(field[~chosen]) == bits(old[~chosen])).all()
    assert (swarms.evaluations[chosen] > before[Swarms._fields.index("evaluations")][chosen]).all()


def test_steps_are_a_resize_an_iteration_and_a_summary_as_naive():
    problem = problem_of("case3", 9)
    population = random_population(np.random.default_rng(1), problem, 6)
    swarms, tables, twin = make_twins(problem, population, 1, budget=160)
    for size, repair_degree in ((10, 0.0), (4, 0.5), (4, 1.0), (9, 0.0), (12, 0.0), (14, 0.0)):
        Firefly.step(
            swarms,
            tables,
            np.array([True]),
            np.array([size]),
            np.array([repair_degree]),
            np.array([PAPER]),
            MEAN_WEIGHT,
        )
        twin.resize(size)
        twin.iterate(repair_degree, PAPER)
        assert_same_swarm(swarms, twin)
        expected = naive.summary(twin, MEAN_WEIGHT)
        np.testing.assert_allclose(swarms.summary[0], expected, rtol=1e-10, atol=1e-9)
    assert swarms.evaluations[0] == 160


@pytest.mark.parametrize("left", [1, 3, 5, 9])
def test_a_step_never_spends_more_than_the_budget(left):
    swarms, tables = batch(3, budgets=[5 + left, 6 + left, 7 + left])
    advance(swarms, tables, steps=2)
    assert swarms.evaluations.tolist() == swarms.budget.tolist()


@pytest.mark.parametrize("source", SOURCES)
def test_the_first_population_is_uniform_in_the_initial_range_as_naive(source):
    problem = problem_of(source, 9)
    swarms = Swarms.allocate(1, 20, 9)
    swarms.budget[0] = 15
    swarms.stream[0] = seed_stream(np.random.SeedSequence(4))
    twin = naive.Swarm(problem.scenario, 0.3, naive.Stream(swarms.stream[0]), budget=15)
    table, bounds = problem.table, [bound.tolist() for bound in problem.initial_bounds]
    Firefly.initialise(swarms, stack([table]), np.array([True]), np.array([12]), MEAN_WEIGHT)
    twin.add(12, *bounds)
    assert_same_swarm(swarms, twin)
    np.testing.assert_allclose(swarms.summary[0], naive.summary(twin, MEAN_WEIGHT), rtol=1e-10)
    # A second beginning forgets the first one, but not where the stream is.
    twin.positions, twin.fitness, twin.collision = [], [], []
    twin.evaluations, twin.best = 0, (math.inf, math.inf, None)
    Firefly.initialise(swarms, stack([table]), np.array([True]), np.array([20]), MEAN_WEIGHT)
    twin.add(20, *bounds)
    assert swarms.size[0] == 15
    assert_same_swarm(swarms, twin)


def test_only_the_chosen_swarms_begin():
    swarms, tables = batch(3)
    before = [np.copy(field) for field in swarms]
    chosen = np.array([False, True, False])
    Firefly.initialise(swarms, tables, chosen, np.array([9, 9, 9]), MEAN_WEIGHT)
    for field, old in zip(swarms, before, strict=True):
        assert (bits(field[~chosen]) == bits(old[~chosen])).all()
    assert swarms.size.tolist() == [5, 9, 7]


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="takes long uncompiled")
def test_a_swarm_gets_better_in_the_long_run():
    swarms, tables = batch(4, num_waypoints=31, size=15)
    begun = swarms.best_fitness.copy()
    for _ in range(30):
        step_chosen(
            PAPER,
            swarms,
            tables,
            np.full(4, True),
            np.full(4, 20),
            np.zeros(4),
            np.tile(PAPER, (4, 1)),
            MEAN_WEIGHT,
        )
    assert (swarms.best_fitness < 0.9 * begun).all()
