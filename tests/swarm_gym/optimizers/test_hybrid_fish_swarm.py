"""The hybrid fish swarm (HAAFSA-R); what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest
from test_optimizers import problems, run

from helpers.builders import advance, begin
from helpers.fish import (
    RANGE,
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
from swarm_gym.optimizers.fish.hybrid import HybridFishSwarm

NAME = "hybrid-fish-swarm"
DEFAULTS = {
    "visual": 0.3,
    "step": 0.1,
    "smallest_visual": 0.01,
    "smallest_step": 0.01,
    "crowding": 0.6,
    "tries": 5.0,
}
BLIND = {"visual": 0.0, "smallest_visual": 0.0}
# Of twelve iterations: what is left of visual and step where no smallest value holds them.
SHARES = [(0, 1.0), (3, 1.0), (4, 1.0), (6, 0.625), (8, 0.25), (9, 0.25 * math.exp(-1.25))]


def test_the_defaults_are_those_of_the_other_fish():
    assert HybridFishSwarm.parameter_values({})._asdict() == DEFAULTS
    assert list(HybridFishSwarm.parameters) == list(DEFAULTS)


@pytest.mark.parametrize(("name", "value"), bad_values(*DEFAULTS))
def test_a_bad_parameter_is_refused_with_its_name(name, value):
    with pytest.raises(SettingError, match=name):
        HybridFishSwarm.parameter_values({name: value})


def test_no_tries_are_refused():
    with pytest.raises(SettingError, match="tries"):
        HybridFishSwarm.parameter_values({"tries": 0.0})


@pytest.mark.parametrize("kind", ["analytic", "one waypoint", "polyline"])
@pytest.mark.parametrize(
    "parameters",
    [
        {"tries": 1.0, "visual": 1.0, "crowding": 1.0},
        {"tries": 7.0, "crowding": 0.1},
        {"tries": 2.9, "visual": 0.05, "step": 0.5},
        {"tries": 2.0, "smallest_visual": 0.2, "smallest_step": 0.2, "crowding": 0.1},
    ],
)
def test_episodes_with_other_parameters_are_the_naive_ones(kind, parameters):
    run(NAME, problems(NAME)[kind], [(4, 0.0), (6, 0.7), (3, 1.0)], parameters, size=4, iterations=3)


# Segments of the run.


@pytest.mark.parametrize(("iteration", "share"), SHARES)
def test_the_visual_falls_by_segments(iteration, share):
    ways = displacements(NAME, straight(60), {"tries": 1.0}, iteration=iteration, iterations=12)
    assert_up_to(np.abs(ways), share * 0.3)


@pytest.mark.parametrize(("iteration", "share"), SHARES)
def test_the_step_falls_by_segments(iteration, share):
    """Fish that see nothing better, and leap nowhere, step to the best so far."""
    parameters = {**BLIND, "smallest_step": 0.0}
    ways = displacements(NAME, zigzags(60), parameters, iteration=iteration, iterations=12)
    assert_up_to(lengths(ways), share * 0.1)


def test_in_the_last_third_visual_and_step_do_not_fall_below_their_smallest():
    at_end = {"iteration": 11, "iterations": 12}
    assert_up_to(np.abs(displacements(NAME, straight(60), {"tries": 1.0}, **at_end)), 0.01)
    assert_up_to(lengths(displacements(NAME, zigzags(60), BLIND, **at_end)), 0.01)


@pytest.mark.parametrize(("iteration", "visual"), [(0, 0.02), (6, 0.0125), (9, 0.05)])
def test_before_that_the_smallest_do_not_matter(iteration, visual):
    parameters = {"visual": 0.02, "smallest_visual": 0.05, "tries": 1.0}
    ways = displacements(NAME, straight(60), parameters, iteration=iteration, iterations=12)
    assert_up_to(np.abs(ways), visual)


@pytest.mark.parametrize("tries", [1, 5])
@pytest.mark.parametrize(("iteration", "times"), [(0, 1), (3, 1), (4, 2), (7, 2), (8, 3), (11, 3)])
def test_tries_double_and_treble(iteration, times, tries):
    """A lone fish where nothing is better preys twice: all tries of one round, then a leap or a step."""
    count = spent(NAME, straight(1), {"tries": float(tries)}, iteration=iteration, iterations=12)
    assert count == 2 * (times * tries + 1)


def test_tries_are_whole_before_they_are_multiplied():
    assert spent(NAME, straight(1), {"tries": 2.9}, iteration=8, iterations=12) == 2 * (3 * 2 + 1)


# Prey.


def test_prey_goes_all_the_way_to_the_best_of_its_tries_three_times_at_most():
    """The waypoint is far from the line: the slope is longer than three rounds."""
    parameters = {"visual": 0.1, "tries": 20.0, "step": 0.01}
    ways = displacements(NAME, [[290.0]], parameters, num=30)[:, 0, 0]
    assert (ways >= -3 * 0.1).all()
    assert (ways < -2 * 0.1).all()
    assert spent(NAME, [[290.0]], parameters) == 2 * 3 * 20


def test_prey_that_finds_something_better_never_makes_a_fish_worse():
    """Prey that finds nothing better can make a fish worse."""
    swarms, tables = begun(NAME, zigzags(1), num=60)
    before = swarms.fitness[0, 0]
    advance(NAME, swarms, tables, 1, 0.0, {"tries": 20.0, "visual": 0.05})
    assert (swarms.fitness[:, 0] < before).all()
    swarms, tables = begun(NAME, straight(1), num=60)
    before = swarms.fitness[0, 0]
    advance(NAME, swarms, tables, 1, 0.0)
    assert (swarms.fitness[:, 0] > before).any()


def test_where_nothing_is_better_half_of_the_preys_lead_to_the_best_so_far():
    """The fish are there already; of two preys, one that leaps is worse than one that does not."""
    stayed = (displacements(NAME, straight(1), {}, num=400) == 0.0).all(axis=(1, 2))
    assert 0.65 < stayed.mean() < 0.85


def test_the_best_so_far_that_prey_leads_to_need_not_live_or_be_seen():
    here = 3.0 * zigzags(1)[0]
    swarms, tables = begun(NAME, [here], num=100)
    swarms.best_position[:] = 0.0
    swarms.best_fitness[:], swarms.best_collision[:] = open_problem().evaluate(np.zeros(9))
    advance(NAME, swarms, tables, 1, 0.0, BLIND)
    ways = (swarms.positions[:, 0, :9] - here) / RANGE
    along, is_all = components_along(ways, -here)
    assert is_all.all()
    assert 0.65 < (along > 0).mean() < 0.85
    assert_up_to(lengths(ways), 0.1)


def test_where_fish_come_to_is_repaired_tries_of_prey_too():
    """Repaired at its place, a fish may be better, and prey goes on from there."""
    still = {**BLIND, "step": 0.0, "smallest_step": 0.0}
    assert all(repairs_in_place(NAME, still, 3))
    assert not all(repairs_in_place(NAME, still, 1))


# Swarming and following.


@pytest.mark.parametrize(("crowding", "count"), [(0.5, 5 + 5), (0.51, 3 + 5)])
def test_as_many_companions_as_the_crowding_allows_are_too_many(crowding, count):
    """One try from the best place fails, so that prey costs 2; that of the other fish may cost 3."""
    population = [[60.0] * 9, [0.0] * 9]
    parameters = {"visual": 0.9, "crowding": crowding, "tries": 1.0}
    found = spent(NAME, population, parameters)
    assert count <= found <= count + (2 if crowding == 0.5 else 0)


def test_a_fish_steps_straight_to_a_better_companion():
    here = zigzags(1)[0] * 3.0
    ways = displacements(NAME, [here, 0.0 * here], {"visual": 0.9, "crowding": 1.0}, num=60)[:, 0]
    along, is_all = components_along(ways, -here)
    assert is_all.all()
    assert (along > 0).all()
    assert_up_to(lengths(ways), 0.1)


@pytest.mark.parametrize("tries", [1, 4])
@pytest.mark.parametrize("kind", ["analytic", "curve"])
def test_evaluations_of_an_iteration_lie_between_what_the_rules_give(kind, tries):
    """From a centre and two steps to a centre and two preys of three rounds."""
    swarms, tables = begin(NAME, [problems(NAME)[kind]], size=15, iterations=3)
    for iteration, repair_degree in enumerate((0.0, 1.0, 0.0)):
        before = swarms.evaluations[0]
        advance(NAME, swarms, tables, 15, repair_degree, {"tries": float(tries)})
        most = 1 + 2 * 3 * tries * (1 + iteration)
        assert 15 * 3 <= swarms.evaluations[0] - before <= 15 * most
