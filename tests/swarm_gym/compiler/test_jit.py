"""Kernels are called from Python and from kernels."""

import os
import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from helpers.compiled import compiled
from swarm_gym.compiler.jit import entry, kernel, kernel_by_class

needs_compiler = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)


def half(values):
    return values.sum() / 2.0


@pytest.mark.parametrize(
    "decorate", [kernel, kernel(), kernel(inline="late"), kernel(inline="early"), kernel(borrows=True)]
)
def test_kernels_that_only_kernels_call_can_be_called_from_python(decorate):
    assert decorate(half)(np.arange(4.0)) == 3.0


def test_kernels_that_only_kernels_call_are_compiled_into_their_callers():
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


row_of = kernel(first_row)
row_by_class = kernel_by_class({Row: kernel(lambda row, factor: Row(row.values * factor, row.number))})


def number_of_row(rows):
    return row_of(rows).number


def number_of_row_by_class(rows):
    return row_by_class(Row(rows[0], 0), 2.0).number


@needs_compiler
@pytest.mark.parametrize(
    ("caller", "callee"), [(number_of_row, "first_row"), (number_of_row_by_class, "<lambda>")]
)
def test_kernels_that_call_one_that_returns_an_array_cannot_borrow(caller, callee):
    rows = np.ones((2, 4))
    assert compiled(kernel(caller))(rows) == 0
    with pytest.raises(
        TypeError, match=f"{caller.__name__} borrows arrays, but calls {callee}, which returns"
    ):
        compiled(kernel(borrows=True)(caller))(rows)


number_by_class = kernel_by_class({Row: kernel(borrows=True)(lambda row: row_of(row.values).number)})


@needs_compiler
def test_kernels_that_are_chosen_by_class_are_checked_too():
    with pytest.raises((TypeError, TypingError), match="never free"):
        compiled(number_by_class)(Row(np.ones((2, 4)), 0))


def test_kernels_that_are_inlined_early_borrow_as_their_callers_do():
    with pytest.raises(ValueError, match="leave out `borrows`"):
        kernel(inline="early", borrows=True)
