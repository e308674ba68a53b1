import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from swarm_gym.compiler.seed_sequence import generated, spawned

WORDS = st.integers(0, 2**32 - 1)
MANY = settings(deadline=None, derandomize=True, max_examples=300)


def words_of_numpy(entropy, count, spawn_key=()):
    return np.random.SeedSequence(entropy, spawn_key=spawn_key).generate_state(count, np.uint64).tolist()


def generated_for(entropy, count):
    return generated(np.array([entropy], dtype=np.uint32), count)[0].tolist()


@given(entropy=st.lists(WORDS, max_size=12), count=st.integers(0, 30))
@example(entropy=[], count=24)
@example(entropy=[0], count=24)
@example(entropy=[0, 0, 0, 0, 0], count=24)
@example(entropy=[2**32 - 1] * 9, count=24)
@MANY
def test_words_are_those_of_numpy(entropy, count):
    assert generated_for(entropy, count) == words_of_numpy(entropy, count)


@given(number=st.integers(0, 2**300))
@example(number=0)
@example(number=2**32)
@MANY
def test_a_large_number_is_its_words_from_the_lowest_on(number):
    words = [number >> 32 * k & 0xFFFFFFFF for k in range(max(1, (number.bit_length() + 31) // 32))]
    assert generated_for(words, 24) == words_of_numpy(number, 24)


@given(entropy=st.lists(WORDS, min_size=1, max_size=10), child=st.integers(0, 2**32 - 1))
@example(entropy=[7], child=0)
@MANY
def test_children_are_those_that_numpy_spawns(entropy, child):
    found = generated(spawned(np.array([entropy], dtype=np.uint32), child), 24)[0].tolist()
    assert found == words_of_numpy(entropy, 24, (child,))


def test_each_seed_of_many_is_hashed_by_itself():
    entropies = np.random.default_rng(5).integers(0, 2**32, size=(300, 8), dtype=np.uint32)
    for child in (0, 1):
        found = generated(spawned(entropies, child), 24)
        assert found.shape == (300, 24)
        for row, entropy in zip(found, entropies.tolist(), strict=True):
            assert row.tolist() == words_of_numpy(entropy, 24, (child,))
    assert generated(entropies[:0], 24).shape == (0, 24)


@pytest.mark.parametrize("length", [1, 3, 4, 5, 8])
def test_two_children_differ_and_leave_the_entropy_as_it_was(length):
    entropy = np.arange(1, length + 1, dtype=np.uint32)[None]
    first, second = (generated(spawned(entropy, child), 8) for child in (0, 1))
    assert not (first == second).any()
    assert entropy[0].tolist() == list(range(1, length + 1))
