"""Offspring of CMA-ES: how they are drawn, kept inside the bounds, and injected.

Sources: the tutorial (see `rates`), eq. 38 to 40; N. Hansen, "Injecting external solutions into CMA-ES",
arXiv:1110.4181, 2011, called the injection report here; for bounds N. Hansen, A. Niederberger, L. Guzzella,
P. Koumoutsakos, "A method for handling uncertainty in evolutionary optimization with an application to
feedback control of combustion", IEEE Transactions on Evolutionary Computation 13(1), 2009: a point
outside is evaluated at the nearest point inside, and ranked with a penalty for the distance.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.normal import fill_normal
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, store
from swarm_gym.optimizers.cma_es.state import STEP_SIZE, layout, write_ranges
from swarm_gym.population import Swarms, Workspace, evaluate_member, is_spent, span
from swarm_gym.problem.tables import Table, repair
from swarm_gym.sources import IMMIGRANTS, draw_newcomer, note_arrival

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Penalty of a point one standard deviation beyond the bounds in every component, in interquartile ranges of
# the fitness of its generation.
PENALTY = 2.0


class Offspring(NamedTuple):
    """The steps from the mean to the members of a generation, and scratch arrays."""

    steps: Floats  # (lambda * C,) y, one member after the other, in ranges and step sizes
    lengths: Floats  # (lambda,) squares of their Mahalanobis lengths
    excesses: Floats  # (lambda,) mean squares of distances to the bounds, in standard deviations; 0 inside
    ranges: Floats  # (C,) ranges of the initial bounds
    point: Floats  # (C + 1,) a point as it was drawn, behind a zero


@kernel
def make_offspring(size: int, table: Table, width: int) -> Offspring:
    """Return room for the steps of a generation of this size, for positions of C = `width` columns."""
    ranges, point = np.empty(width), np.zeros(width + 1)
    write_ranges(table, ranges)
    return Offspring(np.empty(size * width), np.empty(size), np.zeros(size), ranges, point)


@kernel(borrows=True)
def times(matrix: Floats, first: int, vector: Floats, dimension: int, out: Floats, at: int) -> None:
    """Write the product of a symmetric matrix and a vector, (C,), into `out` from `at` on, C numbers.

    The matrix has C columns in a row, the first of them in column `first` of its array. Only the first
    `dimension` numbers of the vector count.
    """
    width = vector.shape[0]
    for k in range(0, width, NUM_LANES):
        found = broadcast(0.0)
        for j in range(dimension):
            found = found + load(matrix, first + j * width + k) * vector[j]
        store(out, at + k, found)


@kernel
def draw_generation(
    swarms: Swarms, b: int, table: Table, work: Workspace, offspring: Offspring, repair_degree: float
) -> int:
    """Draw and evaluate members while the budget lasts, immigrants last; return how many there are."""
    size = offspring.lengths.shape[0]
    num_immigrants = min(math.floor(swarms.source[b, IMMIGRANTS] * size + 0.5), size - 1)
    lower, upper = span(swarms.positions[b], swarms.size[b], table)
    for i in range(size):
        if is_spent(swarms, b):
            return i
        if i < size - num_immigrants:
            _draw_member(swarms, b, i, table, work, offspring, repair_degree)
        else:
            _draw_immigrant(swarms, b, i, table, work, offspring, lower, upper)
    return size


@kernel(borrows=True)
def _draw_member(
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    offspring: Offspring,
    repair_degree: float,
) -> None:
    """Draw member i from the distribution, move it into the bounds, repair and evaluate it."""
    state, path, normals, n = swarms.field[b], work.path, work.noise, table.dimension
    width = normals.shape[0]
    at, first = layout(width), i * width
    fill_normal(swarms.stream[b], normals, n)
    times(state, at.root, normals, n, offspring.steps, first)
    length = excess = 0.0
    for k in range(n):
        length += normals[k] * normals[k]
        reach = state[STEP_SIZE] * offspring.ranges[k]
        wanted = state[at.mean + k] + reach * offspring.steps[first + k]
        path[k + 1] = min(max(wanted, table.lower[k]), table.upper[k])
        if path[k + 1] != wanted:
            beyond = (wanted - path[k + 1]) / reach
            excess += beyond * beyond / state[at.covariance + k * width + k]
    offspring.lengths[i], offspring.excesses[i] = length, excess / n
    if repair_degree > 0.0:
        for k in range(path.shape[0]):
            offspring.point[k] = path[k]
        repair(table, path, repair_degree)
        changed = False
        for k in range(path.shape[0]):
            changed = changed or path[k] != offspring.point[k]
        if changed:
            _inject(state, i, table, work, offspring)
    evaluate_member(swarms, b, i, table, work)


@kernel(borrows=True)
def _draw_immigrant(
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    offspring: Offspring,
    lower: Floats,
    upper: Floats,
) -> None:
    """Draw member i from the source of the swarm, and evaluate it; a uniform one lies in [lower, upper]."""
    smooth = draw_newcomer(swarms.source[b], swarms.stream[b], table, work.noise, work.path, lower, upper)
    best = swarms.best_fitness[b]
    _inject(swarms.field[b], i, table, work, offspring)
    evaluate_member(swarms, b, i, table, work)
    note_arrival(swarms.arrivals[b], swarms.iteration[b], smooth, swarms.fitness[b, i], best)


@kernel(borrows=True)
def _inject(state: Floats, i: int, table: Table, work: Workspace, offspring: Offspring) -> None:
    """Let the step of member i lead to `work.path`, but be no longer than the injection report allows."""
    n, width = table.dimension, work.noise.shape[0]
    at, first, steps, step = layout(width), i * width, offspring.steps, work.noise
    for k in range(width):
        reach = state[STEP_SIZE] * offspring.ranges[k]
        step[k] = (work.path[k + 1] - state[at.mean + k]) / reach if reach > 0.0 else 0.0
    times(state, at.inverse, step, n, steps, first)
    square = 0.0
    for k in range(n):
        square += steps[first + k] * steps[first + k]
    longest = math.sqrt(float(n)) + 2.0 * n / (n + 2.0)  # c_y of the report
    share = min(1.0, longest / math.sqrt(square)) if square > 0.0 else 1.0
    for k in range(width):
        steps[first + k] = share * step[k]
    offspring.lengths[i], offspring.excesses[i] = share * share * square, 0.0


@kernel
def ranked(fitness: Floats) -> Integers:
    """Return the members by fitness, (lambda,), equals in order."""
    order = np.zeros(fitness.shape[0], np.int64)
    for i in range(fitness.shape[0]):
        k = i
        while k > 0 and fitness[i] < fitness[order[k - 1]]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i
    return order


@kernel
def ranked_with_penalty(fitness: Floats, order: Integers, excesses: Floats) -> Integers:
    """Return the members by fitness and penalty, (lambda,); `order` has them by fitness."""
    if excesses.max() == 0.0:
        return order
    size = order.shape[0]
    spread = fitness[order[3 * size // 4]] - fitness[order[size // 4]]
    return ranked(fitness + PENALTY * spread * excesses)
