"""Bezier curves near polylines."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SAMPLES = 200  # of a polyline, to which a curve is fitted


def evenly_spaced(path: Floats, number: int) -> Floats:
    """Return points at even distances along a polyline, (k, 2), as (number, 2)."""
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    at = np.linspace(0.0, ends[-1], number)
    return np.stack([np.interp(at, ends, coordinates) for coordinates in path.T], axis=-1)


def nearest_curves(paths: Floats, num_free: int) -> Floats:
    """Return the Bezier curves nearest to polylines, by least squares at points that are evenly spaced.

    Args:
        paths: (m, k, 2) polylines; curves have their ends.
        num_free: n, number of free control points of a curve.

    Returns:
        (m, 2 n) x of all free control points, then their y.
    """
    degree = num_free + 1
    t, k = np.linspace(0.0, 1.0, SAMPLES)[:, None], np.arange(degree + 1)
    choose = np.array([math.comb(degree, i) for i in k], dtype=np.float64)
    weights = choose * t**k * (1.0 - t) ** (degree - k)
    found = []
    for path in paths:
        points = evenly_spaced(path, SAMPLES)
        fixed = weights[:, [0, -1]] @ points[[0, -1]]
        found.append(np.linalg.lstsq(weights[:, 1:-1], points - fixed, rcond=None)[0].T.ravel())
    return np.array(found)
