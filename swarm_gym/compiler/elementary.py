"""Elementary functions that give the same bits on every processor.

NumPy and the C library choose their code for exp, log and their kin by the instructions of the processor. The
last bit of a result depends on that choice. What decides a run uses the functions of this module:
observations, scales of actions, controllers, networks and generators of problems. The functions consist
of additions, products, quotients and square roots of float64, which IEEE 754 defines to the last bit. Their
order is fixed, and no operations are fused.

Sources: W. J. Cody, W. Waite, "Software manual for the elementary functions", Prentice-Hall, 1980 (reduction
of arguments in two parts); W. Kahan's identities for log(1 + x) and exp(x) - 1, in N. J. Higham, "Accuracy
and stability of numerical algorithms", 2nd edition, SIAM, 2002, section 1.14.1. Polynomials are Taylor's.

Tests compare each function with 40 digits. The largest differences, in units in the last place, are 1 for
`exp` and `log`; 1.5 for `log1p`, and for `sin` and `cos` between -10 and 10; 2 for `arctangent`; and 3 for
`expm1`. `tanh` differs by less than 1e-12 of itself.
"""

import math
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.compiler.jit import entry, kernel

if TYPE_CHECKING:
    import torch

Floats = NDArray[np.float64]

_EXP, _LOG, _LOG1P, _EXPM1, _TANH, _SIN, _COS = range(7)

# ln 2 and pi / 2 in two parts. The first part has 32 bits, so that its product with a whole number below 2^20
# is exact; the second is the rest.
_LN2_FIRST, _LN2_REST = 0.6931471803691238, 1.9082149292705877e-10
_QUARTER_FIRST, _QUARTER_REST = 1.5707963267341256, 6.077100506506192e-11
_LARGEST_EXPONENT, _LEAST_EXPONENT = 709.782712893384, -745.1332191019411
_SQUARE_ROOT_OF_HALF = math.sqrt(0.5)
_NUM_TERMS = 13
_EXP_TERMS = np.array([1.0 / math.factorial(k) for k in range(_NUM_TERMS + 1, 1, -1)])
_LEAST_TANH = 1e-3  # below it, two terms of the series are more precise
# Of the series in x^2 of sin(x) / x and cos(x), without their first terms, the last first.
_SINE_TERMS = np.array([(-1.0) ** k / math.factorial(2 * k + 1) for k in range(9, 0, -1)])
_COSINE_TERMS = np.array([(-1.0) ** k / math.factorial(2 * k) for k in range(9, 0, -1)])
# Arc tangents of 0, 1/8, ..., 1, from which an arc tangent differs by the arc tangent of at most 1/16.
_NUM_ARCS = 8
_ARCS = np.array(
    [
        *(0.0, 0.12435499454676144, 0.24497866312686414, 0.35877067027057225, 0.4636476090008061),
        *(0.5585993153435624, 0.6435011087932844, 0.7188299996216245, 0.7853981633974483),
    ]
)
_ARC_TERMS = np.array([1.0 / (2 * k + 1) for k in range(7, 0, -1)])


@kernel
def exponential(x: float) -> float:
    """Return e^x."""
    if not x <= _LARGEST_EXPONENT:  # or x is not a number
        return x * math.inf if x > 0.0 else x
    if x < _LEAST_EXPONENT:
        return 0.0
    count = math.floor(x / math.log(2.0) + 0.5)
    r = (x - count * _LN2_FIRST) - count * _LN2_REST
    tail = 0.0
    for k in range(_NUM_TERMS):
        tail = _EXP_TERMS[k] + r * tail
    return math.ldexp(1.0 + (r + r * r * tail), int(count))


