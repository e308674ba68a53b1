import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import (
    MEAN_WEIGHT,
    assert_same_swarm,
    begin,
    make_twins,
    padded,
    problem_of,
    random_population,
    twins_of,
    workspace,
)
from helpers.compiled import compiled
from helpers.loops import looped
from oracles import naive
from swarm_gym.population import Swarms, add_members, clear, grow, resize, shrink, summarise
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.tables import select
from swarm_gym.scenarios import Circle, Scenario

SIZES = (1, 2, 3, 12)


def labelled_swarm(fitness, collision):
    """Return one swarm of given values, in which the position of member i is the number i."""
    size = len(fitness)
    swarms = Swarms.allocate(1, size, 2)
    swarms.size[0] = size
    swarms.fitness[0], swarms.collision[0] = fitness, collision
    swarms.positions[0] = np.arange(size)[:, np.newaxis]
    return swarms


def survivors(swarms):
    labels = swarms.positions[0, : swarms.size[0]]
    assert (labels[:, 0] == labels[:, 1]).all()
    return labels[:, 0].astype(int).tolist()


# Beginning.


@pytest.mark.parametrize("source", ["case1", "case2", "random"])
@pytest.mark.parametrize("size", SIZES)
def test_an_adopted_population_is_evaluated_as_it_stands(source, size):
    swarms, _, _, twin = twins_of(source, size, 1, 7)
    assert_same_swarm(swarms, twin)
    assert swarms.evaluations[0] == size
    np.testing.assert_allclose(swarms.summary[0], naive.summary(twin, MEAN_WEIGHT), rtol=1e-12)


def test_a_cleared_swarm_has_no_members_and_no_best():
    swarms, _, _, _ = twins_of("case1", 3, 1, 7)
    clear(swarms, 0)
    assert swarms.size[0] == 0
    assert swarms.evaluations[0] == 0
    assert math.isinf(swarms.best_fitness[0])
    assert math.isinf(swarms.best_collision[0])


# E(P).


@given(
    collision=st.lists(st.one_of(st.floats(0, 5000), st.sampled_from([0.0, 1e-9, 2e-9, 1e-12])), min_size=1),
    mean_weight=st.floats(0, 1),
)
@settings(deadline=None, derandomize=True)
def test_the_summary_is_the_naive_one(collision, mean_weight):
    swarms = labelled_swarm(np.zeros(len(collision)), collision)
    compiled(summarise)(swarms, 0, mean_weight)
    expected = naive.population_collision(collision, mean_weight)
    assert swarms.summary[0, :4].tolist() == pytest.approx(expected, rel=1e-10, abs=1e-10)


DEVIATION = math.sqrt(12)  # 36 / 3, with the denominator size - 1


@pytest.mark.parametrize(
    ("collision", "size", "expected"),
    [
        ([0.0, 0.0, 6.0, 6.0], 4, [0.3 + 0.9 * DEVIATION, 3.0, DEVIATION, 0.5]),
        ([50.0], 1, [5.0, 50.0, 0.0, 0.0]),
        ([1.0, 2.0, 700.0, 900.0], 2, [0.15 + 0.9 * math.sqrt(0.5), 1.5, math.sqrt(0.5), 0.0]),  # the living
    ],
)
def test_the_summary_is_that_of_values_known_by_hand(collision, size, expected):
    swarms = labelled_swarm([0.0] * len(collision), collision)
    swarms.size[0] = size
    compiled(summarise)(swarms, 0, 0.1)
    assert swarms.summary[0, :4].tolist() == pytest.approx(expected)
    assert (swarms.summary[0, 4] == 0.0) == (size == 1)


# Growing.


GROWTHS = [(source, size, size + 9) for source in ("case1", "case3", "random") for size in SIZES]
SHRINKAGES = [("case3", 12, new_size) for new_size in (1, 2, 7, 11)]


@looped("seed", range(5))
@pytest.mark.parametrize(
    ("source", "size", "new_size"), [*GROWTHS, *SHRINKAGES, ("case1", 5, 5), ("case3", 12, 12)]
)
def test_another_size_is_taken_on_as_naive(source, size, new_size, seed):
    swarms, table, work, twin = twins_of(source, size, seed, 7)
    compiled(resize)(swarms, 0, table, work, new_size)
    twin.resize(new_size)
    assert_same_swarm(swarms, twin)


