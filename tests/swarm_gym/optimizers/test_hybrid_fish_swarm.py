"""The hybrid fish swarm (HAAFSA-R); what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest

from helpers.builders import advance
from helpers.fish import (
    RANGE,
    assert_up_to,
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

NAME = "hybrid-fish-swarm"
BLIND = {"visual": 0.0, "smallest_visual": 0.0}
# Of twelve iterations: what is left of visual and step where no smallest value holds them.
SHARES = [(0, 1.0), (3, 1.0), (4, 1.0), (6, 0.625), (8, 0.25), (9, 0.25 * math.exp(-1.25))]


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
