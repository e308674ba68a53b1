"""Mutated files for property-based tests, and limits of time and memory for their readers."""

import functools
import tracemalloc
from contextlib import contextmanager
from datetime import timedelta

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

# What a refusal may take of time, per example (milliseconds, where the machine is not busy), and of memory.
DEADLINE = timedelta(seconds=5)
MAX_MEMORY = 200 * 2**20

# How many examples: those of the profile in force, 100 in the usual run and 10,000 in `make test-slow`. The
# second is for tests that write each example to the same folder.
_settings = settings(
    deadline=DEADLINE,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def fuzzed(test):
    """Mark a property-based test of any input for `-m fuzzed`, and bound its time and memory."""

    @functools.wraps(test)
    def bounded(*args, **kwargs):
        with bounded_memory():
            test(*args, **kwargs)

    return pytest.mark.fuzzed(_settings(bounded))


@contextmanager
def bounded_memory(limit=MAX_MEMORY):
    """Fail if more bytes of memory are used than the refusal of an input needs."""
    tracemalloc.start()
    try:
        yield
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < limit


def mutated(content, *insertions):
    """Draw the content with some bytes removed, and some of these texts or random bytes inserted."""
    place = st.integers(0, len(content))
    change = st.tuples(place, st.integers(0, 6), st.binary(max_size=4) | st.sampled_from(insertions))

    def apply(changes):
        result = content
        for begin, removed, added in changes:
            result = result[:begin] + added + result[begin + removed :]
        return result

    return st.lists(change, min_size=1, max_size=4).map(apply)