@pytest.mark.parametrize("seed", range(5))
def test_new_members_lie_in_the_box_of_the_old_ones_and_are_counted(seed):
    swarms, table, work, _ = twins_of("case1", 4, seed, 7)
    old = swarms.positions[0, :4].copy()
    compiled(grow)(swarms, 0, table, work, 30)
    new = swarms.positions[0, 4:30]
    assert swarms.size[0] == 30
    assert swarms.evaluations[0] == 30
    assert (swarms.positions[0, :4] == old).all()
    assert (new >= old.min(axis=0)).all()
    assert (new <= old.max(axis=0)).all()
    # Spread over the box, not in a corner of it.
    assert (np.ptp(new, axis=0)[:7] > 0.5 * np.ptp(old, axis=0)[:7]).all()


def test_rows_of_former_members_do_not_widen_the_box():
    swarms, table, work, _ = twins_of("case1", 3, 0, 7)
    swarms.positions[0, 3:] = 290.0
    old = swarms.positions[0, :3].copy()
    compiled(grow)(swarms, 0, table, work, 20)
    assert (swarms.positions[0, :20] <= old.max(axis=0)).all()


def test_where_a_component_has_no_extent_the_workspace_stands_in():
    problem = problem_of("case1", 7)
    population = random_population(np.random.default_rng(0), problem, 3)
    population[:, 2] = 17.0
    swarms, tables, twin = make_twins(problem, population, 5)
    compiled(resize)(swarms, 0, compiled(select)(tables, 0), workspace(7), 32)
    twin.resize(32)
    assert_same_swarm(swarms, twin)
    new = swarms.positions[0, 3:32]
    assert np.ptp(new[:, 2]) > 400
    assert np.ptp(new[:, 1]) < 360


def test_a_single_member_grows_into_the_whole_workspace():
    swarms, table, work, _ = twins_of("case1", 1, 0, 7)
    compiled(grow)(swarms, 0, table, work, 32)
    new = swarms.positions[0, 1:32, :7]
    assert (np.ptp(new, axis=0) > 400).all()
    assert (np.abs(new) <= 300).all()


@pytest.mark.parametrize("left", [-2, 0, 1, 4, 5, 6])
def test_growth_ends_exactly_where_the_budget_does_or_has_done(left):
    swarms, table, work, twin = twins_of("case2", 3, 1, 7, budget=3 + max(left, 0))
    swarms.budget[0] = twin.budget = 3 + left
    compiled(resize)(swarms, 0, table, work, 8)
    twin.resize(8)
    assert_same_swarm(swarms, twin)
    assert swarms.size[0] == swarms.evaluations[0] == 3 + min(max(left, 0), 5)


def test_members_are_added_uniformly_in_the_given_box():
    swarms, table, work, twin = twins_of("case1", 2, 3, 7)
    lower, upper = np.linspace(-200, 0, 7), np.linspace(10, 200, 7)
    compiled(add_members)(swarms, 0, table, work, 30, lower, upper)
    twin.members += twin.draw(30, lower.tolist(), upper.tolist())
    assert_same_swarm(swarms, twin)


# Shrinking.


values = st.one_of(st.sampled_from([0.0, 1.0, 2.0]), st.floats(0, 100))
members = st.lists(
    st.tuples(values, st.one_of(values, st.sampled_from([1e-9, 0.9e-9, 1.1e-9]))), min_size=1, max_size=12
)


@given(members=members, share=st.floats(0, 1))
@settings(deadline=None, derandomize=True)
def test_shrinking_deletes_the_naive_choice_and_the_survivors_keep_their_order(members, share):
    fitness, collision = map(list, zip(*members, strict=True))
    size = len(members)
    new_size = 1 + int(share * (size - 1))
    swarms = labelled_swarm(fitness, collision)
    compiled(shrink)(swarms, 0, new_size)
    doomed = naive.deletion_order(fitness, collision)[: size - new_size]
    kept = [i for i in range(size) if i not in doomed]
    assert survivors(swarms) == kept
    assert swarms.fitness[0, :new_size].tolist() == [fitness[i] for i in kept]
    assert swarms.collision[0, :new_size].tolist() == [collision[i] for i in kept]


