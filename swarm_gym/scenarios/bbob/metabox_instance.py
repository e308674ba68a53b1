"""Instances of the BBOB functions as MetaBox draws them: all 24 from one seed, one after the other.

Source: the program MetaBox of Z. Ma et al., "MetaBox-v2: a unified benchmark platform for
meta-black-box optimization", NeurIPS 2025, repository MetaEvo/MetaBox, commit 5565a28, whose data set has the
seed 3849. Only facts are taken from there: what is drawn, and in which order. Every function draws from where
the one before it stopped: x_opt, then R, then f_opt, then what it needs itself.

MetaBox draws f_opt only where its data set is biased. So biased functions have other optima and rotations
than those that are not, from function 2 on.

The generator is NumPy's `RandomState`, whose numbers never change. Its normal numbers contain a logarithm of
the C library, which depends on the processor; here they contain the logarithm of `compiler.elementary`. So
optima and least values equal MetaBox's bit for bit, and entries of rotations differ by less than 1e-14.
"""

import math
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from swarm_gym.compiler.elementary import log, power, product
from swarm_gym.scenarios.bbob.instance import (
    ATTRACTIVE_SECTOR,
    FUNCTION_NAMES,
    GALLAGHER_21,
    GALLAGHER_101,
    GRIEWANK_ROSENBROCK,
    KATSUURA,
    LINEAR_SLOPE,
    LUNACEK,
    LUNACEK_PLACE,
    REACH,
    ROSENBROCK,
    ROTATED_RASTRIGIN,
    ROTATED_ROSENBROCK,
    SCHAFFERS,
    SCHWEFEL,
    SHARP_RIDGE,
    SKEW_RASTRIGIN,
    SKEW_SCHAFFERS,
    STEP_ELLIPSOID,
    WEIERSTRASS,
    Floats,
    Instance,
    Peaks,
)

# The seed of MetaBox's own data set.
SEED = 3849
# Functions that draw a second rotation.
TWICE_ROTATED = {
    ATTRACTIVE_SECTOR, STEP_ELLIPSOID, SHARP_RIDGE, ROTATED_RASTRIGIN, WEIERSTRASS, SCHAFFERS, SKEW_SCHAFFERS,
    KATSUURA, LUNACEK,
}  # fmt: skip
# Twice the components of x_opt of Schwefel's function, as RR-6829 prints it.
SCHWEFEL_PLACE = 4.2096874633
# Share of the domain in which x_opt is drawn; f_opt is one of 100, 200, ..., 2500.
SHARE = 0.8
LEAST_VALUES = range(1, 26)


class DrawnNumbers(NamedTuple):
    """Numbers that a function draws.

    Attributes:
        optimum: (D,) x_opt.
        least_value: f_opt.
        first: (D, D) R.
        second: (D, D) Q, or an empty matrix.
        peaks: the peaks of Gallagher's functions; without a peak for others.
    """

    optimum: Floats
    least_value: float
    first: Floats
    second: Floats
    peaks: Peaks


class MetaBoxInstance(Instance):
    """An instance of a BBOB function as MetaBox draws it.

    Args:
        function: number of the function, 1 to 24.
        dimension: D, at least 2.
        number: the seed, at least 1.
        biased: whether f_opt is drawn; else it is 0.
    """

    def __init__(self, function: int, dimension: int, number: int = SEED, biased: bool = False):
        super().__init__(function, dimension, number)
        self._drawn = draw_all(dimension, number, biased)[function - 1]

    @cached_property
    def least_value(self) -> float:
        """f_opt: 100, 200, ..., or 2500; 0 for functions that are not biased."""
        return self._drawn.least_value

    @cached_property
    def first_rotation(self) -> Floats:
        """R, (D, D), by which x - x_opt is multiplied first."""
        return self._drawn.first

    @cached_property
    def second_rotation(self) -> Floats:
        """Q, (D, D); empty for functions without it."""
        return self._drawn.second

    @cached_property
    def optimum(self) -> Floats:
        """x_opt, (D,), of which some functions use only the signs."""
        return self._drawn.optimum

    @cached_property
    def peaks(self) -> Peaks:
        """The local optima of Gallagher's functions."""
        return self._drawn.peaks


@lru_cache(maxsize=16)
def draw_all(dimension: int, seed: int, biased: bool) -> tuple[DrawnNumbers, ...]:
    """Return what the 24 functions draw."""
    numbers = RandomNumbers(seed)
    return tuple(_draw(function + 1, dimension, numbers, biased) for function in range(len(FUNCTION_NAMES)))


