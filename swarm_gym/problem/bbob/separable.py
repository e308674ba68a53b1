"""BBOB functions f1 to f5, which are separable; see `transformations` for the source.

`weights`, (C,), is what `table.tabulate` puts there for the function. `y`, (D,), is x - x_opt and room to
work in.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.bbob.transformations import (
    REACH,
    oscillate,
    penalty,
    rastrigin,
    skew,
    weighted_squares,
)

Floats = NDArray[np.float64]


@kernel(inline="late")
def sphere(y: Floats) -> float:
    """Return f1: the sum of y_k^2."""
    total = 0.0
    for k in range(y.shape[0]):
        total += y[k] * y[k]
    return total


@kernel(inline="late")
def ellipsoid(weights: Floats, y: Floats) -> float:
    """Return f2, or f10 where y is rotated: the sum of 10^(6 k / (D - 1)) z_k^2 with z = T_osz(y)."""
    oscillate(y)
    return weighted_squares(weights, y)


@kernel(inline="late")
def separable_rastrigin(weights: Floats, y: Floats) -> float:
    """Return f3: Rastrigin's function of Lambda^10 T_asy^0.2(T_osz(y)).

    `weights` is the diagonal of Lambda^10. MetaBox has this function where y is rotated, too.
    """
    oscillate(y)
    skew(y, 0.2)
    for k in range(y.shape[0]):
        y[k] *= weights[k]
    return rastrigin(y)


@kernel(inline="late")
def skew_rastrigin(weights: Floats, path: Floats, y: Floats) -> float:
    """Return f4: Rastrigin's function of s_k T_osz(y_k), and a penalty.

    `weights` is the diagonal of Lambda^10; s_k is ten times the weight where the component is positive and k
    is even. MetaBox has this function where y is rotated, too.
    """
    oscillate(y)
    for k in range(y.shape[0]):
        if k % 2 == 0 and y[k] > 0.0:
            y[k] *= 10.0
        y[k] *= weights[k]
    return rastrigin(y) + 100.0 * penalty(path, y.shape[0])


@kernel(inline="late")
def linear_slope(weights: Floats, path: Floats, y: Floats) -> float:
    """Return f5: the sum of 5 |s_k| - s_k z_k; weights are s_k.

    z_k is x_k, or the component of the optimum where x_k lies beyond it.
    """
    total = 0.0
    for k in range(y.shape[0]):
        slope, x = weights[k], path[k + 1]
        optimum = math.copysign(REACH, slope)
        z = x if x * optimum < REACH * REACH else optimum
        total += REACH * abs(slope) - slope * z
    return total
