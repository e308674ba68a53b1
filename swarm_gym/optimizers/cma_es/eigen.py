"""Eigenvalues and eigenvectors of a symmetric matrix, in a fixed order of operations.

Sources: R. S. Martin, C. Reinsch, J. H. Wilkinson, "Householder's tridiagonalization of a symmetric matrix",
Numerische Mathematik 11, 1968; H. Bowdler, R. S. Martin, C. Reinsch, J. H. Wilkinson, "The QR and QL
algorithms for symmetric matrices", Numerische Mathematik 11, 1968 (`tred2` and `tql2`). LAPACK chooses its
code by the processor, which would change the bits.

A matrix is one array, row after row, with `width` columns in a row, a multiple of eight. Eigenvectors become
its rows, so that rotations combine whole rows.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, load, store

Floats = NDArray[np.float64]

_EPSILON = 2.0**-52
_MOST_ROUNDS = 60  # for one eigenvalue; two are usual


@kernel
def decompose(rows: Floats, width: int, values: Floats, beside: Floats) -> bool:
    """Replace a symmetric matrix by its eigenvectors, of length 1, and write its eigenvalues, in no order.

    Args:
        rows: (n * width,) the matrix; zeros in columns from n on. Afterwards row i is eigenvector i.
        width: number of columns in a row.
        values: (n,) where eigenvalues are written.
        beside: (n,) scratch array.

    Returns:
        Whether all eigenvalues were found; the arrays are undefined if not.
    """
    _make_tridiagonal(rows, width, values, beside)
    return _find_values(rows, width, values, beside)


@kernel(borrows=True)
def _make_tridiagonal(u: Floats, width: int, d: Floats, e: Floats) -> None:
    """Reduce a matrix to its diagonal `d` and the numbers next to it, `e`, by reflections kept in `u`."""
    n = d.shape[0]
    for j in range(n):
        d[j] = u[j * width + n - 1]
    for i in range(n - 1, 0, -1):
        scale = h = 0.0
        for k in range(i):
            scale += abs(d[k])
        if scale == 0.0:
            e[i] = d[i - 1]
            for j in range(i):
                d[j] = u[j * width + i - 1]
                u[j * width + i] = u[i * width + j] = 0.0
        else:
            for k in range(i):
                d[k] /= scale
                h += d[k] * d[k]
            f = d[i - 1]
            g = -math.sqrt(h) if f > 0.0 else math.sqrt(h)
            e[i] = scale * g
            h -= f * g
            d[i - 1] = f - g
            for j in range(i):
                e[j] = 0.0
            for j in range(i):
                row, f = j * width, d[j]
                u[i * width + j] = f
                g = e[j] + u[row + j] * f
                for k in range(j + 1, i):
                    g += u[row + k] * d[k]
                    e[k] += u[row + k] * f
                e[j] = g
            f = 0.0
            for j in range(i):
                e[j] /= h
                f += e[j] * d[j]
            half = f / (h + h)
            for j in range(i):
                e[j] -= half * d[j]
            for j in range(i):
                row, f, g = j * width, d[j], e[j]
                for k in range(j, i):
                    u[row + k] -= f * e[k] + g * d[k]
                d[j] = u[row + i - 1]
                u[row + i] = 0.0
        d[i] = h
    _collect(u, width, d)
    e[0] = 0.0


@kernel(borrows=True)
def _collect(u: Floats, width: int, d: Floats) -> None:
    """Multiply the reflections in `u`, and put the diagonal into `d`."""
    n = d.shape[0]
    for i in range(n - 1):
        u[i * width + n - 1] = u[i * width + i]
        u[i * width + i] = 1.0
        h, following = d[i + 1], (i + 1) * width
        if h != 0.0:
            for k in range(i + 1):
                d[k] = u[following + k] / h
            for j in range(i + 1):
                row, g = j * width, 0.0
                for k in range(i + 1):
                    g += u[following + k] * u[row + k]
                for k in range(i + 1):
                    u[row + k] -= g * d[k]
        for k in range(i + 1):
            u[following + k] = 0.0
    for j in range(n):
        d[j] = u[j * width + n - 1]
        u[j * width + n - 1] = 0.0
    u[(n - 1) * width + n - 1] = 1.0


@kernel(borrows=True)
def _find_values(u: Floats, width: int, d: Floats, e: Floats) -> bool:
    """Make a tridiagonal matrix of diagonal `d` and `e` next to it diagonal, by rotations of rows of `u`."""
    n, shift, largest = d.shape[0], 0.0, 0.0
    for i in range(1, n):
        e[i - 1] = e[i]
    e[n - 1] = 0.0
    for first in range(n):
        largest = max(largest, abs(d[first]) + abs(e[first]))
        last = first
        while last < n - 1 and abs(e[last]) > _EPSILON * largest:
            last += 1
        rounds = 0
        while last > first and (rounds == 0 or abs(e[first]) > _EPSILON * largest):
            rounds += 1
            if rounds > _MOST_ROUNDS:
                return False
            shift += _rotate(u, width, d, e, first, last)
        d[first] += shift
        e[first] = 0.0
    return True


@kernel(borrows=True)
def _rotate(u: Floats, width: int, d: Floats, e: Floats, first: int, last: int) -> float:
    """Do one round of QL with an implicit shift on entries `first` to `last`; return the shift."""
    g = d[first]
    p = (d[first + 1] - g) / (2.0 * e[first])
    r = math.sqrt(p * p + 1.0)
    if p < 0.0:
        r = -r
    d[first] = e[first] / (p + r)
    d[first + 1] = e[first] * (p + r)
    following, h = d[first + 1], g - d[first]
    for i in range(first + 2, d.shape[0]):
        d[i] -= h
    p = d[last]
    c = c2 = c3 = 1.0
    s = s2 = 0.0
    beside = e[first + 1]
    for i in range(last - 1, first - 1, -1):
        c3, c2, s2 = c2, c, s
        g, across = c * e[i], c * p
        r = math.sqrt(p * p + e[i] * e[i])
        e[i + 1] = s * r
        s, c = e[i] / r, p / r
        p = c * d[i] - s * g
        d[i + 1] = across + s * (c * g + s * d[i])
        row = i * width
        for k in range(row, row + width, NUM_LANES):
            above, below = load(u, k), load(u, k + width)
            store(u, k + width, above * s + below * c)
            store(u, k, above * c - below * s)
    p = -s * s2 * c3 * beside * e[first] / following
    e[first] = s * p
    d[first] = c * p
    return h