def _draw(function: int, dimension: int, numbers: "RandomNumbers", biased: bool) -> DrawnNumbers:
    optimum = SHARE * (numbers.uniform(dimension) * (2.0 * REACH) - REACH)
    first, second = numbers.rotation(dimension), np.zeros((0, 0))
    least_value = 100.0 * numbers.whole(LEAST_VALUES[0], LEAST_VALUES[-1] + 1) if biased else 0.0
    peaks = Peaks(np.zeros((0, 0)), np.zeros((0, 0)), np.zeros(0))
    if function == SKEW_RASTRIGIN:
        optimum[::2] = np.abs(optimum[::2])
    elif function == LINEAR_SLOPE:
        optimum = REACH * np.sign(optimum)
    elif function == ROSENBROCK:
        optimum *= 0.75
    elif function in (ROTATED_ROSENBROCK, GRIEWANK_ROSENBROCK):
        scale = max(1.0, math.sqrt(dimension) / 8.0)
        optimum = product(first.T, np.full(dimension, 0.5)) / scale
    elif function == SCHWEFEL:
        optimum = 0.5 * SCHWEFEL_PLACE * numbers.signs(dimension)
    elif function in (GALLAGHER_101, GALLAGHER_21):
        peaks = numbers.peaks(function == GALLAGHER_101, optimum)
        optimum = peaks.places[0].copy()
    elif function == LUNACEK:
        optimum = 0.5 * LUNACEK_PLACE * numbers.signs(dimension)
    if function in TWICE_ROTATED:
        second = numbers.rotation(dimension)
    return DrawnNumbers(optimum, least_value, first, second, peaks)


class RandomNumbers:
    """The random numbers of MetaBox in the order in which it draws them.

    Args:
        seed: the seed, at least 1.
    """

    def __init__(self, seed: int):
        self._state = np.random.RandomState(seed)
        self._spare: list[float] = []  # normal numbers come in pairs; the second one waits here

    def uniform(self, *shape: int) -> Floats:
        """Return an array of numbers in [0, 1)."""
        return self._state.random_sample(shape)

    def whole(self, low: int, high: int) -> int:
        """Return a whole number from low to high - 1."""
        return int(self._state.randint(low, high, dtype=np.int64))

    def signs(self, count: int) -> Floats:
        """Return (count,) numbers, -1 or 1 each."""
        return np.where(self._state.randint(0, 2, count, dtype=np.int64) == 1, 1.0, -1.0)

    def normal(self, count: int) -> Floats:
        """Return (count,) numbers of the standard normal distribution, by the polar method of Marsaglia."""
        pairs = []
        for _ in range((count - len(self._spare) + 1) // 2):
            square = 0.0
            while not 0.0 < square < 1.0:
                point = 2.0 * self._state.random_sample(2) - 1.0
                square = float(point[0] * point[0] + point[1] * point[1])
            pairs.append((point[1], point[0], square))
        second, first, squares = np.array(pairs, dtype=np.float64).reshape(-1, 3).T
        factors = np.sqrt(-2.0 * log(squares) / squares)
        drawn = [*self._spare, *np.stack([factors * second, factors * first], axis=1).ravel()]
        self._spare = drawn[count:]
        return np.array(drawn[:count])

    def rotation(self, dimension: int) -> Floats:
        """Return a random rotation, (D, D): a product of D - 1 reflections, whose rows get signs."""
        found, signs = np.eye(dimension), np.ones(dimension)
        for k in range(dimension - 1):
            x = self.normal(dimension - k)
            signs[k] = np.sign(x[0])
            x[0] -= signs[k] * math.sqrt(product(x, x))
            found[:, k:] -= 2.0 / product(x, x) * (product(found[:, k:], x)[:, None] * x)
        signs[-1] = signs.prod() if dimension % 2 else -signs.prod()
        return signs[:, None] * found

    def peaks(self, many: bool, optimum: Floats) -> Peaks:
        """Return the peaks of Gallagher's functions, 101 or 21; the first one lies at the optimum, shrunk."""
        count, shrink, first = (101, 1.0, math.sqrt(1000.0)) if many else (21, 0.98, 1000.0)
        size = len(optimum)
        places = shrink * (self.uniform(count, size) * (2.0 * REACH) - REACH)
        places[0] = shrink * optimum
        # Square roots of alpha_i: C_i has powers of alpha_i from -1/4 to 1/4.
        roots = np.append(first, power(1000.0, self._state.permutation(np.arange(count - 1)) / (count - 2)))
        ranks = np.array([self._state.permutation(np.arange(size)) for _ in roots])
        conditions = power(roots[:, None], ranks / (size - 1) - 0.5)
        heights = np.append(10.0, np.linspace(1.1, 9.1, count - 1))
        return Peaks(places, conditions, heights)
