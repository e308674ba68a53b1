import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.random.bit_generator import ISeedSequence

from helpers.compiled import compiled
from oracles import naive
from swarm_gym.compiler.random_stream import STREAM_SHAPE, fill_uniform, seed_stream

SEEDS = st.integers(0, 2**64 - 1)


class Words(ISeedSequence):
    """Hands NumPy's generator the words that it is seeded with."""

    def __init__(self, words):
        self.words = words

    def generate_state(self, n_words, dtype=np.uint32):
        assert (n_words, dtype) == (3, np.uint64)
        return self.words


def numpy_lanes(seed):
    words = np.random.SeedSequence(seed).generate_state(24, np.uint64)
    return [np.random.SFC64(Words(words[3 * lane : 3 * lane + 3])) for lane in range(8)]


def numpy_words(lanes):
    words = [lane.state["state"]["state"].tolist() for lane in lanes]
    return [list(row) for row in zip(*words, strict=True)]


def drawn(stream, rounds):
    """Numbers of so many rounds over the lanes, (rounds, 8)."""
    out = np.empty(8 * rounds)
    compiled(fill_uniform)(stream, out)
    return out.reshape(rounds, 8)


def stream_of(seed):
    return seed_stream(np.random.SeedSequence(seed))


@given(seed=SEEDS, rounds=st.integers(0, 50))
@settings(deadline=None, derandomize=True)
def test_each_lane_gives_the_numbers_of_numpy(seed, rounds):
    numbers = drawn(stream_of(seed), rounds)
    for lane, generator in enumerate(numpy_lanes(seed)):
        assert numbers[:, lane].tolist() == np.random.Generator(generator).random(rounds).tolist()


@given(seed=SEEDS, rounds=st.lists(st.integers(0, 9), max_size=6))
@example(seed=3, rounds=[0])  # nothing drawn leaves the stream where it is
@settings(deadline=None, derandomize=True)
def test_the_state_advances_as_that_of_numpy_however_the_numbers_are_split(seed, rounds):
    stream, lanes = stream_of(seed), numpy_lanes(seed)
    assert stream.tolist() == numpy_words(lanes)
    for count in rounds:
        drawn(stream, count)
        for lane in lanes:
            lane.random_raw(count)
        assert stream.tolist() == numpy_words(lanes)


WORDS = st.lists(st.lists(SEEDS, min_size=8, max_size=8), min_size=4, max_size=4)


@given(words=WORDS, n=st.integers(1, 60))
@settings(deadline=None, derandomize=True)
def test_any_state_gives_the_numbers_of_the_published_generator(words, n):
    stream, oracle = np.array(words, dtype=np.uint64), naive.Stream(words)
    assert drawn(stream, n // 8 + 1).ravel()[:n].tolist() == oracle.uniform(n)
    assert stream.tolist() == oracle.words()


@pytest.mark.parametrize("seed", range(5))
def test_the_naive_generator_gives_the_words_of_numpy(seed):
    reference = np.random.SFC64(seed)
    oracle = naive.Sfc64(reference.state["state"]["state"])
    assert [oracle.word() for _ in range(1000)] == reference.random_raw(1000).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_long_stream_never_leaves_those_of_numpy(seed):
    expected = [np.random.Generator(lane).random(200_000) for lane in numpy_lanes(seed)]
    np.testing.assert_array_equal(drawn(stream_of(seed), 200_000), np.stack(expected, axis=1))


def test_numbers_lie_in_the_half_open_unit_interval_at_the_extremes_of_a_word():
    # The first word is a + b + counter.
    stream = np.zeros(STREAM_SHAPE, dtype=np.uint64)
    stream[0, ::2] = 2**64 - 1
    assert drawn(stream, 1)[0].tolist() == [1 - 2.0**-53, 0.0] * 4


def test_two_streams_of_one_array_and_their_copies_do_not_disturb_each_other():
    streams = np.stack([stream_of(seed) for seed in (0, 1)])
    assert streams.shape == (2, *STREAM_SHAPE)
    copies = streams.copy()
    together, again = ([drawn(of[b % 2], 5) for b in range(6)] for of in (streams, copies))
    for seed in (0, 1):
        alone = drawn(stream_of(seed), 15)
        assert np.concatenate(together[seed::2]).tolist() == alone.tolist()
        assert np.concatenate(again[seed::2]).tolist() == alone.tolist()


def test_no_two_lanes_or_neighbouring_seeds_share_numbers():
    numbers = np.concatenate([drawn(stream_of(seed), 100).ravel() for seed in range(20)])
    assert len(np.unique(numbers)) == len(numbers)


def test_seeding_leaves_the_seed_sequence_usable_for_the_same_stream():
    sequence = np.random.SeedSequence(11)
    assert seed_stream(sequence).tolist() == seed_stream(sequence).tolist()
    assert seed_stream(sequence).dtype == np.uint64
    assert sequence.n_children_spawned == 0
