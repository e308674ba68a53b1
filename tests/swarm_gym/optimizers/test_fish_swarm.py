"""The standard artificial fish swarm; what holds for every optimizer is in test_optimizers.py."""

import numpy as np
import pytest
from test_optimizers import problems, run

from helpers.builders import advance, begin, make_problem
from helpers.fish import (
    assert_up_to,
    bad_values,
    begun,
    components_along,
    displacements,
    lengths,
    open_problem,
    repairs_in_place,
    spent,
    straight,
    zigzags,
)
from swarm_gym.errors import SettingError
from swarm_gym.optimizers.fish.standard import FishSwarm

NAME = "fish-swarm"


def test_the_defaults_are_the_printed_parameters_and_five_tries():
    defaults = {"visual": 0.3, "step": 0.1, "crowding": 0.6, "tries": 5.0}
    assert FishSwarm.parameter_values({})._asdict() == defaults
    assert list(FishSwarm.parameters) == list(defaults)


@pytest.mark.parametrize(("name", "value"), bad_values(*FishSwarm.parameters))
def test_a_bad_parameter_is_refused_with_its_name(name, value):
    with pytest.raises(SettingError, match=name):
        FishSwarm.parameter_values({name: value})


@pytest.mark.parametrize("kind", ["analytic", "one waypoint", "polyline"])
@pytest.mark.parametrize(
    "parameters",
    [
        {"tries": 1.0, "visual": 1.0, "crowding": 1.0},
        {"tries": 7.0, "crowding": 0.1},
        {"tries": 2.9, "visual": 0.05, "step": 0.5},
        {"visual": 1.0, "step": 1.0, "crowding": 0.1},
    ],
)
def test_episodes_with_other_parameters_are_the_naive_ones(kind, parameters):
    run(NAME, problems(NAME)[kind], [(6, 0.0), (9, 0.7), (4, 1.0)], parameters, size=6, iterations=3)


def test_paths_of_another_dimension_see_and_step_as_far():
    """Lengths are root mean squares: 31 waypoints are no reason to be alone."""
    run(NAME, make_problem("case3", 31), [(8, 0.0), (8, 0.5)], {"visual": 0.2}, size=8, iterations=2)


# Prey.


@pytest.mark.parametrize("tries", [1, 2, 7])
def test_a_lone_fish_preys_twice_and_leaps_where_all_tries_fail(tries):
    assert spent(NAME, straight(1), {"tries": float(tries)}) == 2 * (tries + 1)


def test_tries_are_whole():
    assert spent(NAME, straight(1), {"tries": 3.9}) == 2 * (3 + 1)


def test_the_first_try_that_is_better_ends_prey():
    """One try and one step, or a leap, cost the same; with many tries hardly any fish leaps."""
    population = zigzags(12)
    few = spent(NAME, population, {"tries": 1.0, "visual": 0.001})
    many = spent(NAME, population, {"tries": 20.0, "visual": 0.001})
    assert few == 12 * 2 * 2
    assert few < many < 12 * 2 * 5


@pytest.mark.parametrize("visual", [0.05, 0.3])
@pytest.mark.parametrize("iteration", [0, 5, 9])
def test_leaps_are_as_long_as_the_visual_at_any_time(iteration, visual):
    ways = displacements(NAME, straight(32), {"visual": visual}, iteration=iteration)
    assert (lengths(ways) > 0).all()
    assert_up_to(np.abs(ways), visual)
    assert ways.min() < -0.9 * visual


@pytest.mark.parametrize("step", [0.02, 0.1])
@pytest.mark.parametrize("iteration", [0, 5, 9])
def test_steps_are_as_long_as_the_parameter_at_any_time_however_near_what_was_seen_is(iteration, step):
    parameters = {"visual": 0.01, "step": step, "crowding": 0.0, "tries": 20.0}
    assert_up_to(lengths(displacements(NAME, zigzags(32), parameters, iteration=iteration)), step)


def test_a_fish_leaves_the_best_place_and_the_swarm_remembers_it():
    swarms, tables = begun(NAME, straight(1))
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
    assert spent(NAME, zigzags(12), {"tries": 1.0, **parameters}) == 12 * each


def test_fish_that_are_not_crowded_swarm_and_follow_at_one_evaluation_each():
    count = spent(NAME, zigzags(12), {"tries": 1.0, "visual": 1.0, "crowding": 1.0})
    assert 12 * 3 <= count < 12 * 4


