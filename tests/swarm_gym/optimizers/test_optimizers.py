"""Tests of every optimizer; the test file with its name has those of a single one."""

import gymnasium
import numpy as np
import pytest

from helpers.builders import (
    METRES,
    advance,
    assert_same_as_oracle,
    begin,
    function_problem,
    is_walker,
    make_problem,
    options_for,
    oracle_twin,
    problem_for,
    problem_of,
    small_grid_problem,
    walk_problem,
    walked,
)
from helpers.loops import looped
from helpers.slow import slow_but
from oracles import naive_optimizers
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.population import Swarms
from swarm_gym.registration import environment_id

all_optimizers = pytest.mark.parametrize("optimizer", OPTIMIZERS)
ADOPTING = [name for name in OPTIMIZERS if get_optimizer(name).adopts]

# (size, repair degree) of steps: growing and shrinking, within regions of MOA and across them.
PLAN = [(7, 0.0), (7, 1.0), (12, 0.0), (15, 0.4), (6, 0.4), (5, 0.0), (2, 1.0), (9, 0.0)]
# Evaluations beyond the first population, which end in a growth, in an iteration and between two.
BUDGETS = (3, 7, 9, 14, 22, 47)


def problems(optimizer):
    if is_walker(optimizer):
        return {
            "cells": walk_problem("random", 4),
            "metres": walk_problem("random", 5, **METRES),
            "raster": walk_problem("case1"),
        }
    return {
        "analytic": make_problem("case1", 9),
        "one waypoint": problem_of("random", 1),
        "curve": small_grid_problem("bezier", 3, seed=4),
        "polyline": small_grid_problem("waypoints", 5, seed=5, **METRES),
        "function": function_problem("function:rastrigin-3-shifted:1"),
        "plain": function_problem("function:easom-2"),  # far from the optimum all fitness is 1
    }


def on_all_kinds(optimizers, long=()):
    """Mark kinds as slow whose kernels take much longer to compile than the test to run."""
    slow = {"function", "plain"}
    slow_of_many = {*slow, "curve", "polyline"}  # of those that evaluate hundreds of times in an iteration
    cases = [
        pytest.param(name, kind, marks=pytest.mark.slow)
        if kind in (slow_of_many if "fish" in name or name in long else slow)
        else (name, kind)
        for name in optimizers
        for kind in problems(name)
    ]
    return pytest.mark.parametrize(("optimizer", "kind"), cases)


def run(optimizer, problem, plan=PLAN, parameters=None, **options):
    """Advance swarms and their oracle along a plan, and compare them after every step."""
    if is_walker(optimizer):
        options["parameters"] = parameters
    swarms, tables = begin(optimizer, [problem], **options)
    twin = oracle_twin(optimizer, problem, **options)
    assert_same_as_oracle(swarms, twin)
    for size, repair_degree in plan:
        if swarms.evaluations[0] >= swarms.budget[0]:
            break
        values = advance(optimizer, swarms, tables, size, repair_degree, parameters)
        twin.step(size, repair_degree, values)
        assert_same_as_oracle(swarms, twin)
    return swarms, twin


def tries(optimizer, number):
    """Return the parameter `tries` if the optimizer has it: fewer tries take plain Python less time."""
    return {"tries": float(number)} if "tries" in get_optimizer(optimizer).parameters else {}


def spent_to_begin(optimizer, problem, size):
    """Return the evaluations of a first population; some optimizers take more than one per member."""
    swarms, _ = begin(optimizer, [problem], size)
    return int(swarms.evaluations[0])


# Against plain Python.


def test_every_optimizer_has_an_oracle():
    assert naive_optimizers.NAIVE.keys() == OPTIMIZERS.keys()


# Plain Python takes long on grids; these two create members in an iteration, and keep a memory.
FAST_ON_GRIDS = ("multivariate", "differential-evolution")


@on_all_kinds(naive_optimizers.NAIVE, long=sorted({*naive_optimizers.NAIVE} - {*FAST_ON_GRIDS}))
def test_episodes_are_the_naive_ones(optimizer, kind):
    parameters = tries(optimizer, 1) if kind == "curve" else {}
    run(optimizer, problems(optimizer)[kind], parameters=parameters, size=7, iterations=len(PLAN))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "optimizer",
    slow_but(
        [name for name in naive_optimizers.NAIVE if name != "hybrid-fish-swarm"], naive_optimizers.NAIVE
    ),
)
def test_episodes_of_several_seeds_are_the_naive_ones(optimizer, seed):
    plan = [(10, seed / 3), (14, 0.0), (9, 1.0), (9, 0.0), (20, 0.5)]
    run(optimizer, problem_for(optimizer, "random", 6, seed), plan, size=10, seed=seed, iterations=5)


