"""Loops over many small cases in one test, which cost less to collect and to start than as many tests."""

import functools
import inspect
from contextlib import contextmanager

EMPTY = "a loop without cases tests nothing"


@contextmanager
def named_case(description):
    """Name the case in the report of a failure inside the block."""
    try:
        yield
    except Exception as error:
        error.add_note(f"in the case {description}")
        raise


def looped(names, values):
    """Run a test for every value, as `pytest.mark.parametrize` does, but in one test that stops at a failure.

    It is for cases that take milliseconds. The fixtures of the test are made once for all values.

    Args:
        names: name of an argument, or a tuple of names.
        values: one value, or one tuple of values, for each run of the test; there is at least one. A
            function without arguments returns them when the test runs, which spares workers that do not run
            it the time.
    """
    names = (names,) if isinstance(names, str) else tuple(names)
    if not callable(values):
        values = list(values)
        assert values, EMPTY

    def decorate(test):
        signature = inspect.signature(test)
        assert {*names} <= signature.parameters.keys(), f"{test.__name__} does not take {names}"

        @functools.wraps(test)
        def run(**others):
            found = [*(values() if callable(values) else values)]
            assert found, EMPTY
            for value in found:
                row = (value,) if len(names) == 1 else tuple(value)
                chosen = dict(zip(names, row, strict=True))
                with named_case(", ".join(f"{name}={value!r}" for name, value in chosen.items())):
                    test(**others, **chosen)

        left = [parameter for name, parameter in signature.parameters.items() if name not in names]
        run.__signature__ = signature.replace(parameters=left)
        return run

    return decorate
