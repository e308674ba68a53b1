"""Padding of decision vectors in arrays, by zeros to whole blocks of SIMD lanes."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.simd import padded


def columns(dimension: int) -> int:
    """Return C, the columns of arrays over components of decision vectors or over segments (one more)."""
    return padded(dimension + 1)


def pad(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an array over components, (..., dimension), with zeros up to all columns, (..., C)."""
    out = np.zeros((*values.shape[:-1], columns(values.shape[-1])))
    out[..., : values.shape[-1]] = values
    return out
