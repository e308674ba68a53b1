"""BBOB functions f15 to f24, which have many local optima.

See `transformations` for the source. `y`, (D,), is the transformed x - x_opt; `z`, (D,), is room to work in.
`outer` is the transposed matrix of a second transformation, (>= D, >= D).
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.bbob.transformations import (
    REACH,
    oscillate,
    oscillated,
    penalty,
    rastrigin,
    rosenbrock,
    skew,
    transform,
)

Floats = NDArray[np.float64]

# Terms of the sums over k of f16 and over j of f23.
NUM_WAVES = 12
NUM_TEETH = 32
# 1/2^0 + 1/2^1 + ... + 1/2^11, the largest value of the waves of f16, which is that at the optimum, negated.
MOST_OF_WAVES = 2.0 - 2.0 ** (1 - NUM_WAVES)
# The least value of the mean of Schwefel's sum over 100, negated.
SCHWEFEL_DEPTH = 4.189828872724339
# Places of the two funnels of f24: mu_0, and d, the depth of the second one for each component.
LUNACEK_PLACE, LUNACEK_DEPTH = 2.5, 1.0


@kernel(inline="late")
def rotated_rastrigin(outer: Floats, y: Floats, z: Floats) -> float:
    """Return f15: Rastrigin's function of R Lambda^10 Q T_asy^0.2(T_osz(y)); `outer` is R Lambda^10 Q."""
    oscillate(y)
    skew(y, 0.2)
    transform(outer, y, z)
    return rastrigin(z)


@kernel(inline="late")
def weierstrass(outer: Floats, path: Floats, y: Floats, z: Floats) -> float:
    """Return f16: 10 (mean over the components of Weierstrass' sum - f_0)^3, and a penalty.

    The terms of the sum are cos(2 pi 3^k (z + 1/2)) / 2^k, with z = R Lambda^(1/100) Q T_osz(y).
    """
    oscillate(y)
    transform(outer, y, z)
    total = 0.0
    for k in range(z.shape[0]):
        turns, share = z[k] + 0.5, 1.0
        for _ in range(NUM_WAVES):
            total += share * math.cos(2.0 * math.pi * turns)
            turns *= 3.0
            share *= 0.5
    mean = total / z.shape[0] + MOST_OF_WAVES
    return 10.0 * mean**3 + 10.0 / z.shape[0] * penalty(path, z.shape[0])


@kernel(inline="late")
def schaffers(outer: Floats, path: Floats, y: Floats, z: Floats) -> float:
    """Return f17 or f18: the squared mean of sqrt(s) (1 + sin^2(50 s^(1/5))), and a penalty.

    s is the length of (z_k, z_(k+1)) with z = Lambda Q T_asy^0.5(y); `outer` is Lambda Q.
    """
    skew(y, 0.5)
    transform(outer, y, z)
    total = 0.0
    for k in range(z.shape[0] - 1):
        length = math.sqrt(z[k] * z[k] + z[k + 1] * z[k + 1])
        wave = math.sin(50.0 * length**0.2)
        total += math.sqrt(length) * (1.0 + wave * wave)
    mean = total / (z.shape[0] - 1.0)
    return mean * mean + 10.0 * penalty(path, z.shape[0])


@kernel(inline="late")
def griewank_rosenbrock(y: Floats, scale: float) -> float:
    """Return f19: 10 times the mean of s_k / 4000 - cos(s_k), plus 10.

    s_k are the terms of Rosenbrock's function of `scale` y + 1.
    """
    for k in range(y.shape[0]):
        y[k] = scale * y[k] + 1.0
    total = 0.0
    for k in range(y.shape[0] - 1):
        term = rosenbrock(y, k)
        total += term / 4000.0 - math.cos(term)
    return 10.0 * (total / (y.shape[0] - 1.0)) + 10.0