@kernel
def logarithm(x: float) -> float:
    """Return the natural logarithm; -inf of 0, and NaN of negative numbers."""
    if not x > 0.0:
        return -math.inf if x == 0.0 else math.nan
    if x == math.inf:
        return x
    part, exponent = math.frexp(x)
    if part < _SQUARE_ROOT_OF_HALF:
        part, exponent = 2.0 * part, exponent - 1
    f = part - 1.0
    s = f / (2.0 + f)
    square, tail = s * s, 0.0
    for k in range(25, 1, -2):  # 2 artanh(s) = 2 s + s * tail
        tail = square * (2.0 / k + tail)
    half = 0.5 * f * f
    return exponent * _LN2_FIRST - ((half - (s * (half + tail) + exponent * _LN2_REST)) - f)


@kernel
def logarithm_of_one_and(x: float) -> float:
    """Return log(1 + x); -inf of -1, and NaN below it."""
    whole = 1.0 + x
    if whole == 1.0 or not 0.0 < whole < math.inf:
        return x if whole == 1.0 or x == math.inf else logarithm(whole)
    return logarithm(whole) - ((whole - 1.0) - x) / whole


@kernel
def exponential_less_one(x: float) -> float:
    """Return e^x - 1."""
    power = exponential(x)
    if power == 1.0 or not power < math.inf:
        return x if power == 1.0 else power
    return -1.0 if power <= 2.0**-60 else (power - 1.0) * x / logarithm(power)


@kernel
def hyperbolic_tangent(x: float) -> float:
    """Return the hyperbolic tangent."""
    size = abs(x)
    if size < _LEAST_TANH:
        return x - x * x * x / 3.0
    power = exponential(-2.0 * size)
    found = (1.0 - power) / (1.0 + power)
    return -found if x < 0.0 else found


@kernel
def sine_of_quarters(x: float, quarters: int) -> float:
    """Return the sine of x plus so many quarters of a turn, for |x| below 10^6."""
    count = math.floor(x / (0.5 * math.pi) + 0.5)
    r = (x - count * _QUARTER_FIRST) - count * _QUARTER_REST
    square, tail, quarter = r * r, 0.0, (int(count) + quarters) & 3
    if quarter & 1:
        for k in range(18, 1, -2):
            tail = -(1.0 + tail) * square / (k * (k - 1))
        found = 1.0 + tail
    else:
        for k in range(19, 2, -2):
            tail = -(1.0 + tail) * square / (k * (k - 1))
        found = r + r * tail
    return -found if quarter & 2 else found


@kernel(borrows=True)
def sine_and_cosine(x: float) -> tuple[float, float]:
    """Return both of an angle below 10^6 in size, in a third of the time of two `sine_of_quarters`."""
    count = math.floor(x / (0.5 * math.pi) + 0.5)
    r = (x - count * _QUARTER_FIRST) - count * _QUARTER_REST
    square, sine, cosine = r * r, 0.0, 0.0
    for k in range(_SINE_TERMS.shape[0]):
        sine = (sine + _SINE_TERMS[k]) * square
        cosine = (cosine + _COSINE_TERMS[k]) * square
    sine, cosine, quarter = r + r * sine, 1.0 + cosine, int(count) & 3
    if quarter & 1:
        sine, cosine = cosine, -sine
    return (-sine, -cosine) if quarter & 2 else (sine, cosine)


@kernel
def arctangent(y: float, x: float) -> float:
    """Return the angle of (x, y) from the x axis, in radians from -pi to pi; 0 of the origin."""
    rise, run = abs(y), abs(x)
    if rise == 0.0 and run == 0.0:
        return 0.0
    steep = rise > run
    tangent = run / rise if steep else rise / run
    nearest = math.floor(tangent * _NUM_ARCS + 0.5)
    whole = nearest / _NUM_ARCS
    rest = (tangent - whole) / (1.0 + tangent * whole)
    square, tail = rest * rest, 0.0
    for k in range(_ARC_TERMS.shape[0]):
        tail = square * (_ARC_TERMS[k] - tail)
    angle = _ARCS[int(nearest)] + (rest - rest * tail)
    if steep:
        angle = 0.5 * math.pi - angle
    if x < 0.0:
        angle = math.pi - angle
    return -angle if y < 0.0 else angle


