"""Swarms of fish whose moves can be computed by hand, for several tests of fish swarms.

Without obstacles, the straight line is the best path, a decision vector of zeros; the workspace leaves
waypoints a range of 600. Lengths are in ranges, of paths the root mean square over the waypoints.
"""

import numpy as np

from helpers.builders import advance, begin, make_problem
from swarm_gym.problem import AnalyticProblem
from swarm_gym.scenarios import Scenario

RANGE = 600.0
OPEN_SPACE = Scenario("open", (20.0, 300.0), (980.0, 300.0), (), (0.0, 0.0, 1000.0, 600.0), (-90.0, 90.0))


def open_problem(num_waypoints=9):
    return AnalyticProblem(OPEN_SPACE, num_waypoints)


def begun(optimizer, population, num=1, iteration=0, iterations=10):
    """Return swarms of different seeds with the same positions in open space, and their tables."""
    population = np.array(population, dtype=float)
    problems = [open_problem(population.shape[1])] * num
    size = len(population)
    swarms, tables = begin(
        optimizer, problems, size, capacity=64, iterations=iterations, populations=[population] * num
    )
    swarms.iteration[:] = iteration
    return swarms, tables


def spent(optimizer, population, parameters, iteration=0, iterations=10, size=None):
    """Return the evaluations of one iteration of a swarm with these positions in open space."""
    swarms, tables = begun(optimizer, population, 1, iteration, iterations)
    before = swarms.evaluations[0]
    advance(optimizer, swarms, tables, size or len(population), 0.0, parameters)
    return swarms.evaluations[0] - before


def displacements(optimizer, population, parameters, num=1, iteration=0, iterations=10):
    """Return the displacements of fish in one iteration, (num, members, dimension), in ranges."""
    swarms, tables = begun(optimizer, population, num, iteration, iterations)
    population = np.array(population, dtype=float)
    advance(optimizer, swarms, tables, len(population), 0.0, parameters)
    return (swarms.positions[:, : len(population), : population.shape[1]] - population) / RANGE


def lengths(ways):
    """Return the lengths of displacements (..., dimension)."""
    return np.sqrt((ways**2).mean(axis=-1))


def zigzags(num, dimension=9, seed=0):
    """Return bad positions that are apart from each other and not near the bounds."""
    return np.random.default_rng(seed).uniform(-90.0, 90.0, (num, dimension))


def straight(num, dimension=9):
    """Return fish on the straight line: none sees another or finds a better point, so they leap."""
    return np.zeros((num, dimension))


def assert_up_to(values, limit, share=0.9):
    """Assert that no value is above the limit, and that the largest is near it."""
    assert values.max() <= limit * (1 + 1e-9)
    assert values.max() > share * limit


def components_along(ways, direction):
    """Return parts of displacements (..., dimension) along a direction, and whether there are no others."""
    direction = direction / np.linalg.norm(direction)
    along = ways @ direction
    rest = np.linalg.norm(ways - along[..., None] * direction, axis=-1)
    return along, rest < 1e-9


def repairs_in_place(optimizer, parameters, most):
    """Return whether fish that cannot move are at places to which up to `most` repairs move them."""
    problem, repair_degree = make_problem("case1", 9), 0.6
    swarms, tables = begin(optimizer, [problem], size=12)
    expected = [{tuple(position)} for position in swarms.positions[0, :12, :9]]
    advance(optimizer, swarms, tables, 12, repair_degree, parameters)
    found = [tuple(position) for position in swarms.positions[0, :12, :9]]
    for places in expected:
        place = places.pop()
        for _ in range(most):
            place = tuple(problem.repaired(place, repair_degree))
            places.add(place)
    return [place in places for place, places in zip(found, expected, strict=True)]
