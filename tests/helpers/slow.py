"""Parameters of a test of which a few run in `make test`, and all others in `make test-slow`."""

import pytest


def slow_but(fast, values):
    """Return the values of `pytest.mark.parametrize`, of which all but the named ones are slow.

    The fast ones take the code of the test through each of its paths once, as cheaply as they can.

    Args:
        fast: values that stay fast; each must be among the values.
        values: all values, each of which is one value or a tuple of values.
    """
    values, fast = [*values], [*fast]
    assert fast, "at least one value stays fast"
    missing = [one for one in fast if one not in values]
    assert missing == [], f"not among the values: {missing}"
    return [
        pytest.param(
            *(one if isinstance(one, tuple) else (one,)), marks=() if one in fast else pytest.mark.slow
        )
        for one in values
    ]