@looped("left", BUDGETS)
@pytest.mark.parametrize(
    "optimizer",
    slow_but([name for name in naive_optimizers.NAIVE if name != "ant-colony"], naive_optimizers.NAIVE),
)
def test_episodes_end_exactly_where_the_budget_does_as_naive(optimizer, left):
    plan, problem = [(7, 0.0), (12, 0.5), *[(12, 0.0)] * 60], problem_for(optimizer, "case2", 9)
    budget = spent_to_begin(optimizer, problem, 7) + left
    swarms, _ = run(optimizer, problem, plan, size=7, budget=budget, iterations=len(plan))
    assert swarms.evaluations[0] == budget


@pytest.mark.parametrize(
    "optimizer", slow_but(("firefly", "multivariate", "fish-swarm", "cma-es"), naive_optimizers.NAIVE)
)
def test_episodes_of_all_budgets_are_the_naive_ones(optimizer):
    """Budgets end in the first population, in a growth, or in an iteration."""
    plan, problem = [(3, 1.0), (5, 0.5), (4, 0.0)], problem_for(optimizer, "random", 3)
    for budget in range(3, 40):
        run(optimizer, problem, plan, tries(optimizer, 2), size=3, budget=budget, iterations=len(plan))


@looped("size", [2, 5, 14])
@pytest.mark.parametrize("optimizer", [name for name in ADOPTING if name in naive_optimizers.NAIVE])
def test_given_populations_are_taken_as_naive(optimizer, size):
    problem = problem_for(optimizer, "case1", 9)
    population = np.random.default_rng(size).uniform(*problem.bounds, (size, problem.dimension))
    swarms, tables = begin(optimizer, [problem], size, populations=[population])
    twin = oracle_twin(optimizer, problem, size, population=population)
    assert_same_as_oracle(swarms, twin)
    values = advance(optimizer, swarms, tables, size + 3, 0.5)
    twin.step(size + 3, 0.5, values)
    assert_same_as_oracle(swarms, twin)


# Properties of all.


def batch(optimizer, num, **options):
    kinds = ("case1", "case2", "case3", "random")
    problems = [problem_for(optimizer, kinds[b % 4], 9) for b in range(num)]
    return begin(optimizer, problems, size=8, **options)


def sizes_of(num, step):
    return 2 + (5 * np.arange(num) + 7 * step) % 20


def run_batch(optimizer, swarms, tables, steps=4, num_threads=1):
    num = len(swarms.size)
    for step in range(steps):
        degrees = (np.arange(num) + step) % 3 / 2
        advance(optimizer, swarms, tables, sizes_of(num, step), degrees, num_threads=num_threads)


def bits(field):
    return np.ascontiguousarray(field).view(np.uint64)


def assert_same_bits(swarms, others):
    for name, field, other in zip(Swarms._fields, swarms, others, strict=True):
        assert (bits(field) == bits(other)).all(), name


@all_optimizers
def test_one_thread_and_several_give_the_same_bits(optimizer):
    single, tables = batch(optimizer, 5)
    threaded, _ = batch(optimizer, 5)
    run_batch(optimizer, single, tables)
    run_batch(optimizer, threaded, tables, num_threads=3)
    assert_same_bits(single, threaded)


@all_optimizers
def test_a_swarm_gives_the_same_bits_in_a_batch_of_any_width(optimizer):
    wide, tables = batch(optimizer, 5)
    narrow, narrow_tables = batch(optimizer, 2)
    run_batch(optimizer, wide, tables)
    run_batch(optimizer, narrow, narrow_tables)
    assert_same_bits(Swarms(*(field[:2] for field in wide)), narrow)


@all_optimizers
def test_only_the_chosen_swarms_take_part(optimizer):
    swarms, tables = batch(optimizer, 4)
    chosen = np.array([True, False, True, False])
    before = Swarms(*map(np.copy, swarms))
    advance(optimizer, swarms, tables, 12, 0.5, chosen=chosen)
    swarms.iteration[:] = before.iteration
    assert_same_bits(Swarms(*(f[~chosen] for f in swarms)), Swarms(*(f[~chosen] for f in before)))
    assert (swarms.evaluations > before.evaluations)[chosen].all()


