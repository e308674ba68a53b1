"""Elementary functions that do not depend on the processor: precise, defined at the ends, like each other."""

import math
from decimal import Context, Decimal, localcontext

import numpy as np
import pytest

from helpers.compiled import compiled
from helpers.loops import looped
from swarm_gym.compiler import elementary

DIGITS = 45
TWO_PI = Decimal("6.283185307179586476925286766559005768394338798750211641949889")


def cosine(x):
    """Return the cosine of a Decimal by its Taylor series."""
    x = x % TWO_PI
    found, term, k = Decimal(0), Decimal(1), 0
    while abs(term) > Decimal(10) ** -DIGITS:
        found, k = found + term, k + 2
        term *= -x * x / (k * (k - 1))
    return found


def hyperbolic_tangent(x):
    power = (2 * x).exp()
    return (power - 1) / (power + 1)


def spread(low, high, count=400, *, signed=False):
    """Return numbers whose logarithms are uniform."""
    generator = np.random.default_rng(5)
    found = np.exp(generator.uniform(math.log(low), math.log(high), count))
    return found * generator.choice([-1.0, 1.0], count) if signed else found


ANGLES = np.random.default_rng(2).uniform(-10.0, 10.0, 300)
CASES = {
    "exp": (lambda x: x.exp(), [*spread(1e-9, 700.0, signed=True), 0.5, -0.5], 1.0),
    "log": (lambda x: x.ln(), [*spread(1e-300, 1e300), *spread(0.5, 2.0)], 1.0),
    "log1p": (lambda x: (1 + x).ln(), [*spread(1e-20, 1e20), *-spread(1e-12, 0.99)], 1.5),
    "expm1": (lambda x: x.exp() - 1, spread(1e-20, 30.0, signed=True), 3.0),
    "cos": (cosine, ANGLES, 1.5),
    "sin": (lambda x: cosine(x - TWO_PI / 4), ANGLES, 1.5),
}


@pytest.mark.parametrize("name", CASES)
def test_a_function_is_precise_to_units_in_the_last_place(name):
    exact, values, units = CASES[name]
    found = getattr(elementary, name)(values)
    with localcontext(Context(prec=DIGITS + 10)):
        for x, y in zip(values, found.tolist(), strict=True):
            true = exact(Decimal(float(x)))
            assert abs(Decimal(y) - true) <= Decimal(units * math.ulp(float(true))), x


def test_the_hyperbolic_tangent_is_precise_to_twelve_digits_and_odd():
    values = spread(1e-12, 30.0)
    found = elementary.tanh(values)
    with localcontext(Context(prec=DIGITS)):
        true = [hyperbolic_tangent(Decimal(x)) for x in values.tolist()]
    np.testing.assert_allclose(found, [float(x) for x in true], rtol=1e-12)
    np.testing.assert_array_equal(elementary.tanh(-values), -found)


def arc_tangent(tangent):
    """Return the arc tangent of a Decimal by Euler's series."""
    if abs(tangent) > 1:
        return TWO_PI / (4 if tangent > 0 else -4) - arc_tangent(1 / tangent)
    square = tangent * tangent
    found, term, k = Decimal(0), tangent / (1 + square), 1
    while abs(term) > Decimal(10) ** -DIGITS:
        found += term
        term, k = term * (2 * k * square) / ((2 * k + 1) * (1 + square)), k + 1
    return found


def test_the_arc_tangent_knows_all_quadrants_to_units_in_the_last_place():
    places = np.random.default_rng(4).normal(size=(300, 2)) * spread(1e-3, 1e3, 600).reshape(300, 2)
    with localcontext(Context(prec=DIGITS + 10)):
        for y, x in [*places.tolist(), (1.0, 1.0), (-3.0, 3.0), (1e-9, 1.0), (2.0, 1e-9)]:
            true = arc_tangent(Decimal(y) / Decimal(x))
            if x < 0:
                true += TWO_PI / (2 if y >= 0 else -2)
            found = compiled(elementary.arctangent)(y, x)
            assert abs(Decimal(found) - true) <= Decimal(2.0 * math.ulp(float(true))), (y, x)
    ends = [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 0.0)]
    assert [elementary.arctangent(*end) for end in ends] == [math.atan2(*end) for end in ends]