@kernel(inline="late")
def schwefel(weights: Floats, optimum: Floats, path: Floats, z: Floats) -> float:
    """Return f20: Schwefel's function of a vector whose neighbours are coupled, and a penalty of that vector.

    `weights` is the diagonal of Lambda^10, `optimum` is x_opt; both are (C,).
    """
    size = z.shape[0]
    waves, outside, before = 0.0, 0.0, 0.0
    for k in range(size):
        twice = 2.0 * abs(optimum[k])
        mirrored = math.copysign(2.0, optimum[k]) * path[k + 1]
        coupled = mirrored + 0.25 * before if k > 0 else mirrored
        before = mirrored - twice
        z[k] = 100.0 * (weights[k] * (coupled - twice) + twice)
        waves += z[k] * math.sin(math.sqrt(abs(z[k])))
        beyond = abs(z[k] / 100.0) - REACH
        if beyond > 0.0:
            outside += beyond * beyond
    return SCHWEFEL_DEPTH - waves / (100.0 * size) + 100.0 * outside


@kernel(inline="late")
def gallagher(places: Floats, conditions: Floats, heights: Floats, path: Floats, y: Floats) -> float:
    """Return f21 or f22: T_osz(10 - the highest of all peaks here)^2, and a penalty.

    Args:
        places: (peaks, >= D) rotated positions of the peaks, relative to the highest one.
        conditions: (peaks, >= D) weights of the squared distances.
        heights: (peaks,) w_i; 0 in rows that pad.
        path: (C + 1,) the decision vector behind a zero.
        y: (D,) R (x - x_opt).
    """
    size, highest = y.shape[0], 0.0
    for i in range(heights.shape[0]):
        total = 0.0
        for k in range(size):
            apart = y[k] - places[i, k]
            total += conditions[i, k] * (apart * apart)
        highest = max(highest, heights[i] * math.exp(-0.5 / size * total))
    value = oscillated(10.0 - highest)
    return value * value + penalty(path, size)


@kernel(inline="late")
def katsuura(path: Floats, y: Floats) -> float:
    """Return f23: a product over the components, with y = Q Lambda^100 R (x - x_opt), and a penalty.

    The factors are (1 + k sum of |2^j y_k - [2^j y_k]| / 2^j)^(10 / D^1.2), k = 1 ... D and j = 1 ... 32.
    """
    size, product = y.shape[0], 1.0
    exponent = 10.0 / size**1.2
    for k in range(size):
        rough, power = 0.0, 1.0
        for _ in range(NUM_TEETH):
            power *= 2.0
            grown = power * y[k]
            rough += abs(grown - math.floor(grown + 0.5)) / power
        product *= (1.0 + (k + 1.0) * rough) ** exponent
    return 10.0 / (size * size) * (product - 1.0) + penalty(path, size)


@kernel(inline="late")
def lunacek(inner: Floats, optimum: Floats, path: Floats, y: Floats, z: Floats) -> float:
    """Return f24: two funnels and the waves of Rastrigin's function, and a penalty.

    `inner` is the transposed matrix Q Lambda^100 R, and `optimum` is x_opt, (C,), of which the signs count.
    """
    size = y.shape[0]
    spread = 1.0 - 1.0 / (2.0 * math.sqrt(size + 20.0) - 8.2)
    other_place = -math.sqrt((LUNACEK_PLACE * LUNACEK_PLACE - LUNACEK_DEPTH) / spread)
    first, second = 0.0, 0.0
    for k in range(size):
        mirrored = math.copysign(2.0, optimum[k]) * path[k + 1]
        y[k] = mirrored - LUNACEK_PLACE
        first += y[k] * y[k]
        second += (mirrored - other_place) ** 2
    transform(inner, y, z)
    waves = 0.0
    for k in range(size):
        waves += math.cos(2.0 * math.pi * z[k])
    funnels = min(first, LUNACEK_DEPTH * size + spread * second)
    return funnels + 10.0 * (size - waves) + 1e4 * penalty(path, size)