@pytest.mark.parametrize(
    ("fitness", "collision", "order"),
    [
        pytest.param([1, 9, 5], [0, 0, 0], [1, 2, 0], id="feasible: worst fitness first"),
        pytest.param([1, 9, 5], [7, 3, 8], [2, 0, 1], id="infeasible: worst collision first"),
        pytest.param([1, 9, 5], [7, 0, 3], [0, 2, 1], id="infeasible before feasible"),
        pytest.param([4, 6, 5], [2, 2, 2], [1, 2, 0], id="same collision: worse fitness first"),
        pytest.param([4, 4, 4], [2, 2, 2], [2, 1, 0], id="same in both: the later first"),
        pytest.param([4, 4, 4], [0, 0, 0], [2, 1, 0], id="same and feasible: the later first"),
        pytest.param([4, 9, 1], [5e-10, 9e-10, 2e-9], [2, 1, 0], id="feasible within tolerance"),
    ],
)
def test_members_are_deleted_in_this_order(fitness, collision, order):
    for new_size in (2, 1):
        swarms = labelled_swarm(fitness, collision)
        compiled(shrink)(swarms, 0, new_size)
        assert survivors(swarms) == sorted(order[3 - new_size :])


@looped("seed", range(10))
def test_many_resizes_are_the_naive_ones(seed):
    rng = np.random.default_rng(seed)
    swarms, table, work, twin = twins_of("random", 6, seed, 7, budget=40)
    for new_size in rng.integers(1, 20, 8):
        compiled(resize)(swarms, 0, table, work, new_size)
        twin.resize(int(new_size))
        assert_same_swarm(swarms, twin)
    assert swarms.evaluations[0] <= 40


# Best so far.


def test_the_best_so_far_survives_the_deletion_of_its_member():
    bump = Circle(500, 310, 13)
    scenario = Scenario("bump", (20.0, 300.0), (980.0, 300.0), (bump,), initial_range=(-9, 9))
    problem = AnalyticProblem(scenario, 7)
    # The least fitness collides a little; the other member is longer and feasible.
    grazing, detour = np.zeros(7), np.full(7, 250.0)
    swarms, tables, _ = make_twins(problem, [grazing, detour], 0)
    fitness, collision = problem.evaluate(grazing)
    assert collision > 0
    assert fitness < problem.evaluate(detour)[0]
    compiled(resize)(swarms, 0, compiled(select)(tables, 0), workspace(7), 1)
    assert swarms.positions[0, 0, :7].tolist() == detour.tolist()
    assert swarms.best_position[0, :7].tolist() == grazing.tolist()
    assert (swarms.best_fitness[0], swarms.best_collision[0]) == (fitness, collision)


def test_a_new_member_that_is_better_becomes_the_best_so_far():
    swarms, table, work, _ = twins_of("case1", 3, 0, 7)
    before = swarms.best_fitness[0]
    compiled(add_members)(swarms, 0, table, work, 1, padded(np.full(7, 250.0)), padded(np.full(7, 250.0)))
    assert swarms.best_fitness[0] < before
    assert swarms.best_position[0, :7].tolist() == [250.0] * 7
    assert swarms.best_fitness[0] == swarms.fitness[0, 3]


def test_an_equal_member_does_not_replace_the_best_so_far():
    problem = AnalyticProblem(Scenario("empty", (20.0, 300.0), (980.0, 300.0), ()), 1)
    swarms, _, _ = make_twins(problem, [[50.0], [-50.0]], 0)
    assert swarms.fitness[0, 0] == swarms.fitness[0, 1]
    assert swarms.best_position[0, 0] == 50.0


def test_swarms_of_a_batch_do_not_touch_each_other():
    problem = problem_of("case1", 7)
    rng = np.random.default_rng(0)
    populations = [random_population(rng, problem, 4) for _ in range(3)]
    swarms, tables = begin("firefly", [problem] * 3, 4, populations=populations)
    before = [np.copy(field) for field in swarms]
    compiled(resize)(swarms, 1, compiled(select)(tables, 1), workspace(7), 9)
    for field, old in zip(swarms, before, strict=True):
        assert (field[[0, 2]] == old[[0, 2]]).all()
    assert swarms.size.tolist() == [4, 9, 4]