def test_sine_and_cosine_together_are_precise_to_units_in_the_last_place():
    both = compiled(elementary.sine_and_cosine)
    with localcontext(Context(prec=DIGITS + 10)):
        for angle in ANGLES.tolist():
            exact = Decimal(angle)
            for true, found in zip((cosine(exact - TWO_PI / 4), cosine(exact)), both(angle), strict=True):
                assert abs(Decimal(found) - true) <= Decimal(1.5 * math.ulp(float(true))), angle


@looped(
    ("name", "x", "expected"),
    [
        ("exp", -math.inf, 0.0), ("exp", -800.0, 0.0), ("exp", 0.0, 1.0), ("exp", 800.0, math.inf),
        ("exp", math.nan, math.nan), ("log", 0.0, -math.inf), ("log", -1.0, math.nan), ("log", 1.0, 0.0),
        ("log", math.inf, math.inf), ("log", 5e-324, math.log(5e-324)), ("log", math.nan, math.nan),
        ("log1p", -1.0, -math.inf), ("log1p", -2.0, math.nan), ("log1p", 0.0, 0.0),
        ("log1p", math.inf, math.inf), ("log1p", math.nan, math.nan), ("expm1", -800.0, -1.0),
        ("expm1", 0.0, 0.0), ("expm1", math.inf, math.inf), ("expm1", math.nan, math.nan),
        ("tanh", math.inf, 1.0), ("tanh", -math.inf, -1.0), ("tanh", 0.0, 0.0), ("tanh", math.nan, math.nan),
        ("sin", 0.0, 0.0), ("cos", 0.0, 1.0),
    ],
)  # fmt: skip
def test_a_function_is_defined_everywhere(name, x, expected):
    np.testing.assert_array_equal(getattr(elementary, name)(x), expected)


def test_results_have_the_shape_of_their_argument():
    values = np.arange(1.0, 13.0).reshape(3, 4)
    assert elementary.log(values.T).shape == (4, 3)
    np.testing.assert_array_equal(elementary.log(values.T), elementary.log(values).T)
    assert elementary.exp(1.0).shape == ()
    assert elementary.tanh(np.float32([0.5, 1.0])).dtype == np.float64


def test_tensors_get_the_function_of_their_library():
    calls = []

    class Library:
        def log(self, values):
            calls.append(values)
            return "found"

    assert elementary.log("values", Library()) == "found"
    assert calls == ["values"]


def test_powers_are_those_of_numpy():
    bases, exponents = spread(1e-3, 1e3), np.random.default_rng(0).uniform(-3.0, 3.0, 400)
    np.testing.assert_allclose(elementary.power(bases, exponents), bases**exponents, rtol=1e-13)
    np.testing.assert_array_equal(elementary.power([0.0, 0.0, math.nan], [2.0, 0.0, 0.0]), [0.0, 1.0, 1.0])


def test_products_of_matrices_are_those_of_numpy():
    generator = np.random.default_rng(1)
    first, second = generator.normal(size=(4, 6)), generator.normal(size=(6, 3))
    np.testing.assert_allclose(elementary.product(first, second), first @ second, rtol=1e-13)
    np.testing.assert_allclose(elementary.product(first, second[:, 0]), first @ second[:, 0], rtol=1e-13)
    np.testing.assert_allclose(elementary.product(first[0], first[0]), first[0] @ first[0], rtol=1e-13)


def test_interpolation_is_that_of_numpy():
    knots, values = [0.0, 2.0, 5.0], np.array([1.0, 5.0, -1.0])
    places = np.linspace(-1.0, 7.0, 33)
    found = elementary.interpolate(places, knots, values)
    np.testing.assert_allclose(found, np.interp(places, knots, values), rtol=1e-14)
    assert elementary.interpolate([0, 2, 5], knots, values).tolist() == values.tolist()
    assert elementary.interpolate([0, 3], [1], np.array([4.0])).tolist() == [4.0, 4.0]
    assert elementary.interpolate([1.0], [0.0, 1.0, 1.0, 2.0], np.array([0.0, 1.0, 1.0, 3.0])).tolist() == [
        1.0
    ]
