"""Weights of distributions of whole numbers around their modes, of which kernels draw.

A window of weights around the mode leaves out numbers that are less likely than rounding errors.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel

Floats = NDArray[np.float64]

# Half the width of a window around a mode, in standard deviations, beyond which there is less than 1e-17; and
# a density, relative to the density of the mode, at which a window ends.
REACH, LEAST_REACH, TINY = 9.0, 40, 1e-18
_BLOCK = 8  # sums that a search leaves out at once


@kernel(borrows=True)
def window_length(variance: float, most: int) -> int:
    """Return the length of an array for the window around a mode; `most` + 1 numbers are possible."""
    if most <= LEAST_REACH:
        return 2 * most + 1
    return min(2 * (int(REACH * math.sqrt(variance)) + LEAST_REACH) + 1, 2 * most + 1)


@kernel(borrows=True)
def fill_binomial(trials: int, rate: float, weights: Floats) -> tuple[int, int]:
    """Write weights that are proportional to Bin(trials, rate) around the mode.

    Returns:
        The number that the first weight is for, and how many weights there are.
    """
    if rate >= 1.0 or rate <= 0.0 or trials == 0:
        weights[0] = 1.0
        return (trials if rate >= 1.0 else 0), 1
    odds = rate / (1.0 - rate)
    mode = min(int((trials + 1.0) * rate), trials)
    reach, first, weight = (weights.shape[0] - 1) // 2, mode, 1.0
    while first > max(0, mode - reach) and weight > TINY:
        weight *= first / ((trials - first + 1.0) * odds)
        first -= 1
    # Neighbours have a fixed ratio, so that the sum does not depend on where it begins.
    last, weight = first, max(weight, TINY * TINY)
    weights[0] = weight
    while last < trials and last - first < weights.shape[0] - 1 and (last < mode or weight > TINY):
        weight *= (trials - last) / (last + 1.0) * odds
        last += 1
        weights[last - first] = weight
    return first, last - first + 1


@kernel(borrows=True)
def sum_of(weights: Floats, count: int) -> float:
    """Return the sum of the first weights."""
    total = 0.0
    for k in range(count):
        total += weights[k]
    return total


@kernel(borrows=True)
def add_up(weights: Floats, count: int) -> float:
    """Let each of the first weights be the sum of those up to it, and return the last sum."""
    total = 0.0
    for k in range(count):
        total += weights[k]
        weights[k] = total
    return total


@kernel(borrows=True)
def find_sum(sums: Floats, count: int, share: float) -> int:
    """Return the first index at which one of the sums, which do not fall, exceeds a share of the last.

    The sums of a block are counted, since where a search ends cannot be foreseen, and processors wait then.
    """
    k = 0
    while k + _BLOCK < count and share >= sums[k + _BLOCK - 1]:
        k += _BLOCK
    found = k
    for j in range(k, min(k + _BLOCK, count - 1)):
        found += int(share >= sums[j])
    return found


@kernel(borrows=True)
def power(base: float, exponent: int) -> float:
    """Return a power by squaring, which has the same bits on every processor."""
    result = 1.0
    while exponent > 0:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result
