import naive
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swarm_gym.random_stream import WORDS, fill_uniform, seed_stream

SEEDS = st.integers(0, 2**64 - 1)


def numpy_state(bit_generator):
    return bit_generator.state["state"]["state"].tolist()


def drawn(stream, count):
    out = np.empty(count)
    fill_uniform(stream, out)
    return out


@given(seed=SEEDS, length=st.integers(0, 200))
@settings(deadline=None, derandomize=True, max_examples=200)
def test_the_numbers_are_those_of_numpy(seed, length):
    sequence = np.random.SeedSequence(seed)
    expected = np.random.Generator(np.random.SFC64(sequence)).random(length)
    assert drawn(seed_stream(sequence), length).tolist() == expected.tolist()


@given(seed=SEEDS, lengths=st.lists(st.integers(0, 40), max_size=6))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_the_state_advances_as_that_of_numpy_however_the_numbers_are_split(seed, lengths):
    sequence = np.random.SeedSequence(seed)
    stream, reference = seed_stream(sequence), np.random.SFC64(sequence)
    for length in lengths:
        drawn(stream, length)
        reference.random_raw(length)
        assert stream.tolist() == numpy_state(reference)


@given(words=st.lists(SEEDS, min_size=4, max_size=4), length=st.integers(0, 50))
@settings(deadline=None, derandomize=True, max_examples=200)
def test_any_state_gives_the_numbers_of_the_published_generator(words, length):
    stream, oracle = np.array(words, dtype=np.uint64), naive.Sfc64(words)
    assert drawn(stream, length).tolist() == [oracle.uniform() for _ in range(length)]
    assert stream.tolist() == oracle.words()


@pytest.mark.parametrize("seed", range(5))
def test_the_naive_generator_gives_the_words_of_numpy(seed):
    sequence = np.random.SeedSequence(seed)
    oracle = naive.Sfc64(seed_stream(sequence))
    assert [oracle.word() for _ in range(1000)] == np.random.SFC64(sequence).random_raw(1000).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_long_stream_never_leaves_that_of_numpy(seed):
    sequence = np.random.SeedSequence(seed)
    expected = np.random.Generator(np.random.SFC64(sequence)).random(1_000_000)
    np.testing.assert_array_equal(drawn(seed_stream(sequence), 1_000_000), expected)


def test_numbers_lie_in_the_half_open_unit_interval_at_the_extremes_of_a_word():
    # The first word is a + b + counter.
    largest = np.array([2**64 - 1, 0, 0, 0], dtype=np.uint64)
    smallest = np.array([0, 0, 0, 0], dtype=np.uint64)
    assert drawn(largest, 1)[0] == 1 - 2.0**-53
    assert drawn(smallest, 1)[0] == 0.0


def test_nothing_drawn_leaves_the_stream_where_it_is():
    stream = seed_stream(np.random.SeedSequence(3))
    before = stream.copy()
    drawn(stream, 0)
    assert stream.tolist() == before.tolist()


def test_a_copy_is_independent():
    stream = seed_stream(np.random.SeedSequence(7))
    copied = stream.copy()
    first = drawn(stream, 10)
    second = drawn(stream, 10)
    assert drawn(copied, 10).tolist() == first.tolist()
    assert drawn(copied, 10).tolist() == second.tolist()
    assert first.tolist() != second.tolist()


def test_two_streams_of_one_array_do_not_disturb_each_other():
    sequences = np.random.SeedSequence(1).spawn(2)
    streams = np.stack([seed_stream(sequence) for sequence in sequences])
    assert streams.shape == (2, WORDS)
    together = [drawn(streams[b % 2], 5) for b in range(6)]
    for b, sequence in enumerate(sequences):
        alone = np.random.Generator(np.random.SFC64(sequence)).random(15)
        assert np.concatenate(together[b::2]).tolist() == alone.tolist()


def test_seeding_leaves_the_seed_sequence_usable_for_the_same_stream():
    sequence = np.random.SeedSequence(11)
    assert seed_stream(sequence).tolist() == seed_stream(sequence).tolist()
    assert seed_stream(sequence).dtype == np.uint64