@entry
def _each(function: int, values: Floats, out: Floats) -> None:
    """Write a function of each number; one entry for all, so that one is compiled."""
    for i in range(values.shape[0]):
        x = values[i]
        if function == _EXP:
            out[i] = exponential(x)
        elif function == _LOG:
            out[i] = logarithm(x)
        elif function == _LOG1P:
            out[i] = logarithm_of_one_and(x)
        elif function == _EXPM1:
            out[i] = exponential_less_one(x)
        elif function == _TANH:
            out[i] = hyperbolic_tangent(x)
        else:
            out[i] = sine_of_quarters(x, 0 if function == _SIN else 1)


def _of_each(function: int, values: ArrayLike) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float64)
    out = np.empty(array.size)
    _each(function, array.reshape(-1), out)
    return out.reshape(np.shape(values))


# The first three also take tensors, with the namespace `xp` of their library, whose function they call then.


def exp(values: "ArrayLike | torch.Tensor", xp: ModuleType = np) -> Floats:
    """Return e^x of each number, in float64."""
    return _of_each(_EXP, values) if xp is np else xp.exp(values)


def log(values: "ArrayLike | torch.Tensor", xp: ModuleType = np) -> Floats:
    """Return the natural logarithm of each number, in float64, without warnings."""
    return _of_each(_LOG, values) if xp is np else xp.log(values)


def log1p(values: "ArrayLike | torch.Tensor", xp: ModuleType = np) -> Floats:
    """Return log(1 + x) of each number, in float64."""
    return _of_each(_LOG1P, values) if xp is np else xp.log1p(values)


def expm1(values: ArrayLike) -> Floats:
    """Return e^x - 1 of each number, in float64."""
    return _of_each(_EXPM1, values)


def tanh(values: ArrayLike) -> Floats:
    """Return the hyperbolic tangent of each number, in float64."""
    return _of_each(_TANH, values)


def sin(values: ArrayLike) -> Floats:
    """Return the sine of each angle, in radians below 10^6."""
    return _of_each(_SIN, values)


def cos(values: ArrayLike) -> Floats:
    """Return the cosine of each angle, in radians below 10^6."""
    return _of_each(_COS, values)


def power(bases: ArrayLike, exponents: ArrayLike) -> Floats:
    """Return base^exponent of numbers that are not negative, in float64; anything to the power 0 is 1."""
    with np.errstate(invalid="ignore"):  # 0 times the logarithm of 0
        found = exp(np.multiply(exponents, log(bases)))
    return np.where(np.equal(exponents, 0.0), 1.0, found)


def interpolate(places: ArrayLike, knots: ArrayLike, values: Floats) -> Floats:
    """Return values, (n,), linearly interpolated between knots that increase; constant beyond the outer ones.

    It is NumPy's `interp` but for the last digit, for which that may use fused operations.

    Args:
        places: (n,) where.
        knots: (k,) places of the values.
        values: (k,) values at the knots.
    """
    at, ends = np.asarray(places, dtype=np.float64), np.asarray(knots, dtype=np.float64)
    before = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, max(len(ends) - 2, 0))
    after = np.minimum(before + 1, len(ends) - 1)
    widths = ends[after] - ends[before]
    shares = (np.clip(at, ends[0], ends[-1]) - ends[before]) / np.where(widths > 0.0, widths, 1.0)
    return values[before] + shares * (values[after] - values[before])


def product(first: Floats, second: Floats) -> Floats:
    """Return the product of two matrices, or of a matrix and a vector; sums go from the first column on.

    NumPy's own product leaves the order of sums to a library that chooses it by the processor.
    """
    found = np.zeros(first.shape[:-1] + second.shape[1:])
    for k in range(first.shape[-1]):
        found += first[..., k][(..., *(None,) * (second.ndim - 1))] * second[k]
    return found
