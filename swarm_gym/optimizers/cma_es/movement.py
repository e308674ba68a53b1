"""The path along which the distribution of CMA-ES moves, in the space of its parameters.

Source: K. Nishida, Y. Akimoto, "PSA-CMA-ES: CMA-ES with population size adaptation", GECCO 2018. A step of
mean and covariance is measured by the Fisher information of the distribution before the step. It is divided
by its expected length where selection is random. An evolution path adds such steps up. The path is long where
steps agree, and its squared length is near 1 where they are random.

The expected length there is for weights that are not negative. The term of negative weights is a reading, see
docs/readings.md.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, store
from swarm_gym.optimizers.cma_es.rates import Rates
from swarm_gym.optimizers.cma_es.state import DECAY, FILLED, MOVEMENT, STEP_SIZE, layout

Floats = NDArray[np.float64]

BETA = 0.4  # share that a step has in the path
LONGEST = 1e6  # largest squared length that is recorded


@kernel
def follow_movement(
    state: Floats,
    dimension: int,
    round_step: Floats,
    former_step_size: float,
    weights: Floats,
    rates: Rates,
    stalls: bool,
) -> None:
    """Add the last step of mean and covariance to the path, and record its squared length.

    The root of the covariance has to be the one before the step.

    Args:
        state: the swarm's row of `Swarms.field`.
        dimension: dimension of the problem.
        round_step: (C,) step of the mean as a standard normal vector would be.
        former_step_size: step size with which the generation was drawn.
        weights: (lambda,) weights by rank, negative for the worse half.
        rates: learning rates.
        stalls: whether the evolution path of the covariance did not follow this step.
    """
    width, keep = round_step.shape[0], 1.0 - rates.path_rate
    joins = 0.0 if stalls else rates.path_rate * (2.0 - rates.path_rate)
    state[FILLED] = keep * keep * state[FILLED] + joins
    expected = expected_square(float(dimension), weights, rates, 1.0 - state[DECAY], state[FILLED])
    growth = state[STEP_SIZE] / former_step_size
    half, moved = np.empty(dimension * width), np.empty(dimension * width)
    _seen_from_before(state, dimension, width, growth * growth, half, moved)
    at, gain, square = layout(width), math.sqrt(BETA * (2.0 - BETA) / expected), 0.0
    for k in range(dimension):
        place = at.mean_movement + k
        state[place] = (1.0 - BETA) * state[place] + gain * round_step[k]
        square += state[place] * state[place]
    for i in range(dimension):
        moved[i * width + i] -= 1.0
        for k in range(dimension):
            place = at.movement + i * width + k
            state[place] = (1.0 - BETA) * state[place] + gain * moved[i * width + k]
            square += 0.5 * state[place] * state[place]
    state[MOVEMENT] = square if square < LONGEST else LONGEST


@kernel
def expected_square(n: float, weights: Floats, rates: Rates, filled_step: float, filled: float) -> float:
    """Return the expected squared length of a step where selection is random.

    Args:
        n: dimension of the problem.
        weights: (lambda,) weights by rank, negative for the worse half.
        rates: learning rates.
        filled_step: gamma_sigma, which tells how far the path of the step size is filled.
        filled: gamma_c, the same of the path of the covariance.
    """
    cubes = opposing = 0.0
    for r in range(weights.shape[0]):
        if weights[r] > 0.0:
            cubes += weights[r] * weights[r] * weights[r]
        else:
            opposing += weights[r] * weights[r]
    length = rates.expected_length * rates.expected_length
    speed = rates.step_rate / rates.damping
    change = filled_step * (n - length) / length * speed * speed  # variance of the step size's logarithm
    square, joint = n * n + n, rates.path_rate * (2.0 - rates.path_rate) * rates.effective
    members = rates.rank_mu * rates.rank_mu * (square / rates.effective + (n * n - n) * opposing)
    both = square * joint * rates.rank_one * rates.rank_mu * cubes
    spread = filled * filled * n * n + (1.0 - 2.0 * filled + 2.0 * filled * filled) * n
    covariance = members + both + rates.rank_one * rates.rank_one * spread
    return n / rates.effective + 2.0 * n * change + 0.5 * (1.0 + 8.0 * change) * covariance


@kernel(borrows=True)
def _seen_from_before(
    state: Floats, dimension: int, width: int, growth: float, half: Floats, moved: Floats
) -> None:
    """Write growth R^-1 C R^-1 into `moved`, where C is the covariance and R its root before the last step.

    `half` is a scratch array of the same shape, (dimension * width,).
    """
    at = layout(width)
    for i in range(dimension):
        for k in range(0, width, NUM_LANES):
            found = broadcast(0.0)
            for j in range(dimension):
                found = found + load(state, at.inverse + j * width + k) * state[at.covariance + i * width + j]
            store(half, i * width + k, found)
    for i in range(dimension):
        for k in range(0, width, NUM_LANES):
            found = broadcast(0.0)
            for j in range(dimension):
                found = found + load(half, j * width + k) * (growth * state[at.inverse + i * width + j])
            store(moved, i * width + k, found)
