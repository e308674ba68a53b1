"""BBOB functions f6 to f14, which are unimodal and not separable, but for Rosenbrock's (f8, f9).

See `transformations` for the source. `y`, (D,), is the transformed x - x_opt; `z`, (D,), is room to work in.
`outer` is the transposed matrix of a second transformation, (>= D, >= D).
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.bbob.transformations import (
    oscillate,
    oscillated,
    penalty,
    rosenbrock,
    skew,
    transform,
    weighted_squares,
)

Floats = NDArray[np.float64]


@kernel(inline="late")
def attractive_sector(optimum: Floats, y: Floats) -> float:
    """Return f6: T_osz(sum of (s_k y_k)^2)^0.9 with y = Q Lambda^10 R (x - x_opt).

    s_k is 100 where y_k and x_opt,k have the same sign, else 1; `optimum` is x_opt, (C,).
    """
    total = 0.0
    for k in range(y.shape[0]):
        stretched = 100.0 * y[k] if y[k] * optimum[k] > 0.0 else y[k]
        total += stretched * stretched
    return oscillated(total) ** 0.9


@kernel(inline="late")
def step_ellipsoid(weights: Floats, outer: Floats, path: Floats, y: Floats, z: Floats) -> float:
    """Return f7: an ellipsoid in steps, with y = Lambda^10 R (x - x_opt), and a penalty."""
    first = abs(y[0])
    for k in range(y.shape[0]):
        if abs(y[k]) > 0.5:
            y[k] = math.floor(0.5 + y[k])
        else:
            y[k] = math.floor(0.5 + 10.0 * y[k]) / 10.0
    transform(outer, y, z)
    return 0.1 * max(first / 1e4, weighted_squares(weights, z)) + penalty(path, y.shape[0])


@kernel(inline="late")
def rosenbrock_valley(y: Floats, scale: float) -> float:
    """Return f8, or f9 where y is rotated: Rosenbrock's function of `scale` y + 1."""
    for k in range(y.shape[0]):
        y[k] = scale * y[k] + 1.0
    total = 0.0
    for k in range(y.shape[0] - 1):
        total += rosenbrock(y, k)
    return total


@kernel(inline="late")
def discus(y: Floats) -> float:
    """Return f11: 10^6 z_0^2 + the sum of the other z_k^2, with z = T_osz(y)."""
    oscillate(y)
    return 1e6 * y[0] * y[0] + _squares_behind_the_first(y)


@kernel(inline="late")
def bent_cigar(outer: Floats, y: Floats, z: Floats) -> float:
    """Return f12: z_0^2 + 10^6 times the sum of the other z_k^2, with z = R T_asy^0.5(y)."""
    skew(y, 0.5)
    transform(outer, y, z)
    return z[0] * z[0] + 1e6 * _squares_behind_the_first(z)


@kernel(inline="late")
def sharp_ridge(y: Floats) -> float:
    """Return f13: y_0^2 + 100 times the length of the others, with y = Q Lambda^10 R (x - x_opt)."""
    return y[0] * y[0] + 100.0 * math.sqrt(_squares_behind_the_first(y))


@kernel(inline="late")
def different_powers(exponents: Floats, y: Floats) -> float:
    """Return f14: the root of the sum of |y_k|^(2 + 4 k / (D - 1)); these exponents are given, (C,)."""
    total = 0.0
    for k in range(y.shape[0]):
        total += abs(y[k]) ** exponents[k]
    return math.sqrt(total)


@kernel(inline="late")
def _squares_behind_the_first(y: Floats) -> float:
    total = 0.0
    for k in range(1, y.shape[0]):
        total += y[k] * y[k]
    return total
