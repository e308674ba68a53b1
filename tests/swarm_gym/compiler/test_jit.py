"""Kernels are called from Python and from kernels."""

import os
import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from helpers.compiled import compiled
from swarm_gym.compiler.jit import entry, kernel

needs_compiler = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="asks for a compiler")


def half(values):
    return values.sum() / 2.0


@pytest.mark.parametrize(
    "decorate", [kernel, kernel(), kernel(inline="late"), kernel(inline="early"), kernel(borrows=True)]
)
def test_kernels_that_only_kernels_call_can_be_called_from_python(decorate):
    assert decorate(half)(np.arange(4.0)) == 3.0


def test_they_are_compiled_into_the_kernels_that_call_them():
    plain, late, early = kernel(half), kernel(inline="late")(half), kernel(inline="early")(half)

    @entry
    def all_of_them(values):
        return plain(values) + late(values) + early(values)

    assert all_of_them(np.arange(4.0)) == 9.0


class Row(NamedTuple):
    """An array and a number."""

    values: np.ndarray
    number: int


def first_row(rows):
    return Row(rows[0], 0)


def half_of_a_copy(values):
    return half(values.copy())


@needs_compiler
def test_arrays_are_borrowed_as_they_are_and_not_counted():
    def references(decorate):
        values = np.arange(4.0)
        call = compiled(decorate(half))
        before = sys.getrefcount(values)
        assert call(values) == 3.0
        return sys.getrefcount(values) - before

    assert references(kernel(borrows=True)) == references(kernel) == 0


@needs_compiler
@pytest.mark.parametrize("function", [first_row, half_of_a_copy])
def test_kernels_that_own_an_array_cannot_borrow(function):
    with pytest.raises((TypeError, TypingError), match=function.__name__):
        compiled(kernel(borrows=True)(function))(np.ones((2, 4)))


def test_kernels_that_are_inlined_early_borrow_as_their_callers_do():
    with pytest.raises(ValueError, match="leave out `borrows`"):
        kernel(inline="early", borrows=True)
