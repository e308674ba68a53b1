"""Transformations that several BBOB functions share, as kernels on vectors (D,).

Source of all equations here and in the neighbours: N. Hansen, S. Finck, R. Ros, A. Auger, "Real-parameter
black-box optimization benchmarking 2009: noiseless functions definitions", INRIA RR-6829, 2009, section 0.2.
Components are numbered from 0 here, so (i - 1) / (D - 1) is k / (D - 1).
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel

Floats = NDArray[np.float64]

# Half the width of the domain; `penalty` begins there.
REACH = 5.0


@kernel
def oscillated(x: float) -> float:
    """Return T_osz(x), which makes slopes irregular and lets 0 where it is."""
    if x == 0.0:
        return 0.0
    logarithm = math.log(abs(x))
    if x > 0.0:
        return math.exp(logarithm + 0.049 * (math.sin(10.0 * logarithm) + math.sin(7.9 * logarithm)))
    return -math.exp(logarithm + 0.049 * (math.sin(5.5 * logarithm) + math.sin(3.1 * logarithm)))


@kernel(inline="late")
def oscillate(x: Floats) -> None:
    """Replace every component by T_osz of it."""
    for k in range(x.shape[0]):
        x[k] = oscillated(x[k])


@kernel(inline="late")
def skew(x: Floats, beta: float) -> None:
    """Replace a vector by T_asy^beta(x): positive components grow, the last ones most."""
    last = x.shape[0] - 1.0
    for k in range(x.shape[0]):
        if x[k] > 0.0:
            x[k] = x[k] ** (1.0 + beta * (k / last) * math.sqrt(x[k]))


@kernel(inline="late")
def subtract(path: Floats, centre: Floats, out: Floats) -> None:
    """Write the decision vector of a path, (C + 1,), minus a centre, (C,), to `out`, (D,)."""
    for k in range(out.shape[0]):
        out[k] = path[k + 1] - centre[k]


@kernel
def transform(columns: Floats, x: Floats, out: Floats) -> None:
    """Write the product of a matrix and x to `out`.

    Args:
        columns: (>= D, >= D) transposed matrix. Its rows are added up, which compilers turn into SIMD code
            without a change of the order of sums.
        x: (D,) vector.
        out: (D,) vector, which must not be x.
    """
    size = x.shape[0]
    for k in range(size):
        out[k] = 0.0
    for j in range(size):
        factor, column = x[j], columns[j]
        for k in range(size):
            out[k] += column[k] * factor


@kernel(inline="late")
def penalty(path: Floats, dimension: int) -> float:
    """Return f_pen: squared distances of the components from [-5, 5], added up."""
    total = 0.0
    for k in range(1, dimension + 1):
        beyond = abs(path[k]) - REACH
        if beyond > 0.0:
            total += beyond * beyond
    return total


@kernel(inline="late")
def rastrigin(z: Floats) -> float:
    """Return 10 (D - sum of cos(2 pi z_k)) + sum of z_k^2."""
    waves, squares = 0.0, 0.0
    for k in range(z.shape[0]):
        waves += math.cos(2.0 * math.pi * z[k])
        squares += z[k] * z[k]
    return 10.0 * (z.shape[0] - waves) + squares


@kernel(inline="late")
def rosenbrock(z: Floats, k: int) -> float:
    """Return the term of the components k and k + 1 of Rosenbrock's sum."""
    bend, ahead = z[k] * z[k] - z[k + 1], z[k] - 1.0
    return 100.0 * (bend * bend) + ahead * ahead


@kernel(inline="late")
def weighted_squares(weights: Floats, z: Floats) -> float:
    """Return the sum of weights_k z_k^2; weights are (C,)."""
    total = 0.0
    for k in range(z.shape[0]):
        total += weights[k] * (z[k] * z[k])
    return total