@on_all_kinds(OPTIMIZERS)
def test_what_is_stored_is_true_at_every_step(optimizer, kind):
    """Members lie inside the bounds and cost what is stored; the best so far is and was never worse.

    The best walk costs its length besides, and members are where none may ever have walked to.
    """
    problem = problems(optimizer)[kind]
    n, (low, high) = problem.dimension, problem.bounds
    swarms, tables = begin(optimizer, [problem], size=9)
    best = np.inf
    for size, repair_degree in PLAN:
        advance(optimizer, swarms, tables, size, repair_degree, tries(optimizer, 2))
        assert 1 <= swarms.size[0] <= size
        for i in range(swarms.size[0]):
            position = swarms.positions[0, i, :n]
            assert (low <= position).all()
            assert (position <= high).all()
            fitness, collision = problem.evaluate(position)
            assert swarms.collision[0, i] == collision
            if optimizer in ADOPTING:
                assert swarms.fitness[0, i] == fitness
            else:  # the way of a member counts, too, which its position does not tell
                assert swarms.fitness[0, i] > fitness
        fitness, collision = problem.evaluate(swarms.best_position[0, :n])
        if is_walker(optimizer):
            assert swarms.best_fitness[0] == pytest.approx(walked(swarms) + fitness, rel=1e-12)
        else:
            assert swarms.best_fitness[0] == fitness
            best = min(best, swarms.fitness[0, : swarms.size[0]].min())
        assert swarms.best_collision[0] == collision
        assert swarms.best_fitness[0] <= best
        best = swarms.best_fitness[0]


@looped("left", [0, *BUDGETS])
@all_optimizers
def test_a_budget_is_spent_exactly(optimizer, left):
    budget = spent_to_begin(optimizer, problem_for(optimizer, "case1", 9), 8) + left
    swarms, tables = batch(optimizer, 4, budget=budget, iterations=40)
    for step in range(20):
        run_batch(optimizer, swarms, tables, steps=1)
        advance(optimizer, swarms, tables, 20, 0.0)
        assert (swarms.evaluations <= budget).all(), step
    assert swarms.evaluations.tolist() == [budget] * 4


@all_optimizers
def test_a_new_episode_forgets_the_one_before(optimizer):
    """Only the random stream goes on."""
    used, tables = batch(optimizer, 2, iterations=5)
    run_batch(optimizer, used, tables)
    fresh, _ = batch(optimizer, 2, iterations=5)
    for swarms in (used, fresh):
        swarms.stream[:] = fresh.stream
        swarms.iteration[:] = 0
        cls = get_optimizer(optimizer)
        cls.initialise(swarms, tables, np.full(2, True), np.full(2, 6), 0.1)
    for _ in range(3):
        for swarms in (used, fresh):
            advance(optimizer, swarms, tables, 11, 0.5)
        for b in range(2):
            size = fresh.size[b]
            assert used.size[b] == size
            assert (used.positions[b, :size] == fresh.positions[b, :size]).all()
            assert used.evaluations[b] == fresh.evaluations[b]
    assert (used.best_fitness == fresh.best_fitness).all()


@all_optimizers
def test_a_swarm_gets_better_in_the_long_run(optimizer):
    # What there is of a robot's path is what it has walked, step by step.
    num_iterations, parameters = (100, {"step": 0.02}) if optimizer == "glowworm" else (20, {})
    swarms, tables = begin(
        optimizer, [problem_for(optimizer, "case1", 9)], size=20, iterations=num_iterations
    )
    begun = swarms.best_fitness[0]
    for _ in range(num_iterations):
        advance(optimizer, swarms, tables, 20, 0.0, parameters)
    assert swarms.best_fitness[0] < 0.9 * begun


# Through the environments.


@pytest.mark.parametrize("scenario", ["case1", "rooms:0"])
@pytest.mark.parametrize("optimizer", ADOPTING)
def test_given_populations_grow_and_shrink_in_environments(optimizer, scenario):
    options = {} if scenario == "case1" else options_for(optimizer, encoding="bezier", **tries(optimizer, 1))
    env = gymnasium.make(environment_id(optimizer), scenario=scenario, iterations=6, **options)
    problem = env.unwrapped.simulation.problems[0]
    population = np.random.default_rng(0).uniform(*problem.bounds, (5, problem.dimension))
    observation, info = env.reset(seed=1, options={"initial_population": population})
    assert observation in env.observation_space
    begun = [problem.scenario.start] if is_walker(optimizer) else population
    assert info["best_fitness"] == min(problem.evaluate(vector)[0] for vector in begun)
    assert info["evaluations"] == info["population_size"] == 5
    smallest = get_optimizer(optimizer).smallest_population
    for size in (9, max(3, smallest), 20, max(2, smallest), 14, 14):
        observation, reward, terminated, _, info = env.step(np.array([size, 0.5]))
        assert observation in env.observation_space
        assert np.isfinite(reward)
        assert smallest <= info["population_size"] <= size
    assert terminated
    env.close()
