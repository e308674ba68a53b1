"""The improved artificial fish swarm (IAFSA); what holds for every optimizer is in test_optimizers.py."""

import numpy as np
import pytest
from test_optimizers import problems

from helpers import fish
from helpers.builders import advance, begin, small_grid_problem

NAME = "improved-fish-swarm"
# Fish that cannot move but by the pull of the origin; and that leap to where they are.
STILL = {"step": 0.0, "smallest_step": 0.0, "visual": 0.0, "smallest_visual": 0.0}
BLIND = {"visual": 0.0, "smallest_visual": 0.0}


# The first population.


@pytest.mark.parametrize("kind", ["analytic", "curve", "polyline"])
def test_a_first_population_is_the_better_of_each_member_and_its_opposite(kind):
    problem = problems(NAME)[kind]
    lower, upper = problem.initial_bounds
    swarms, _ = begin(NAME, [problem], size=12)
    drawn, _ = begin("generational-firefly", [problem], size=12)
    for i in range(12):
        member = drawn.positions[0, i, : problem.dimension]
        pair = [member, lower + upper - member]
        fitness = [problem.evaluate(position)[0] for position in pair]
        better = pair[int(np.argmin(fitness))]
        np.testing.assert_allclose(swarms.positions[0, i, : problem.dimension], better)
        assert swarms.fitness[0, i] == pytest.approx(min(fitness))
    assert swarms.evaluations[0] == 2 * 12
    assert swarms.best_fitness[0] == swarms.fitness[0, :12].min()
    assert not np.array_equal(swarms.positions[0, :12], drawn.positions[0, :12])


@pytest.mark.parametrize("budget", [8, 9, 12, 15, 16, 17])
def test_as_many_members_are_opposed_as_the_budget_allows(budget):
    problem = problems(NAME)["analytic"]
    swarms, _ = begin(NAME, [problem], size=8, budget=budget)
    drawn, _ = begin(NAME, [problem], size=8, budget=8)
    whole, _ = begin(NAME, [problem], size=8)
    opposed = min(budget - 8, 8)
    assert swarms.evaluations[0] == 8 + opposed
    assert (swarms.positions[0, :opposed] == whole.positions[0, :opposed]).all()
    assert (swarms.positions[0, opposed:] == drawn.positions[0, opposed:]).all()


def test_given_members_are_not_opposed():
    problem = problems(NAME)["curve"]
    population = np.random.default_rng(0).uniform(*problem.bounds, (5, problem.dimension))
    swarms, _ = begin(NAME, [problem], size=5, populations=[population])
    assert swarms.evaluations[0] == 5
    assert swarms.positions[0, :5, : problem.dimension].tolist() == population.tolist()


def test_growth_is_not_opposed():
    parameters = {**STILL, "crowding": 0.0, "tries": 1.0}
    assert fish.spent(NAME, fish.zigzags(8), parameters) == 1 + 8 * (2 + 3)
    assert fish.spent(NAME, fish.zigzags(8), parameters, size=12) == 4 + 1 + 12 * (2 + 3)


# Schedules: in the first, the middle and the last of ten iterations.


@pytest.mark.parametrize(
    ("iteration", "iterations", "visual"),
    [(0, 10, 0.31), (5, 10, 0.0231811), (9, 10, 0.0100000), (1, 2, 0.0231811), (200, 400, 0.0231811)],
)
def test_the_visual_falls_like_a_gaussian_of_third_order_of_the_share_done(iteration, iterations, visual):
    ways = fish.displacements(NAME, fish.straight(32), {}, iteration=iteration, iterations=iterations)
    fish.assert_up_to(np.abs(ways), visual * (1 + 1e-5))


@pytest.mark.parametrize(
    ("iteration", "step", "beta"), [(0, 0.11, 0.9), (5, 0.0555938, 0.55), (9, 0.0178484, 0.27)]
)
def test_moves_are_of_a_share_beta_of_a_step_that_falls_like_a_gaussian(iteration, step, beta):
    parameters = {**BLIND, "crowding": 0.0}
    ways = fish.displacements(NAME, fish.zigzags(32), parameters, iteration=iteration)
    fish.assert_up_to(fish.lengths(ways), step * beta * (1 + 1e-5))


# Moves.


@pytest.mark.parametrize("tries", [1, 5])
def test_where_nothing_is_better_a_fish_preys_and_leaps_twice_and_looks_at_the_best_so_far(tries):
    count = fish.spent(NAME, fish.straight(6), {"tries": float(tries)})
    assert count == 1 + 6 * (2 * (tries + 1) + 1)


@pytest.mark.parametrize(("crowding", "each"), [(0.0, 2), (0.5, 2), (0.51, 3), (1.0, 3)])
def test_fish_gather_where_fewer_than_the_crowding_see_the_centre(crowding, each):
    """Two of four do. A step of no length is no better, so a fish that swarms preys one evaluation later."""
    side = fish.zigzags(1)[0]
    near, far = 0.05 * fish.RANGE * side / side.std(), 0.2 * fish.RANGE * side / side.std()
    near, far = (np.clip(position, -290.0, 290.0) for position in (near, far))
    population = [near, -near, far, -far]
    parameters = {"visual": 0.12, "smallest_visual": 0.0, "step": 0.0, "smallest_step": 0.0, "tries": 1.0}
    assert fish.spent(NAME, population, {**parameters, "crowding": crowding}) == 1 + 4 * (each + 3)


