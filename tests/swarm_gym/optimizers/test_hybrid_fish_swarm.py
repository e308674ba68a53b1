"""The hybrid fish swarm (HAAFSA-R); what holds for every optimizer is in test_optimizers.py."""

import math

import numpy as np
import pytest

from helpers import fish
from helpers.builders import advance

NAME = "hybrid-fish-swarm"
TINY = {"visual": 0.02, "smallest_visual": 0.05}
BLIND = {"visual": 0.0, "smallest_visual": 0.0}
# Of twelve iterations: what is left of visual and step where no smallest value holds them.
SHARES = [(0, 1.0), (3, 1.0), (4, 1.0), (6, 0.625), (8, 0.25), (9, 0.25 * math.exp(-1.25))]


# Segments of the run.


VISUALS = [
    *((iteration, {}, share * 0.3) for iteration, share in SHARES),
    (11, {}, 0.01),  # in the last third it does not fall below the smallest, which before does not matter
    *((iteration, TINY, visual) for iteration, visual in ((0, 0.02), (6, 0.0125), (9, 0.05))),
]
STEPS = [*((iteration, {"smallest_step": 0.0}, share * 0.1) for iteration, share in SHARES), (11, {}, 0.01)]


@pytest.mark.parametrize(("iteration", "parameters", "visual"), VISUALS)
def test_the_visual_falls_by_segments_to_its_smallest(iteration, parameters, visual):
    parameters = {"tries": 1.0, **parameters}
    ways = fish.displacements(NAME, fish.straight(60), parameters, iteration=iteration, iterations=12)
    fish.assert_up_to(np.abs(ways), visual)


@pytest.mark.parametrize(("iteration", "parameters", "step"), STEPS)
def test_the_step_falls_by_segments_to_its_smallest(iteration, parameters, step):
    """Fish that see nothing better, and leap nowhere, step to the best so far."""
    parameters = {**BLIND, **parameters}
    ways = fish.displacements(NAME, fish.zigzags(60), parameters, iteration=iteration, iterations=12)
    fish.assert_up_to(fish.lengths(ways), step)


@pytest.mark.parametrize(("tries", "whole"), [(1.0, 1), (5.0, 5), (2.9, 2)])
@pytest.mark.parametrize(("iteration", "times"), [(0, 1), (3, 1), (4, 2), (7, 2), (8, 3), (11, 3)])
def test_tries_are_whole_and_double_and_treble(iteration, times, tries, whole):
    """A lone fish where nothing is better preys twice: all tries of one round, then a leap or a step."""
    count = fish.spent(NAME, fish.straight(1), {"tries": tries}, iteration=iteration, iterations=12)
    assert count == 2 * (times * whole + 1)


# Prey.


def test_prey_goes_all_the_way_to_the_best_of_its_tries_three_times_at_most():
    """The waypoint is far from the line: the slope is longer than three rounds."""
    parameters = {"visual": 0.1, "tries": 20.0, "step": 0.01}
    ways = fish.displacements(NAME, [[290.0]], parameters, num=30)[:, 0, 0]
    assert (ways >= -3 * 0.1).all()
    assert (ways < -2 * 0.1).all()
    assert fish.spent(NAME, [[290.0]], parameters) == 2 * 3 * 20


def test_prey_that_finds_something_better_never_makes_a_fish_worse():
    """Prey that finds nothing better can make a fish worse."""
    swarms, tables = fish.begun(NAME, fish.zigzags(1), num=60)
    before = swarms.fitness[0, 0]
    advance(NAME, swarms, tables, 1, 0.0, {"tries": 20.0, "visual": 0.05})
    assert (swarms.fitness[:, 0] < before).all()
    swarms, tables = fish.begun(NAME, fish.straight(1), num=60)
    before = swarms.fitness[0, 0]
    advance(NAME, swarms, tables, 1, 0.0)
    assert (swarms.fitness[:, 0] > before).any()


def test_where_nothing_is_better_half_of_the_preys_lead_to_the_best_so_far():
    """The fish are there already; of two preys, one that leaps is worse than one that does not."""
    stayed = (fish.displacements(NAME, fish.straight(1), {}, num=400) == 0.0).all(axis=(1, 2))
    assert 0.65 < stayed.mean() < 0.85


def test_the_best_so_far_that_prey_leads_to_need_not_live_or_be_seen():
    here = 3.0 * fish.zigzags(1)[0]
    swarms, tables = fish.begun(NAME, [here], num=100)
    swarms.best_position[:] = 0.0
    swarms.best_fitness[:], swarms.best_collision[:] = fish.open_problem().evaluate(np.zeros(9))
    advance(NAME, swarms, tables, 1, 0.0, BLIND)
    ways = (swarms.positions[:, 0, :9] - here) / fish.RANGE
    along, is_all = fish.components_along(ways, -here)
    assert is_all.all()
    assert 0.65 < (along > 0).mean() < 0.85
    fish.assert_up_to(fish.lengths(ways), 0.1)


def test_where_fish_come_to_is_repaired_tries_of_prey_too():
    """Repaired at its place, a fish may be better, and prey goes on from there."""
    still = {**BLIND, "step": 0.0, "smallest_step": 0.0}
    assert all(fish.repairs_in_place(NAME, still, 3))
    assert not all(fish.repairs_in_place(NAME, still, 1))
