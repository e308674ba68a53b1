"""Bezier curves near polylines."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import product
from swarm_gym.problem.geometry.polylines import evenly_spaced

Floats = NDArray[np.float64]

SAMPLES = 200  # of a polyline, to which a curve is fitted


def nearest_curves(paths: Floats, num_free: int) -> Floats:
    """Return the Bezier curves nearest to polylines, by least squares at points that are evenly spaced.

    Args:
        paths: (m, k, 2) polylines; curves have their ends.
        num_free: n, number of free control points of a curve.

    Returns:
        (m, 2 n) x of all free control points, then their y.
    """
    weights = bernstein(num_free + 1, SAMPLES)
    found = []
    for path in paths:
        points = evenly_spaced(path, SAMPLES)
        fixed = product(weights[:, [0, -1]], points[[0, -1]])
        found.append(_least_squares(weights[:, 1:-1], points - fixed).T.ravel())
    return np.array(found)


def bernstein(degree: int, count: int) -> Floats:
    """Return Bernstein polynomials of a degree at `count` values of t from 0 to 1, (count, degree + 1)."""
    t = np.linspace(0.0, 1.0, count)
    choose = np.array([math.comb(degree, k) for k in range(degree + 1)], dtype=np.float64)
    # By repeated products: NumPy's power has other last digits on other processors.
    return choose * np.vander(t, degree + 1, increasing=True) * np.vander(1.0 - t, degree + 1)


def _least_squares(matrix: Floats, right: Floats) -> Floats:
    """Return the X (n, m) that minimises |matrix (k, n) X - right (k, m)|.

    By Gram and Schmidt's method, twice for each column, with sums in a fixed order; the libraries of linear
    algebra choose that order by the processor.
    """
    number = matrix.shape[1]
    basis, triangle = matrix.T.copy(), np.eye(number)
    for j in range(number):
        for _ in range(2):
            for i in range(j):
                share = float((basis[i] * basis[j]).sum())
                basis[j] -= share * basis[i]
                triangle[i, j] += share
        triangle[j, j] = math.sqrt(float((basis[j] * basis[j]).sum()))
        basis[j] /= triangle[j, j]
    found = (basis[:, :, None] * right).sum(axis=1)
    for j in range(number - 1, -1, -1):
        found[j] = (found[j] - (triangle[j, j + 1 :, None] * found[j + 1 :]).sum(axis=0)) / triangle[j, j]
    return found
