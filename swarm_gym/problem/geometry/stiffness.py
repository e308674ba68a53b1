"""The least stiff shapes of a path: eigenvectors of A^T A for the matrix A of second differences.

Row i of A is x[i - 2] - 2 x[i - 1] + x[i], where points outside the path are its ends, whose offset is 0. So
A^T A has five diagonals, with 1, -4, 6, -4 and 1.

Libraries of linear algebra choose the order of their sums by the processor, so the last digits of an
eigenvector depend on it. Here they only give a first guess. Rayleigh quotient iteration in decimal numbers
makes it exact to far more digits than float64 has.
Source: B. N. Parlett, "The symmetric eigenvalue problem", SIAM, 1998, section 4.6; convergence is cubic.
"""

from decimal import Context, Decimal, localcontext

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_DIAGONALS = Decimal(6), Decimal(-4), Decimal(1)
_DIGITS = 90
_KEPT = 45  # decimal places, so that a number that should be 0 is 0
_ROUNDS = 3  # from 1e-8, the worst guess, to less than 1e-60
_BESIDE = Decimal(1).scaleb(-70)  # added to a shift, since a system with an exact eigenvalue has no solution


def least_stiff(count: int, number: int) -> tuple[Floats, Floats]:
    """Return the smallest eigenvalues of A^T A and their unit eigenvectors, in increasing order.

    Args:
        count: number of points between the ends.
        number: number of eigenvalues, at most `count`.

    Returns:
        (number,) eigenvalues; (number, count) eigenvectors, each of which begins with a positive number.
    """
    differences = np.zeros((count + 2, count))
    for row, weight in enumerate((1.0, -2.0, 1.0)):
        differences[row : row + count] += weight * np.eye(count)
    guesses = np.linalg.eigh(differences.T @ differences)[1].T[:number]
    with localcontext(Context(prec=_DIGITS)):
        found = [_refined([Decimal(x) for x in guess.tolist()]) for guess in guesses]
        return np.array([float(value) for value, _ in found]), np.array(
            [[float(round(x, _KEPT)) + 0.0 for x in vector] for _, vector in found]
        )


def _refined(vector: list[Decimal]) -> tuple[Decimal, list[Decimal]]:
    """Return the eigenvalue and the unit eigenvector that belong to a guess."""
    for _ in range(_ROUNDS):
        vector = _unit(_solved(vector, _rayleigh_quotient(vector) + _BESIDE))
    return _rayleigh_quotient(vector), vector


def _unit(vector: list[Decimal]) -> list[Decimal]:
    length = sum((x * x for x in vector), Decimal(0)).sqrt()
    length = -length if vector[0] < 0 else length
    return [x / length for x in vector]


def _rayleigh_quotient(vector: list[Decimal]) -> Decimal:
    """Return v^T A^T A v for a vector; it is the sum of squares of A v."""
    ends = Decimal(0), Decimal(0)
    padded = [*ends, *vector, *ends]
    bends = [padded[k - 2] - 2 * padded[k - 1] + padded[k] for k in range(2, len(padded))]
    squares = sum((bend * bend for bend in bends), Decimal(0))
    return squares / sum((x * x for x in vector), Decimal(0))


def _solved(right: list[Decimal], shift: Decimal) -> list[Decimal]:
    """Return the solution of (A^T A - shift) x = right, by factors L D L^T; L has three diagonals."""
    zero, count = Decimal(0), len(right)
    main, beside, last = _DIAGONALS
    diagonal, lower, lowest = [zero] * count, [zero] * (count + 1), [zero] * (count + 2)
    x = list(right)
    for k in range(count):
        if k > 1:
            lowest[k] = last / diagonal[k - 2]
        if k > 0:
            lower[k] = (beside - (last * lower[k - 1] if k > 1 else zero)) / diagonal[k - 1]
        before, first = (diagonal[k - 1] if k > 0 else zero), (diagonal[k - 2] if k > 1 else zero)
        diagonal[k] = main - shift - lower[k] ** 2 * before - lowest[k] ** 2 * first
        x[k] -= (lower[k] * x[k - 1] if k > 0 else zero) + (lowest[k] * x[k - 2] if k > 1 else zero)
    x = [value / pivot for value, pivot in zip(x, diagonal, strict=True)]
    for k in range(count - 1, -1, -1):
        x[k] -= lower[k + 1] * x[k + 1] if k + 1 < count else zero
        x[k] -= lowest[k + 2] * x[k + 2] if k + 2 < count else zero
    return x
