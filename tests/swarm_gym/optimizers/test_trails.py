"""Pheromone trails against a plain array, and the deposits of ants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.ants import NAME, problem_of, trails_of
from helpers.builders import advance, begin, random_grid_scenario, walk_problem
from helpers.compiled import compiled
from swarm_gym.optimizers.ant_colony import trails
from swarm_gym.optimizers.ant_colony import walk as ant_colony_walk
from swarm_gym.optimizers.ant_colony.ant_colony import AntColony
from swarm_gym.problem import WalkProblem
from swarm_gym.problem.tables import stack


class PlainTrails:
    """Tau of all moves; all evaporate, get their deposits and are clipped in every round."""

    def __init__(self, num_cells):
        self.tau = np.ones((num_cells, 8))

    def renew(self, evaporation, laid):
        self.tau *= 1.0 - evaporation
        for cell, move, amount in laid:
            self.tau[cell, move] += amount
        self.tau = np.clip(self.tau, 1e-4, 10.0)


def straight_way(column, row, to_column):
    return np.array([[k, row] for k in range(column, to_column)], dtype=np.int32).reshape(-1, 2)


WIDTH, HEIGHT = 5, 3
WAYS = st.tuples(st.integers(0, 4), st.integers(0, 2), st.integers(0, 5), st.floats(0.0, 12.0))
ROUNDS = st.lists(
    st.tuples(st.sampled_from([0.0, 0.1, 0.1, 0.1, 0.5, 1.0]), st.lists(WAYS, max_size=3)), max_size=40
)


def renew(array, evaporation, ways):
    trails.evaporate(array, evaporation)
    for column, row, to_column, amount in ways:
        trails.lay_on_walk(array, WIDTH, straight_way(column, row, to_column), amount)
    for column, row, to_column, _ in ways:
        trails.settle_walk(array, WIDTH, straight_way(column, row, to_column))


@given(ROUNDS, st.lists(st.integers(0, WIDTH * HEIGHT - 1), max_size=40), st.booleans())
@settings(max_examples=60, deadline=None)
def test_trails_that_evaporate_where_they_are_looked_at_have_the_bits_of_plain_ones(rounds, looks, again):
    array, plain = np.zeros(trails.trails_size(WIDTH * HEIGHT)), PlainTrails(WIDTH * HEIGHT)
    if again:
        # An episode before this one leaves nothing but memory.
        trails.begin_trails(array)
        renew(array, 0.3, [(0, 0, 5, 3.0), (1, 1, 4, 20.0)])
    trails.begin_trails(array)
    for k, (evaporation, ways) in enumerate(rounds):
        renew(array, evaporation, ways)
        laid = [
            (row * WIDTH + at, 0, amount)
            for column, row, to_column, amount in ways
            for at in range(column, to_column - 1)
        ]
        plain.renew(evaporation, laid)
        if k < len(looks):
            place = compiled(trails.current_trails)(array, looks[k])
            assert array[place : place + 8].tolist() == plain.tau[looks[k]].tolist()
    for cell in range(WIDTH * HEIGHT):
        place = compiled(trails.current_trails)(array, cell)
        assert array[place : place + 8].tolist() == plain.tau[cell].tolist()


def test_moves_are_numbered_as_ants_and_trails_do_it():
    steps = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
    assert list(zip(trails.STEP_COLUMNS, trails.STEP_ROWS, strict=True)) == steps
    for k, (column, row) in enumerate(steps):
        assert trails.MOVE_BY_STEP[row + 1, column + 1] == k


@pytest.mark.parametrize("elite_weight", [0.0, 3.0])
def test_a_cohort_lays_on_its_ways_what_is_due_and_the_best_way_once_more(elite_weight):
    """One ant has one possible walk, and lays the same on each of its moves."""
    problem = problem_of("S....T", resolution=2.0)
    swarms, tables = begin(NAME, [problem], size=1)
    first = AntColony.parameter_values({})
    tau = 0.8 * np.ones((6, 8))
    tau[:5, 0] += first.deposit * (1.0 + first.elite_weight)
    np.testing.assert_allclose(trails_of(swarms, problem)[0], tau, rtol=1e-14)
    parameters = {"evaporation": 0.25, "deposit": 0.5, "elite_weight": elite_weight}
    advance(NAME, swarms, tables, 1, 0.0, parameters)
    tau *= 0.75
    tau[:5, 0] += 0.5 * (1.0 + elite_weight)
    np.testing.assert_allclose(trails_of(swarms, problem)[0], tau, rtol=1e-14)


def test_memory_of_places_where_nothing_was_laid_is_not_touched():
    problem = problem_of("S...T....... ............ ............")
    swarms, _ = begin(NAME, [problem], size=1)
    num_cells = problem.scenario.map.blocked.size
    per_cell = swarms.field[0, trails.NUM_COMMON : trails.trails_size(num_cells)].reshape(num_cells, 9)
    assert 0 < (per_cell != 0.0).any(axis=1).sum() < 12
    assert AntColony.field_size(stack([problem.table])) == trails.trails_size(
        num_cells
    ) + ant_colony_walk.memory_size(num_cells)


def test_an_episode_on_another_map_of_the_stack_begins_as_a_fresh_one():
    problems = [walk_problem("random", 4), WalkProblem(random_grid_scenario(6, shape=(30, 12)))]
    swarms, tables = begin(NAME, problems, size=8)
    fresh, _ = begin(NAME, problems, size=8)
    for _ in range(4):
        advance(NAME, swarms, tables, 8, 0.0)
    for used in (swarms, fresh):
        used.problem[:], used.stream[:] = [1, 0], fresh.stream
        AntColony.initialise(used, tables, np.full(2, True), np.full(2, 8), 0.1)
    for _ in range(3):
        for used in (swarms, fresh):
            advance(NAME, used, tables, 8, 0.0)
        assert (swarms.positions == fresh.positions).all()
        assert (swarms.fitness == fresh.fitness).all()
