"""Common parts of problem tables of all kinds: types of their numbers, and padded arrays.

A table of one problem has numbers, such as its dimension. In a table of stacked problems they are arrays,
with an entry for each problem.
"""

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar

from swarm_gym.compiler.simd import padded

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]

# Numbers of a table: `int` and `float` for one problem, `Integers` and `Floats` where problems are stacked.
Whole = TypeVar("Whole", default=int)
Real = TypeVar("Real", default=float)


def columns(dimension: int) -> int:
    """Return C, the columns of arrays over components of decision vectors or over segments (one more)."""
    return padded(dimension + 1)


def pad(values: Floats) -> Floats:
    """Return an array over components, (..., dimension), with zeros up to whole blocks of lanes, (..., C)."""
    out = np.zeros((*values.shape[:-1], columns(values.shape[-1])))
    out[..., : values.shape[-1]] = values
    return out
