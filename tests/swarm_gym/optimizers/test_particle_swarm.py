"""Particle swarm optimization; what holds for every optimizer is in test_optimizers.py."""

import numpy as np
import pytest
from test_optimizers import PLAN, problems, run
from test_re_evaluation import assert_same_memory

from helpers.builders import UNLIMITED, advance, begin, make_problem, oracle_twin

NAME = "particle-swarm"


def memory_of(swarms, problem, i):
    """Return velocity, own best position and its fitness of a particle."""
    width, n = swarms.positions.shape[2], problem.dimension
    memory = swarms.memory[0, i]
    return memory[:n], memory[width : width + n], memory[2 * width]


@pytest.mark.parametrize("kind", ["analytic", "curve"])
@pytest.mark.parametrize("budget", [UNLIMITED, 30])
def test_velocities_and_own_bests_are_the_naive_ones(kind, budget):
    problem = problems(NAME)[kind]
    swarms, tables = begin(NAME, [problem], size=7, budget=budget)
    twin = oracle_twin(NAME, problem, 7, budget)
    assert_same_memory(NAME, swarms, twin)
    for size, repair_degree in PLAN[:6]:
        values = advance(NAME, swarms, tables, size, repair_degree)
        twin.step(size, repair_degree, values)
        assert_same_memory(NAME, swarms, twin)


@pytest.mark.parametrize("iterations", [1, 2, 9])
def test_episodes_of_any_length_and_parameters_are_the_naive_ones(iterations):
    parameters = {"first_inertia": 0.9, "last_inertia": 0.4, "cognitive": 0.5, "social": 3.0}
    parameters["velocity_limit"] = 1.0
    plan = [(8, 0.0)] * iterations
    run(NAME, make_problem("case2", 9), plan, parameters, size=8, iterations=iterations)


def test_first_velocities_reach_a_fifth_of_the_range():
    problem = make_problem("case1", 9)
    swarms, _ = begin(NAME, [problem], size=32)
    velocities = swarms.memory[0, :32, :9]
    assert 0.19 * 600 < np.abs(velocities).max() <= 0.2 * 600
    assert (velocities < 0).any()


def test_new_and_given_particles_are_at_rest_and_the_others_are_not():
    problem = make_problem("case1", 9)
    swarms, tables = begin(NAME, [problem], size=6)
    advance(NAME, swarms, tables, 6, 0.0)
    before = swarms.memory[0, :6].copy()
    # Without inertia and pulls, those that grow at the start of the step stay.
    still = {"first_inertia": 0.0, "last_inertia": 0.0, "cognitive": 0.0, "social": 0.0}
    advance(NAME, swarms, tables, 10, 0.0, still)
    assert (swarms.memory[0, :10, :9] == 0.0).all()
    assert (before[:, :9] != 0.0).any(axis=1).all()
    for i in range(6, 10):
        velocity, own_best, own_fitness = memory_of(swarms, problem, i)
        assert (velocity == 0.0).all()
        assert own_best.tolist() == swarms.positions[0, i, :9].tolist()
        assert own_fitness == swarms.fitness[0, i]
    given, _ = begin(NAME, [problem], size=4, populations=[swarms.positions[0, :4, :9]])
    assert (given.memory[0, :4, :9] == 0.0).all()


def test_own_bests_are_never_worse_than_where_a_particle_is():
    problem = problems(NAME)["curve"]
    swarms, tables = begin(NAME, [problem], size=10)
    for size, repair_degree in PLAN:
        advance(NAME, swarms, tables, size, repair_degree)
        for i in range(swarms.size[0]):
            _, own_best, own_fitness = memory_of(swarms, problem, i)
            assert own_fitness == problem.evaluate(own_best)[0]
            assert swarms.best_fitness[0] <= own_fitness <= swarms.fitness[0, i]


def test_velocities_keep_to_their_limit_and_end_at_the_bounds():
    problem = make_problem("case1", 9)
    swarms, tables = begin(NAME, [problem], size=20)
    at_bounds = 0
    for _ in range(5):
        advance(NAME, swarms, tables, 20, 0.0, {"velocity_limit": 0.1, "first_inertia": 2.0})
        velocity, position = swarms.memory[0, :20, :9], swarms.positions[0, :20, :9]
        assert np.abs(velocity).max() <= 0.1 * 600
        reached = np.abs(position) == 300.0
        assert (velocity[reached] == 0.0).all()
        at_bounds += reached.sum()
    assert at_bounds > 0


def test_each_particle_is_evaluated_once_per_iteration():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=12)
    for count in (24, 36):
        advance(NAME, swarms, tables, 12, 0.5)
        assert swarms.evaluations[0] == count
