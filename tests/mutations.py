"""Files that are almost right."""

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

# For tests that write each example to the same folder.
fuzzed = settings(
    deadline=None,
    derandomize=True,
    max_examples=300,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


def mutated(content, *insertions):
    """The content with some bytes removed, and some of these texts or any bytes inserted."""
    place = st.integers(0, len(content))
    change = st.tuples(place, st.integers(0, 6), st.binary(max_size=4) | st.sampled_from(insertions))

    def apply(changes):
        result = content
        for begin, removed, added in changes:
            result = result[:begin] + added + result[begin + removed :]
        return result

    return st.lists(change, min_size=1, max_size=4).map(apply)