@pytest.mark.parametrize(("crowding", "count"), [(0.5, 5 + 5), (0.51, 3 + 5)])
def test_as_many_companions_as_the_crowding_allows_are_too_many(crowding, count):
    """Each of two fish is half the swarm to the other; the second one is at the best place, and preys."""
    population = [[60.0] * 9, [0.0] * 9]
    assert spent(NAME, population, {"visual": 0.9, "crowding": crowding, "tries": 1.0}) == count


def test_a_fish_steps_straight_to_a_better_companion():
    here = zigzags(1)[0] * 3.0
    ways = displacements(NAME, [here, 0.0 * here], {"visual": 0.9, "crowding": 1.0}, num=60)[:, 0]
    along, is_all = components_along(ways, -here)
    assert is_all.all()
    assert (along > 0).all()
    assert_up_to(lengths(ways), 0.1)


@pytest.mark.parametrize("dimension", [1, 9, 31])
@pytest.mark.parametrize(("visual", "sees"), [(0.19, False), (0.21, True)])
def test_fish_see_as_far_as_the_visual_whatever_the_number_of_waypoints(visual, sees, dimension):
    """The fish are a fifth of the range apart. One that sees evaluates the centre first, without a draw."""
    swarms, tables = begun(NAME, [[120.0] * dimension, [0.0] * dimension])
    swarms.budget[0] = swarms.evaluations[0] + 1
    before = swarms.stream.copy()
    advance(NAME, swarms, tables, 2, 0.0, {"visual": visual})
    assert swarms.evaluations[0] == swarms.budget[0]
    assert (swarms.stream == before).all() == sees


def test_a_leader_in_a_crowd_is_not_followed_though_the_fish_sees_nobody_else():
    """The first fish has one companion, which has three: the fish swarms, but preys instead of following."""
    side = zigzags(1)[0]
    side *= 60.0 / np.sqrt((side**2).mean())
    population = [2.0 * side, 1.0 * side, 0.1 * side, 0.0 * side]
    for crowding, follows in ((0.5, False), (1.0, True)):
        ways = displacements(NAME, population, {"visual": 0.12, "crowding": crowding}, num=60)[:, 0]
        _, is_all = components_along(ways, -side)
        assert is_all.all() == follows
        assert is_all.any()


def test_a_centre_that_is_better_than_every_fish_counts_but_is_not_the_best_so_far():
    """The centre of the first fish is evaluated first; the bulletin lists only fish."""
    side = zigzags(1)[0]
    population = [3.0 * side, side, -0.5 * side]
    assert open_problem().evaluate(0.25 * side)[0] < open_problem().evaluate(population[2])[0]
    swarms, tables = begun(NAME, population)
    swarms.budget[0], before = 3 + 1, swarms.positions.copy()
    advance(NAME, swarms, tables, 3, 1.0, {"visual": 1.0})
    assert swarms.evaluations[0] == 3 + 1
    np.testing.assert_array_equal(swarms.best_position[0, :9], population[2])
    assert (swarms.positions == before).all()


def test_where_fish_come_to_is_repaired():
    assert all(repairs_in_place(NAME, {"visual": 0.0, "step": 0.0}, 1))


@pytest.mark.parametrize("tries", [1, 5])
@pytest.mark.parametrize("kind", ["analytic", "curve"])
def test_a_fish_takes_three_evaluations_at_least_and_two_full_preys_and_a_centre_at_most(kind, tries):
    swarms, tables = begin(NAME, [problems(NAME)[kind]], size=15)
    for repair_degree in (0.0, 0.0, 1.0, 1.0):
        before = swarms.evaluations[0]
        advance(NAME, swarms, tables, 15, repair_degree, {"tries": float(tries)})
        assert 3 * 15 <= swarms.evaluations[0] - before <= (2 * tries + 3) * 15


def test_fish_stay_where_they_are_when_the_budget_ends_before_their_turn():
    swarms, tables = begin(NAME, [open_problem()], size=10, budget=10 + 20)
    before = swarms.positions[0, :10].copy()
    advance(NAME, swarms, tables, 10, 0.0)
    moved = (swarms.positions[0, :10] != before).any(axis=1).tolist()
    assert moved[0]
    assert moved == sorted(moved, reverse=True)
    assert not moved[-1]
