"""A seeded random stream for kernels: eight of NumPy's SFC64 side by side, word for word.

Source: C. Doty-Humphrey, PractRand, "sfc64"; `numpy.random.SFC64` is the reference it is tested against. A
single generator spends its time waiting for its own last word, so that eight side by side take no longer. A
stream is an array of 4 x 8 words, advanced in place, one per swarm: it needs no lock and no global state.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.compiler.simd import NUM_LANES, as_float, load, store

STREAM_SHAPE = (4, NUM_LANES)

_WORDS_OF_A_LANE = 3
NUM_SEED_WORDS = _WORDS_OF_A_LANE * NUM_LANES

_SHIFT_RIGHT = np.uint64(11)
_SHIFT_LEFT = np.uint64(3)
_ROTATE_LEFT = np.uint64(24)
_ROTATE_RIGHT = np.uint64(40)
_ONE = np.uint64(1)
_UNIT = 2.0**-53
_DISCARDED = 12  # numbers of a lane that NumPy does not use when it seeds an SFC64


def seed_stream(sequence: np.random.SeedSequence) -> NDArray[np.uint64]:
    """Return a stream, words of shape (4, 8), that a seed sequence determines, see `seed_streams`."""
    words = sequence.generate_state(NUM_SEED_WORDS, np.uint64).astype(np.uint64)
    return seed_streams(words[None])[0]


@entry
def seed_streams(words: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return k streams, (k, 4, 8): column m of a stream is the state of an `SFC64` seeded with three words.

    Args:
        words: (k, 24) words that a seed sequence generates for each stream; 3 m to 3 m + 2 are for column m.
    """
    streams = np.ones((words.shape[0], 4, NUM_LANES), dtype=np.uint64)  # the last row counts from one
    unused = np.empty(_DISCARDED * NUM_LANES)
    for k in range(words.shape[0]):
        for lane in range(NUM_LANES):
            for row in range(_WORDS_OF_A_LANE):
                streams[k, row, lane] = words[k, _WORDS_OF_A_LANE * lane + row]
        fill_uniform(streams[k], unused)
    return streams


@kernel(inline="late")
def fill_uniform(stream: NDArray[np.uint64], out: NDArray[np.float64]) -> None:
    """Fill `out`, whose length is a multiple of eight, with numbers uniform in [0, 1), and advance `stream`.

    Number 8 m + k is number m of lane k, as `numpy.random.Generator(SFC64).random()` gives it.
    """
    a, b, c, counter = load(stream, 0), load(stream, 1), load(stream, 2), load(stream, 3)
    for k in range(0, out.shape[0], NUM_LANES):
        word = a + b + counter
        counter = counter + _ONE
        a = b ^ (b >> _SHIFT_RIGHT)
        b = c + (c << _SHIFT_LEFT)
        c = ((c << _ROTATE_LEFT) | (c >> _ROTATE_RIGHT)) + word
        store(out, k, as_float(word >> _SHIFT_RIGHT) * _UNIT)
    store(stream, 0, a)
    store(stream, 1, b)
    store(stream, 2, c)
    store(stream, 3, counter)