def test_the_centre_is_the_mean_of_all_and_the_first_to_be_evaluated():
    """However short the fish's sight."""
    side = fish.zigzags(1)[0]
    swarms, tables = fish.begun(NAME, [3.0 * side, side, -side])
    swarms.budget[0], before = 3 + 1, swarms.positions.copy()
    advance(NAME, swarms, tables, 3, 1.0, BLIND)
    assert swarms.evaluations[0] == 4
    np.testing.assert_allclose(swarms.best_position[0, :9], side)
    assert (swarms.positions == before).all()


def test_fish_follow_the_best_so_far_which_none_of_them_need_be_or_see():
    here = 3.0 * fish.zigzags(1)[0]
    swarms, tables = fish.begun(NAME, [here], num=60)
    best = fish.open_problem().evaluate(np.zeros(9))
    swarms.best_position[:] = 0.0
    swarms.best_fitness[:], swarms.best_collision[:] = best
    advance(NAME, swarms, tables, 1, 0.0, {**BLIND, "tries": 1.0})
    ways = (swarms.positions[:, 0, :9] - here) / fish.RANGE
    along, is_all = fish.components_along(ways, -here)
    followed = is_all & (along > 0)
    assert followed.sum() > 60 / 4
    fish.assert_up_to(fish.lengths(ways[followed]), 0.9 * 0.11)


@pytest.mark.parametrize("kind", ["analytic", "curve"])
def test_fish_that_leap_nowhere_get_better_or_stay(kind):
    swarms, tables = begin(NAME, [problems(NAME)[kind]], size=12)
    improved = 0
    for _ in range(3):
        before, positions = swarms.fitness[0, :12].copy(), swarms.positions[0, :12].copy()
        advance(NAME, swarms, tables, 12, 0.0, BLIND)
        is_better = swarms.fitness[0, :12] < before
        stayed = (swarms.positions[0, :12] == positions).all(axis=1)
        assert (is_better | stayed).all()
        improved += is_better.sum()
    assert improved > 0


# The pull of the origin.


@pytest.mark.parametrize(("iteration", "beta"), [(0, 0.9), (5, 0.55), (9, 0.27)])
@pytest.mark.parametrize("pull", [0.0, 0.5, 1.0])
def test_as_printed_moves_begin_nearer_to_the_origin(pull, iteration, beta):
    """Moves without length are the pull alone."""
    population = fish.zigzags(8)
    parameters = {**STILL, "origin_pull": pull}
    ways = fish.displacements(NAME, population, parameters, iteration=iteration)[0]
    np.testing.assert_allclose(ways, -pull * beta * population / fish.RANGE, atol=1e-12)


def test_prey_is_pulled_too():
    """With the pull, the first try of a fish is better than its position."""
    parameters = {**STILL, "crowding": 0.0}
    assert fish.spent(NAME, fish.zigzags(8), {**parameters, "origin_pull": 1.0}) == 1 + 8 * 2
    assert fish.spent(NAME, fish.zigzags(8), {**parameters, "origin_pull": 0.0}) == 1 + 8 * (6 + 7)


def test_leaps_are_not_pulled():
    """On a map far from the origin the pull presses fish into a corner; those that it makes worse leap."""
    problem = small_grid_problem("bezier", 2, seed=4, origin=(1e3, 1e3), y_up=True)
    swarms, tables = begin(NAME, [problem], size=8)
    before = swarms.positions[0, :8, :4].copy()
    advance(NAME, swarms, tables, 8, 0.0, {**STILL, "origin_pull": 1.0})
    after = swarms.positions[0, :8, :4]
    stayed, pressed = (after == before).all(axis=1), (after == problem.bounds[0]).all(axis=1)
    assert (stayed | pressed).all()
    assert stayed.any()


def moved_map(pull, shift):
    """Return positions after four iterations on a shifted map, relative to the map."""
    origin = np.array([3.0, -2.0]) + shift
    problem = small_grid_problem("bezier", 3, seed=4, origin=tuple(origin.tolist()), y_up=True)
    swarms, tables = begin(NAME, [problem], size=10, iterations=5)
    for _ in range(4):
        advance(NAME, swarms, tables, 10, 0.0, {"origin_pull": pull})
    return swarms.positions[0, :10, :6] - np.repeat(shift, 3), int(swarms.evaluations[0])


def test_a_swarm_moves_with_its_map_without_the_pull_only():
    shift = np.array([16.0, -8.0])
    here, spent_here = moved_map(0.0, 0.0 * shift)
    there, spent_there = moved_map(0.0, shift)
    np.testing.assert_allclose(there, here, atol=1e-6)
    assert spent_there == spent_here
    pulled_here, _ = moved_map(1.0, 0.0 * shift)
    pulled_there, _ = moved_map(1.0, shift)
    assert np.abs(pulled_there - pulled_here).max() > 1.0
