"""The first numbers of NumPy's default generator, PCG64, for many seeds at once.

Sources: M. E. O'Neill, "PCG: a family of simple fast space-efficient statistically good algorithms for random
number generation", 2014 (128 bits of state, output XSL-RR); D. Lemire, "Fast random integer generation in an
interval", ACM Transactions on Modeling and Computer Simulation 29(1), 2019. `numpy.random.default_rng` is the
reference they are tested against.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel

Words = NDArray[np.uint64]

NUM_SEED_WORDS = 4

# The multiplier of the linear congruential generator, 128 bits in two words.
_FACTOR_HIGH, _FACTOR_LOW = np.uint64(0x2360ED051FC65DA4), np.uint64(0x4385DF649FCCF645)
_LOW, _HALF = np.uint64(0xFFFFFFFF), np.uint64(32)
_ZERO, _ONE, _LAST = np.uint64(0), np.uint64(1), np.uint64(63)
_ROTATION, _BITS = np.uint64(58), np.uint64(64)
_SHIFT, _UNIT = np.uint64(11), 2.0**-53

# Rows of the state of a generator.
_STATE_HIGH, _STATE_LOW, _STEP_HIGH, _STEP_LOW = range(4)


@entry
def integers_and_shares(seeds: Words, bound: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the number `integers(bound)` and then the number `random()` of a default generator of each seed.

    Args:
        seeds: (k, 4) words that a seed sequence generates for PCG64, see `seed_sequence.generated`.
        bound: the integers are below it; 1 to 2^32.

    Returns:
        (k,) integers, and (k,) numbers uniform in [0, 1).
    """
    integers = np.zeros(seeds.shape[0], dtype=np.int64)
    shares = np.empty(seeds.shape[0])
    state = np.empty(4, dtype=np.uint64)
    for row in range(seeds.shape[0]):
        _begin(seeds[row], state)
        if bound > 1:  # else NumPy draws nothing
            integers[row] = _bounded(state, np.uint64(bound))
        shares[row] = np.float64(_word(state) >> _SHIFT) * _UNIT
    return integers, shares


@kernel
def _begin(seed: Words, state: Words) -> None:
    """Seed a generator with four words: the state, and the odd number that is added at every step."""
    state[_STEP_HIGH] = (seed[2] << _ONE) | (seed[3] >> _LAST)
    state[_STEP_LOW] = (seed[3] << _ONE) | _ONE
    # From a state of zero, one step leads to that number.
    state[_STATE_LOW] = state[_STEP_LOW] + seed[1]
    carry = _ONE if state[_STATE_LOW] < seed[1] else _ZERO
    state[_STATE_HIGH] = state[_STEP_HIGH] + seed[0] + carry
    _advance(state)


@kernel
def _advance(state: Words) -> None:
    """Multiply the state by the factor and add the step, modulo 2^128."""
    high, low = state[_STATE_HIGH], state[_STATE_LOW]
    upper = _upper_product(low, _FACTOR_LOW) + high * _FACTOR_LOW + low * _FACTOR_HIGH
    lower = low * _FACTOR_LOW
    state[_STATE_LOW] = lower + state[_STEP_LOW]
    carry = _ONE if state[_STATE_LOW] < lower else _ZERO
    state[_STATE_HIGH] = upper + state[_STEP_HIGH] + carry


@kernel
def _upper_product(one: np.uint64, other: np.uint64) -> np.uint64:
    """Return the upper 64 bits of the product of two words."""
    one_high, one_low, other_high, other_low = one >> _HALF, one & _LOW, other >> _HALF, other & _LOW
    middle = one_high * other_low + ((one_low * other_low) >> _HALF)
    rest = (middle & _LOW) + one_low * other_high
    return one_high * other_high + (middle >> _HALF) + (rest >> _HALF)


@kernel
def _word(state: Words) -> np.uint64:
    """Advance a generator and return its next word of 64 bits."""
    _advance(state)
    high, low = state[_STATE_HIGH], state[_STATE_LOW]
    word, turn = high ^ low, high >> _ROTATION
    return (word >> turn) | (word << ((_BITS - turn) & _LAST))


@kernel
def _bounded(state: Words, bound: np.uint64) -> np.uint64:
    """Return a number below a bound of 32 bits; draws again what would make some numbers likelier."""
    refused = (_LOW + _ONE - bound) % bound
    while True:
        word = _word(state)
        for half in (word & _LOW, word >> _HALF):
            product = half * bound
            if (product & _LOW) >= refused:
                return product >> _HALF
