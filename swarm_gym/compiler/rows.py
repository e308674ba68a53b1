"""Arithmetic on rows of numbers in one compiled call, where NumPy's calls would take longer than a step."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry


@entry
def rows_within(numbers: NDArray[np.float64], low: NDArray, high: NDArray) -> NDArray[np.bool_]:
    """Return (B,) which rows of numbers, (B, k), lie within bounds, (k,) each, which count as within.

    A row with NaN does not.
    """
    within = np.empty(numbers.shape[0], dtype=np.bool_)
    for row in range(numbers.shape[0]):
        inside = True
        for k in range(numbers.shape[1]):
            inside &= (numbers[row, k] >= low[k]) & (numbers[row, k] <= high[k])
        within[row] = inside
    return within


@entry
def plain_decisions(
    numbers: NDArray[np.float64], chosen: NDArray[np.bool_], smallest: int, largest: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return population sizes, rounded, and repair degrees in [0, 1] that rows of actions, (B, 2), ask for.

    Args:
        numbers: (B, 2) sizes and degrees within their bounds; rows that are not chosen may hold anything.
        chosen: (B,) rows that are read; the others get the smallest size and no repair.
        smallest: smallest population size.
        largest: largest population size.
    """
    sizes = np.full(numbers.shape[0], smallest)
    degrees = np.zeros(numbers.shape[0])
    for row in range(numbers.shape[0]):
        if chosen[row]:
            size = min(max(numbers[row, 0], float(smallest)), float(largest))
            sizes[row] = math.floor(size + 0.5)
            degrees[row] = min(max(numbers[row, 1], 0.0), 1.0)
    return sizes, degrees


@entry
def gaps_above(
    fitness: NDArray[np.float64],
    problem: NDArray[np.int64],
    bounds: NDArray[np.float64],
    units: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return (B,) how far fitness values, (B,), are above the bounds of their problems; NaN stays.

    Args:
        fitness: (B,) fitness values.
        problem: (B,) numbers of problems.
        bounds: (problems,) lower bounds.
        units: (problems,) units of gaps; a gap is at least a billionth of its unit.
    """
    gaps = np.empty(fitness.shape[0])
    for row in range(fitness.shape[0]):
        gap, least = fitness[row] - bounds[problem[row]], 1e-9 * units[problem[row]]
        gaps[row] = least if gap < least else gap
    return gaps
