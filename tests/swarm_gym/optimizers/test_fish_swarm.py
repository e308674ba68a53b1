"""The standard artificial fish swarm; what holds for every optimizer is in test_optimizers.py."""

import numpy as np
import pytest
from test_optimizers import run

from helpers import fish
from helpers.builders import advance, begin, make_problem

NAME = "fish-swarm"


def test_paths_of_another_dimension_see_and_step_as_far():
    """Lengths are root mean squares: 31 waypoints are no reason to be alone."""
    run(NAME, make_problem("case3", 31), [(8, 0.0), (8, 0.5)], {"visual": 0.2}, size=8, iterations=2)


# Prey.


@pytest.mark.parametrize(("tries", "whole"), [(1.0, 1), (2.0, 2), (7.0, 7), (3.9, 3)])
def test_a_lone_fish_preys_twice_and_leaps_where_all_tries_fail(tries, whole):
    assert fish.spent(NAME, fish.straight(1), {"tries": tries}) == 2 * (whole + 1)


def test_the_first_try_that_is_better_ends_prey():
    """One try and one step, or a leap, cost the same; with many tries hardly any fish leaps."""
    population = fish.zigzags(12)
    few = fish.spent(NAME, population, {"tries": 1.0, "visual": 0.001})
    many = fish.spent(NAME, population, {"tries": 20.0, "visual": 0.001})
    assert few == 12 * 2 * 2
    assert few < many < 12 * 2 * 5


@pytest.mark.parametrize("visual", [0.05, 0.3])
@pytest.mark.parametrize("iteration", [0, 5, 9])
def test_leaps_are_as_long_as_the_visual_at_any_time(iteration, visual):
    ways = fish.displacements(NAME, fish.straight(32), {"visual": visual}, iteration=iteration)
    assert (fish.lengths(ways) > 0).all()
    fish.assert_up_to(np.abs(ways), visual)
    assert ways.min() < -0.9 * visual


@pytest.mark.parametrize("step", [0.02, 0.1])
@pytest.mark.parametrize("iteration", [0, 5, 9])
def test_steps_are_as_long_as_the_parameter_at_any_time_however_near_what_was_seen_is(iteration, step):
    parameters = {"visual": 0.01, "step": step, "crowding": 0.0, "tries": 20.0}
    fish.assert_up_to(
        fish.lengths(fish.displacements(NAME, fish.zigzags(32), parameters, iteration=iteration)), step
    )


def test_a_fish_leaves_the_best_place_and_the_swarm_remembers_it():
    swarms, tables = fish.begun(NAME, fish.straight(1))
    best = swarms.best_fitness[0]
    assert best == pytest.approx(0.3 * 960.0)
    advance(NAME, swarms, tables, 1, 0.0)
    assert swarms.fitness[0, 0] > best
    assert swarms.best_fitness[0] == best
    assert (swarms.best_position[0] == 0.0).all()


# Swarming and following.


@pytest.mark.parametrize(
    ("parameters", "each"),
    [({"visual": 0.001}, 2 + 2), ({"visual": 1.0, "crowding": 0.0}, 1 + 2 + 2)],
    ids=["nobody in sight", "always crowded"],
)
def test_fish_prey_without_companions_and_in_a_crowd(parameters, each):
    """Prey of one try costs two evaluations, and the centre of companions one, if there are any."""
    assert fish.spent(NAME, fish.zigzags(12), {"tries": 1.0, **parameters}) == 12 * each


def test_fish_that_are_not_crowded_swarm_and_follow_at_one_evaluation_each():
    count = fish.spent(NAME, fish.zigzags(12), {"tries": 1.0, "visual": 1.0, "crowding": 1.0})
    assert 12 * 3 <= count < 12 * 4


@pytest.mark.parametrize("dimension", [1, 9, 31])
@pytest.mark.parametrize(("visual", "sees"), [(0.19, False), (0.21, True)])
def test_fish_see_as_far_as_the_visual_whatever_the_number_of_waypoints(visual, sees, dimension):
    """The fish are a fifth of the range apart. One that sees evaluates the centre first, without a draw."""
    swarms, tables = fish.begun(NAME, [[120.0] * dimension, [0.0] * dimension])
    swarms.budget[0] = swarms.evaluations[0] + 1
    before = swarms.stream.copy()
    advance(NAME, swarms, tables, 2, 0.0, {"visual": visual})
    assert swarms.evaluations[0] == swarms.budget[0]
    assert (swarms.stream == before).all() == sees


def test_a_leader_in_a_crowd_is_not_followed_though_the_fish_sees_nobody_else():
    """The first fish has one companion, which has three: the fish swarms, but preys instead of following."""
    side = fish.zigzags(1)[0]
    side *= 60.0 / np.sqrt((side**2).mean())
    population = [2.0 * side, 1.0 * side, 0.1 * side, 0.0 * side]
    for crowding, follows in ((0.5, False), (1.0, True)):
        ways = fish.displacements(NAME, population, {"visual": 0.12, "crowding": crowding}, num=60)[:, 0]
        _, is_all = fish.components_along(ways, -side)
        assert is_all.all() == follows
        assert is_all.any()


def test_a_centre_that_is_better_than_every_fish_counts_but_is_not_the_best_so_far():
    """The centre of the first fish is evaluated first; the bulletin lists only fish."""
    side = fish.zigzags(1)[0]
    population = [3.0 * side, side, -0.5 * side]
    assert fish.open_problem().evaluate(0.25 * side)[0] < fish.open_problem().evaluate(population[2])[0]
    swarms, tables = fish.begun(NAME, population)
    swarms.budget[0], before = 3 + 1, swarms.positions.copy()
    advance(NAME, swarms, tables, 3, 1.0, {"visual": 1.0})
    assert swarms.evaluations[0] == 3 + 1
    np.testing.assert_array_equal(swarms.best_position[0, :9], population[2])
    assert (swarms.positions == before).all()


def test_fish_stay_where_they_are_when_the_budget_ends_before_their_turn():
    swarms, tables = begin(NAME, [fish.open_problem()], size=10, budget=10 + 20)
    before = swarms.positions[0, :10].copy()
    advance(NAME, swarms, tables, 10, 0.0)
    moved = (swarms.positions[0, :10] != before).any(axis=1).tolist()
    assert moved[0]
    assert moved == sorted(moved, reverse=True)
    assert not moved[-1]
