"""Lengths of polylines."""

import numpy as np
from numpy.typing import NDArray


def length_of(path: NDArray[np.float64]) -> float:
    """Return the length of a polyline, (k, 2)."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())
