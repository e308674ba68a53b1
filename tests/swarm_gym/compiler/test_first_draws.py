import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from swarm_gym.compiler.first_draws import integers_and_shares

MANY = settings(deadline=None, derandomize=True, max_examples=300)
LARGEST = 2**32
# Just above a power of two, nearly half of the first draws are refused.
BOUNDS = (1, 2, 3, 512, 2**31 + 1, 2**31 + 2**30, LARGEST - 1, LARGEST)


def drawn_by_numpy(seed, bound):
    generator = np.random.default_rng(seed)
    return int(generator.integers(bound)), generator.random()


def drawn(seeds, bound):
    words = np.array([np.random.SeedSequence(seed).generate_state(4, np.uint64) for seed in seeds])
    integers, shares = integers_and_shares(words, bound)
    return list(zip(integers.tolist(), shares.tolist(), strict=True))


@given(seed=st.integers(0, 2**128), bound=st.integers(1, LARGEST))
@example(seed=0, bound=1)
@MANY
def test_numbers_are_those_of_the_default_generator(seed, bound):
    assert drawn([seed], bound) == [drawn_by_numpy(seed, bound)]


@pytest.mark.parametrize("bound", BOUNDS)
def test_each_seed_of_many_draws_by_itself(bound):
    seeds = range(2000)
    assert drawn(seeds, bound) == [drawn_by_numpy(seed, bound) for seed in seeds]


def test_words_of_a_seed_may_be_extreme():
    for words in ([0] * 4, [2**64 - 1] * 4, [2**64 - 1, 0, 2**63, 2**63], [0, 2**64 - 1, 0, 1]):
        expected = _by_whole_numbers(words)
        integers, shares = integers_and_shares(np.array([words], dtype=np.uint64), LARGEST)
        assert (int(integers[0]), float(shares[0])) == expected


def _by_whole_numbers(words):
    """Return the lower half of a word and the next word as a share, computed in Python's whole numbers."""
    factor, modulus = 0x2360ED051FC65DA44385DF649FCCF645, 2**128
    step = ((words[2] << 64 | words[3]) << 1 | 1) % modulus
    state = (step + (words[0] << 64 | words[1])) % modulus
    state, outputs = (state * factor + step) % modulus, []
    for _ in range(2):
        state = (state * factor + step) % modulus
        word, turn = (state >> 64) ^ (state & (2**64 - 1)), state >> 122
        outputs.append((word >> turn | word << (64 - turn)) & (2**64 - 1))
    return outputs[0] & 0xFFFFFFFF, (outputs[1] >> 11) * 2.0**-53
