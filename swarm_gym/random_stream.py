"""A seeded random stream for kernels: NumPy's SFC64, word for word.

Source: C. Doty-Humphrey, PractRand, "sfc64"; `numpy.random.SFC64` is the reference it is tested against.
A stream is an array of four uint64 words, advanced in place, one per swarm: it needs no lock and no
global state.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel

WORDS = 4

_SHIFT_RIGHT = np.uint64(11)
_SHIFT_LEFT = np.uint64(3)
_ROTATE_LEFT = np.uint64(24)
_ROTATE_RIGHT = np.uint64(40)
_ONE = np.uint64(1)
_UNIT = 2.0**-53


def seed_stream(sequence: np.random.SeedSequence) -> NDArray[np.uint64]:
    """Words of a stream, shape (4,), in the state that `numpy.random.SFC64(sequence)` starts in."""
    state = np.random.SFC64(sequence).state["state"]
    return np.array(state["state"], dtype=np.uint64)


@inlined_kernel
def fill_uniform(stream: NDArray[np.uint64], out: NDArray[np.float64]) -> None:
    """Fill `out` (any length) with numbers uniform in [0, 1); advances `stream` in place.

    The numbers are those of `numpy.random.Generator(SFC64).random(len(out))`.
    """
    a, b, c, counter = stream[0], stream[1], stream[2], stream[3]
    for k in range(out.shape[0]):
        word = a + b + counter
        counter += _ONE
        a = b ^ (b >> _SHIFT_RIGHT)
        b = c + (c << _SHIFT_LEFT)
        c = ((c << _ROTATE_LEFT) | (c >> _ROTATE_RIGHT)) + word
        # The 53 bits fit a signed integer, whose conversion is one instruction.
        out[k] = np.int64(word >> _SHIFT_RIGHT) * _UNIT
    stream[0], stream[1], stream[2], stream[3] = a, b, c, counter
