"""Random numbers of the BBOB instances, which fix optima, rotations and peaks once and for all.

The definitions of the functions (INRIA RR-6829, see `instance`) say what is drawn, and the programs of their
authors say how. The generator comes from S. K. Park, K. W. Miller, "Random number generators: good ones are
hard to find", Communications of the ACM 31, 1988. A table of 32 entries shuffles its output, after C. Bays,
S. D. Durham, "Improving a poor random number generator", ACM Transactions on Mathematical Software 2, 1976.
Results refer to the numbers, so they must never change.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import cos, log, product

Floats = NDArray[np.float64]

# x -> MULTIPLIER x modulo MODULUS (Park and Miller).
MULTIPLIER = 16807
MODULUS = 2**31 - 1
# Size of the table that shuffles, numbers dropped before it is filled, and the divisor that gives its index.
NUM_ENTRIES = 32
NUM_DROPPED = 8
ENTRY_WIDTH = 67108865
# What stands for a number that is exactly 0, whose logarithm is needed.
NEVER_ZERO = 1e-99


def uniform_numbers(count: int, seed: int) -> Floats:
    """Return (count,) random numbers in (0, 1) that a seed, an integer, stands for."""
    numbers = _shuffled(max(abs(seed), 1))
    drawn = np.fromiter(numbers, dtype=np.float64, count=count) / MODULUS
    drawn[drawn == 0.0] = NEVER_ZERO
    return drawn


def normal_numbers(count: int, seed: int) -> Floats:
    """Return (count,) numbers of the standard normal distribution, by the method of Box and Muller."""
    first, second = uniform_numbers(2 * count, seed).reshape(2, count)
    drawn = np.sqrt(-2.0 * log(first)) * cos(2.0 * math.pi * second)
    drawn[drawn == 0.0] = NEVER_ZERO
    return drawn


def rotation(dimension: int, seed: int) -> Floats:
    """Return a random orthogonal matrix, (dimension, dimension).

    Its columns are normal vectors that the method of Gram and Schmidt makes orthonormal, one after the other.
    """
    columns = normal_numbers(dimension * dimension, seed).reshape(dimension, dimension)
    for k in range(dimension):
        for before in columns[:k]:
            columns[k] -= product(before, columns[k]) * before
        columns[k] /= math.sqrt(product(columns[k], columns[k]))
    return columns.T.copy()


def _shuffled(state: int) -> Iterator[int]:
    """Yield the numbers of the generator in the order of the table that shuffles them."""
    entries = []
    for k in range(NUM_DROPPED + NUM_ENTRIES):
        state = MULTIPLIER * state % MODULUS
        if k >= NUM_DROPPED:
            entries.append(state)
    entries.reverse()  # the table is filled from its end
    last = entries[0]
    while True:
        state = MULTIPLIER * state % MODULUS
        index = last // ENTRY_WIDTH
        last, entries[index] = entries[index], state
        yield last
