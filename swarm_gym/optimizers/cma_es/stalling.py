"""Signs that CMA-ES has stalled, so that it should restart.

Source: the tutorial (see `rates`), B.3. The history of fitness is limited; see docs/readings.md.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers.cma_es.state import (
    GENERATION,
    GENERATION_BEST,
    GENERATION_MEDIAN,
    LONGEST_HISTORY,
    NO_REASON,
    REASON,
    RECORDED,
    STALLED,
    STEP_SIZE,
    layout,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# `TolFun`, and `TolX` as a share of the first step size.
LEAST_DIFFERENCE, LEAST_SHARE = 1e-12, 1e-12
# Generations between two looks at the medians of the history.
_EVERY = 20


@kernel
def judge(
    state: Floats,
    registers: Integers,
    dimension: int,
    ranges: Floats,
    fitness: Floats,
    order: Integers,
    first_step: float,
) -> None:
    """Record the fitness of a generation, and let the swarm restart before the next one if it has stalled.

    Args:
        state: the swarm's row of `Swarms.field`.
        registers: counts of the swarm, its row of `Swarms.registers`.
        dimension: dimension of the problem.
        ranges: (C,) ranges of the initial bounds.
        fitness: (lambda,) fitness of the members.
        order: (lambda,) the members, best first.
        first_step: step size with which the swarm began, in ranges.
    """
    width, size = ranges.shape[0], order.shape[0]
    at = layout(width)
    best, worst = fitness[order[0]], fitness[order[size - 1]]
    median = 0.5 * (fitness[order[(size - 1) // 2]] + fitness[order[size // 2]])
    state[GENERATION_BEST], state[GENERATION_MEDIAN] = best, median
    place = registers[RECORDED] % LONGEST_HISTORY
    state[at.bests + place], state[at.medians + place] = best, median
    registers[RECORDED] += 1
    if registers[REASON] != NO_REASON:
        return
    share = math.ceil(30.0 * dimension / size)
    if (
        _is_flat(state, registers, at.bests, min(10 + share, LONGEST_HISTORY), worst - best)
        or _is_tiny(state, dimension, width, first_step)
        or _has_no_effect(state, dimension, ranges)
        or (
            registers[GENERATION] % _EVERY == 0
            and _gets_no_better(state, registers, at.bests, at.medians, 120 + share)
        )
    ):
        registers[REASON] = STALLED


@kernel(borrows=True)
def _is_flat(state: Floats, registers: Integers, bests: int, window: int, extent: float) -> bool:
    """Return whether the best fitness hardly differs over these generations (`EqualFunValues`, `TolFun`)."""
    recorded = registers[RECORDED]
    if recorded < window:
        return False
    low, high = math.inf, -math.inf
    for age in range(window):
        value = state[bests + (recorded - 1 - age) % LONGEST_HISTORY]
        low, high = min(low, value), max(high, value)
    return high == low or max(high - low, extent) < LEAST_DIFFERENCE


@kernel(borrows=True)
def _is_tiny(state: Floats, dimension: int, width: int, first_step: float) -> bool:
    """Return whether all standard deviations, and steps of the path, are tiny (`TolX`)."""
    at, least = layout(width), LEAST_SHARE * first_step / state[STEP_SIZE]
    for k in range(dimension):
        variance = state[at.covariance + k * width + k]
        if variance >= least * least or abs(state[at.covariance_path + k]) >= least:
            return False
    return True


@kernel(borrows=True)
def _has_no_effect(state: Floats, dimension: int, ranges: Floats) -> bool:
    """Return whether a fifth of a standard deviation changes some component of the mean by nothing.

    This is `NoEffectCoord`.
    """
    width = ranges.shape[0]
    at = layout(width)
    for k in range(dimension):
        deviation = math.sqrt(max(state[at.covariance + k * width + k], 0.0))
        mean = state[at.mean + k]
        if ranges[k] > 0.0 and mean == mean + 0.2 * state[STEP_SIZE] * ranges[k] * deviation:
            return True
    return False


@kernel
def _gets_no_better(state: Floats, registers: Integers, bests: int, medians: int, least: int) -> bool:
    """Return whether neither history is better at its end than at its beginning (`Stagnation`)."""
    recorded = registers[RECORDED]
    window = min(max(least, recorded // 5), LONGEST_HISTORY)
    if recorded < window:
        return False
    count = max(3 * window // 10, 1)
    for history in (bests, medians):
        old = _median(state, history, recorded - window, count)
        new = _median(state, history, recorded - count, count)
        if new < old:
            return False
    return True


@kernel
def _median(state: Floats, history: int, first: int, count: int) -> float:
    """Return the median of some generations of a history."""
    sorted_values = np.empty(count)
    for i in range(count):
        value, k = state[history + (first + i) % LONGEST_HISTORY], i
        while k > 0 and value < sorted_values[k - 1]:
            sorted_values[k] = sorted_values[k - 1]
            k -= 1
        sorted_values[k] = value
    return 0.5 * (sorted_values[(count - 1) // 2] + sorted_values[count // 2])
