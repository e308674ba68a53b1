"""Kernels that only kernels call: from Python, and from kernels."""

import os
import sys
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.errors import TypingError

from swarm_gym.compiler.jit import borrowing_kernel, inner_kernel, kernel, merged_kernel

needs_compiler = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="asks for a compiler")


def half(values):
    return values.sum() / 2.0


@pytest.mark.parametrize("decorate", [inner_kernel, merged_kernel, borrowing_kernel])
def test_kernels_that_only_kernels_call_can_be_called_from_python(decorate):
    assert decorate(half)(np.arange(4.0)) == 3.0


def test_they_are_compiled_into_the_kernels_that_call_them():
    inner, merged = inner_kernel(half), merged_kernel(half)

    @kernel
    def both(values):
        return inner(values) + merged(values)

    assert both(np.arange(4.0)) == 6.0


class Row(NamedTuple):
    """An array and a number."""

    values: np.ndarray
    number: int


def first_row(rows):
    return Row(rows[0], 0)


def half_of_a_copy(values):
    return half(values.copy())


def compiled_into(inner):
    """A kernel that calls it; not cached, so that what is refused is refused every time."""

    @numba.njit
    def call(values):
        return inner(values)

    return call


@needs_compiler
def test_arrays_are_borrowed_as_they_are_and_not_counted():
    def references(decorate):
        values = np.arange(4.0)
        call = compiled_into(decorate(half))
        before = sys.getrefcount(values)
        assert call(values) == 3.0
        return sys.getrefcount(values) - before

    assert references(borrowing_kernel) == references(inner_kernel) == 0


@needs_compiler
@pytest.mark.parametrize("function", [first_row, half_of_a_copy])
def test_kernels_that_own_an_array_cannot_borrow(function):
    with pytest.raises((TypeError, TypingError), match=function.__name__):
        compiled_into(borrowing_kernel(function))(np.ones((2, 4)))
