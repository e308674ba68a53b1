"""NumPy's `SeedSequence` for many seeds at once: the words that each of them generates, bit for bit.

Source: M. E. O'Neill, "Developing a seed_seq alternative", 2015 (pcg-random.org), as the documentation of
`numpy.random.SeedSequence` describes it. The entropy of a seed, words of 32 bits, is hashed into a pool of
four words, in which every word depends on every other one. Further words are hashed from the pool in turns.
A child that `SeedSequence.spawn` makes has the entropy of its parent, and then its number.

A word is computed in 64 bits here and cut to 32, so that it is the same with and without compilation.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel

Entropy = NDArray[np.uint32]  # (seeds, words of each)
Words = NDArray[np.uint64]

POOL_SIZE = 4

# Constants of the source: where the two hashes begin, by what they go on, and how two words are mixed.
_FIRST_OF_POOL, _NEXT_OF_POOL = np.uint64(0x43B0D7E5), np.uint64(0x931E8875)
_FIRST_OF_OUTPUT, _NEXT_OF_OUTPUT = np.uint64(0x8B51F9DD), np.uint64(0x58F38DED)
_LEFT, _RIGHT = np.uint64(0xCA01F9DD), np.uint64(0x4973F715)
_LOW, _HALF, _WORD = np.uint64(0xFFFFFFFF), np.uint64(16), np.uint64(32)


def spawned(entropy: Entropy, child: int) -> Entropy:
    """Return the entropy of the child of this number, at most 2^32 - 1, of each seed that has none yet.

    Args:
        entropy: (k, w) entropies of k seeds, w words each.
        child: number of the child, from 0 on.

    Returns:
        (k, max(w, 4) + 1) words: short entropies are filled up with zeros first.
    """
    out = np.zeros((entropy.shape[0], max(entropy.shape[1], POOL_SIZE) + 1), dtype=np.uint32)
    out[:, : entropy.shape[1]] = entropy
    out[:, -1] = child
    return out


@entry
def generated(entropy: Entropy, count: int) -> Words:
    """Return (k, count) words of 64 bits: row i is `SeedSequence(entropy[i]).generate_state(count, uint64)`.

    Args:
        entropy: (k, w) entropies of k seeds.
        count: number of words for each seed.
    """
    out = np.empty((entropy.shape[0], count), dtype=np.uint64)
    pool = np.empty(POOL_SIZE, dtype=np.uint64)
    for row in range(entropy.shape[0]):
        _fill_pool(entropy[row], pool)
        _fill_words(pool, out[row])
    return out


@kernel
def _fill_pool(entropy: NDArray[np.uint32], pool: Words) -> None:
    """Hash an entropy, (w,), into a pool, (4,)."""
    constant = _FIRST_OF_POOL
    for i in range(POOL_SIZE):
        word = np.uint64(entropy[i]) if i < entropy.shape[0] else np.uint64(0)
        pool[i], constant = _hashed(word, constant, _NEXT_OF_POOL)
    for source in range(max(entropy.shape[0], POOL_SIZE)):
        for i in range(POOL_SIZE):
            if i != source:
                word = pool[source] if source < POOL_SIZE else np.uint64(entropy[source])
                word, constant = _hashed(word, constant, _NEXT_OF_POOL)
                mixed = (_LEFT * pool[i] - _RIGHT * word) & _LOW
                pool[i] = mixed ^ (mixed >> _HALF)


@kernel
def _fill_words(pool: Words, out: Words) -> None:
    """Write the words of 64 bits that a pool, (4,), generates; the lower half of each comes first."""
    constant = _FIRST_OF_OUTPUT
    for k in range(out.shape[0]):
        low, constant = _hashed(pool[2 * k % POOL_SIZE], constant, _NEXT_OF_OUTPUT)
        high, constant = _hashed(pool[(2 * k + 1) % POOL_SIZE], constant, _NEXT_OF_OUTPUT)
        out[k] = low | (high << _WORD)


@kernel
def _hashed(word: np.uint64, constant: np.uint64, factor: np.uint64) -> tuple[np.uint64, np.uint64]:
    """Return the hash of a word of 32 bits by a constant, and the constant of the next hash."""
    following = (constant * factor) & _LOW
    value = ((word ^ constant) * following) & _LOW
    return value ^ (value >> _HALF), following
