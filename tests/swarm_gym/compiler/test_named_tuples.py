"""Rows of matrices as NamedTuples, compiled as in Python."""

from typing import NamedTuple

import numba
import numpy as np
import pytest

from swarm_gym.compiler.jit import kernel, kernel_by_class
from swarm_gym.compiler.named_tuples import named_row


class Sides(NamedTuple):
    length: float
    width: float


class Ends(NamedTuple):
    first: float
    last: float


LIKE = Sides(0.0, 0.0)
MATRIX = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])


@numba.njit
def row_of(like, matrix, row):
    return named_row(like, matrix, row)


@pytest.mark.parametrize("row", [0, 1, np.int64(2)])
def test_a_row_has_the_names_of_the_class_compiled_or_not(row):
    for found in (named_row(LIKE, MATRIX, row), row_of(LIKE, MATRIX, row)):
        assert isinstance(found, Sides)
        assert found == Sides(length=MATRIX[row, 0], width=MATRIX[row, 1])


measure = kernel_by_class(
    {
        Sides: kernel(lambda sides: sides.length * sides.width),
        Ends: kernel(lambda ends: ends.last - ends.first),
    }
)


@numba.njit
def measured(like, matrix, row):
    return measure(named_row(like, matrix, row))


def test_the_class_of_a_row_chooses_a_kernel():
    assert (measured(LIKE, MATRIX, 2), measured(Ends(0.0, 0.0), MATRIX, 2)) == (30.0, 1.0)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="NUMBA_DISABLE_JIT=1 turns off the compiler")
@pytest.mark.parametrize(
    "matrix", [MATRIX.T, MATRIX.astype(np.float32), MATRIX[0]], ids=["transposed", "float32", "vector"]
)
def test_other_arrays_are_refused(matrix):
    with pytest.raises(numba.TypingError):
        row_of(LIKE, matrix, 0)
