"""Learning of CMA-ES from a generation: mean, step size and covariance, and the square root of the latter.

Sources: the tutorial (see `rates`), eq. 41 to 47 and B.2; for the largest change of the step size, the
injection report (see `sampling`).
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import exponential
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, store
from swarm_gym.optimizers.cma_es.eigen import decompose
from swarm_gym.optimizers.cma_es.movement import follow_movement
from swarm_gym.optimizers.cma_es.rates import Rates
from swarm_gym.optimizers.cma_es.sampling import Offspring, times
from swarm_gym.optimizers.cma_es.state import (
    CONDITION,
    DECAY,
    DEGENERATE,
    GENERATION,
    PATH_LENGTH,
    REASON,
    SINCE_ROOT,
    STEP_SIZE,
    layout,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Largest change of the logarithm of the step size in a generation, of the injection report.
MOST_CHANGE = 1.0
# Condition number, and step along the longest axis in ranges of the initial bounds, of a degenerate
# distribution (`ConditionCov` and `TolXUp` of the tutorial, B.3); and numbers beyond which squares overflow.
MOST_CONDITION, MOST_SPREAD, LEAST_NUMBER = 1e14, 1e4, 1e-100


@kernel
def learn(
    state: Floats,
    registers: Integers,
    dimension: int,
    offspring: Offspring,
    order: Integers,
    weights: Floats,
    rates: Rates,
) -> None:
    """Update the distribution of a swarm.

    Args:
        state: the swarm's row of `Swarms.field`.
        registers: counts of the swarm, its row of `Swarms.registers`.
        dimension: dimension of the problem.
        offspring: steps of the members, and their lengths.
        order: (lambda,) the members, best first.
        weights: (lambda,) weights by rank, negative for the worse half.
        rates: learning rates.
    """
    width = offspring.ranges.shape[0]
    at, mean_step, scratch = layout(width), np.zeros(width), np.zeros(width)
    former_step_size = state[STEP_SIZE]
    for r in range(rates.parents):
        first = order[r] * width
        for k in range(dimension):
            mean_step[k] += weights[r] * offspring.steps[first + k]
    for k in range(dimension):
        state[at.mean + k] += state[STEP_SIZE] * offspring.ranges[k] * mean_step[k]  # eq. 42
    times(state, at.inverse, mean_step, dimension, scratch, 0)
    stalls = _follow_paths(state, dimension, mean_step, scratch, rates)
    factors = np.empty(weights.shape[0])
    for r in range(weights.shape[0]):
        factors[r] = rates.rank_mu * weights[r]
        if weights[r] < 0.0:  # eq. 46
            length = offspring.lengths[order[r]]
            factors[r] *= dimension / length if length > 0.0 else 0.0
    decay = 1.0 - rates.rank_one - rates.rank_mu * rates.weight_sum
    if stalls:
        decay += rates.rank_one * rates.path_rate * (2.0 - rates.path_rate)
    _turn_covariance(state, dimension, offspring.steps, order, factors, rates.rank_one, decay, width)
    follow_movement(state, dimension, scratch, former_step_size, weights, rates, stalls)
    registers[GENERATION] += 1
    registers[SINCE_ROOT] += 1
    lazy = 1.0 / (10.0 * dimension * (rates.rank_one + rates.rank_mu))  # B.2
    if registers[SINCE_ROOT] >= lazy:
        registers[SINCE_ROOT] = 0
        if not find_root(state, dimension, width):
            registers[REASON] = DEGENERATE
    if not LEAST_NUMBER < state[STEP_SIZE] < MOST_SPREAD:
        registers[REASON] = DEGENERATE


@kernel(borrows=True)
def _follow_paths(state: Floats, dimension: int, mean_step: Floats, round_step: Floats, rates: Rates) -> bool:
    """Update both evolution paths and the step size; return whether the path of the covariance stalls.

    Args:
        state: the swarm's row of `Swarms.field`.
        dimension: dimension of the problem.
        mean_step: (C,) weighted mean of the steps.
        round_step: (C,) the same as a standard normal vector would be.
        rates: learning rates.
    """
    at, keep = layout(mean_step.shape[0]), 1.0 - rates.step_rate
    gain, square = math.sqrt(rates.step_rate * (2.0 - rates.step_rate) * rates.effective), 0.0
    for k in range(dimension):
        state[at.step_path + k] = keep * state[at.step_path + k] + gain * round_step[k]  # eq. 43
        square += state[at.step_path + k] * state[at.step_path + k]
    state[PATH_LENGTH] = math.sqrt(square) / rates.expected_length
    change = rates.step_rate / rates.damping * (state[PATH_LENGTH] - 1.0)
    state[STEP_SIZE] *= exponential(min(change, MOST_CHANGE))  # eq. 44
    state[DECAY] *= keep * keep
    limit = 1.4 + 2.0 / (dimension + 1.0)
    stalls = state[PATH_LENGTH] / math.sqrt(1.0 - state[DECAY]) >= limit  # h_sigma = 0
    keep = 1.0 - rates.path_rate
    gain = 0.0 if stalls else math.sqrt(rates.path_rate * (2.0 - rates.path_rate) * rates.effective)
    for k in range(dimension):
        state[at.covariance_path + k] = keep * state[at.covariance_path + k] + gain * mean_step[k]  # eq. 45
    return stalls


@kernel(borrows=True)
def _turn_covariance(
    state: Floats,
    dimension: int,
    steps: Floats,
    order: Integers,
    factors: Floats,
    rank_one: float,
    decay: float,
    width: int,
) -> None:
    """Add the rank-one and rank-mu updates to the covariance (eq. 47); `factors` go with `order`."""
    at = layout(width)
    for i in range(dimension):
        own = rank_one * state[at.covariance_path + i]
        for k in range(0, width, NUM_LANES):
            place = at.covariance + i * width + k
            found = load(state, place) * decay + load(state, at.covariance_path + k) * own
            for r in range(order.shape[0]):
                first = order[r] * width
                found = found + load(steps, first + k) * (factors[r] * steps[first + i])
            store(state, place, found)


@kernel
def find_root(state: Floats, dimension: int, width: int) -> bool:
    """Compute the square root of the covariance, its inverse and the condition number.

    Returns:
        Whether the distribution is sound: neither its condition number nor its spread is out of bounds.
    """
    at = layout(width)
    vectors = state[at.covariance : at.covariance + dimension * width].copy()
    values, scratch = np.empty(dimension), np.empty(dimension)
    if not decompose(vectors, width, values, scratch):
        return False
    least, most = values.min(), values.max()
    if not (least > LEAST_NUMBER and most < MOST_CONDITION * least):
        return False
    state[CONDITION] = most / least
    for i in range(dimension):
        for k in range(0, width, NUM_LANES):
            root, inverse = broadcast(0.0), broadcast(0.0)
            for j in range(dimension):
                deviation, part = math.sqrt(values[j]), vectors[j * width + i]
                row = load(vectors, j * width + k)
                root = root + row * (part * deviation)
                inverse = inverse + row * (part / deviation)
            store(state, at.root + i * width + k, root)
            store(state, at.inverse + i * width + k, inverse)
    return math.sqrt(most) * state[STEP_SIZE] < MOST_SPREAD
