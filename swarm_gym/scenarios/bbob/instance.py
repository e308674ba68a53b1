"""Instances of the BBOB functions: the optimum, its value, rotations and peaks, from three numbers.

Symbols are as in N. Hansen, S. Finck, R. Ros, A. Auger, "Real-parameter black-box optimization
benchmarking 2009: noiseless functions definitions", INRIA RR-6829, 2009. How instances are seeded is not in
there; it follows the programs of the authors, so that an instance is the same as in their suite `bbob`.
"""

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import power, product
from swarm_gym.scenarios.bbob.random_numbers import normal_numbers, rotation, uniform_numbers

Floats = NDArray[np.float64]

# Names of the functions in order, as IOHprofiler writes them.
FUNCTION_NAMES = (
    "Sphere", "Ellipsoid", "Rastrigin", "BuecheRastrigin", "LinearSlope", "AttractiveSector",
    "StepEllipsoid", "Rosenbrock", "RosenbrockRotated", "EllipsoidRotated", "Discus", "BentCigar",
    "SharpRidge", "DifferentPowers", "RastriginRotated", "Weierstrass", "Schaffers10", "Schaffers1000",
    "GriewankRosenbrock", "Schwefel", "Gallagher101", "Gallagher21", "Katsuura", "LunacekBiRastrigin",
)  # fmt: skip
REACH = 5.0

(
    SPHERE, ELLIPSOID, RASTRIGIN, SKEW_RASTRIGIN, LINEAR_SLOPE, ATTRACTIVE_SECTOR, STEP_ELLIPSOID, ROSENBROCK,
    ROTATED_ROSENBROCK, ROTATED_ELLIPSOID, DISCUS, BENT_CIGAR, SHARP_RIDGE, DIFFERENT_POWERS,
    ROTATED_RASTRIGIN, WEIERSTRASS, SCHAFFERS, SKEW_SCHAFFERS, GRIEWANK_ROSENBROCK, SCHWEFEL, GALLAGHER_101,
    GALLAGHER_21, KATSUURA, LUNACEK,
) = range(1, 25)  # fmt: skip
# Forms of functions beside these: functions 3 and 4 of a rotated vector, which MetaBox has.
TURNED_RASTRIGIN, TURNED_SKEW_RASTRIGIN = 25, 26

# Functions that are seeded like the one that they are a variant of.
SEEDED_LIKE = {SKEW_RASTRIGIN: RASTRIGIN, SKEW_SCHAFFERS: SCHAFFERS}
SEEDS_OF_A_FUNCTION = 10_000
# One rotation has the seed of the instance, the other has this added; functions where R is the first of them.
SEED_OF_ROTATION = 1_000_000
PLAIN_FIRST_ROTATION = {
    ATTRACTIVE_SECTOR, STEP_ELLIPSOID, ROTATED_ROSENBROCK, SHARP_RIDGE, GRIEWANK_ROSENBROCK, GALLAGHER_101,
    GALLAGHER_21, KATSUURA, LUNACEK,
}  # fmt: skip
LARGEST_VALUE = 1000.0
# Twice the components of x_opt: of Schwefel's function, whose printed value ends in 33 (the authors' programs
# have 37), and mu_0 of Lunacek's.
SCHWEFEL_PLACE = 4.2096874637
LUNACEK_PLACE = 2.5


class Peaks(NamedTuple):
    """The local optima of a function of Gallagher (f21, f22); the first one is the global optimum.

    Attributes:
        places: (peaks, dimension) y_i.
        conditions: (peaks, dimension) diagonals of C_i.
        heights: (peaks,) w_i, from 1.1 to 9.1, the first one 10.
    """

    places: Floats
    conditions: Floats
    heights: Floats


class Instance:
    """An instance of a BBOB function.

    Args:
        function: number of the function, 1 to 24.
        dimension: D, at least 2.
        number: number of the instance, at least 1.

    Attributes:
        function: number of the function.
        dimension: D.
    """

    def __init__(self, function: int, dimension: int, number: int):
        self.function, self.dimension = function, dimension
        self._seed = SEEDED_LIKE.get(function, function) + SEEDS_OF_A_FUNCTION * number

    @cached_property
    def least_value(self) -> float:
        """f_opt: a Cauchy variate with two digits behind the point, within [-1000, 1000]."""
        above, below = normal_numbers(1, self._seed)[0], normal_numbers(1, self._seed + 1)[0]
        value = math.floor(1e4 * above / below + 0.5) / 100.0
        return float(min(LARGEST_VALUE, max(-LARGEST_VALUE, value)))

    @cached_property
    def first_rotation(self) -> Floats:
        """R, (D, D), by which x - x_opt is multiplied first."""
        plain = self.function in PLAIN_FIRST_ROTATION
        return rotation(self.dimension, self._seed + (0 if plain else SEED_OF_ROTATION))

    @cached_property
    def second_rotation(self) -> Floats:
        """Q, (D, D)."""
        plain = self.function not in PLAIN_FIRST_ROTATION
        return rotation(self.dimension, self._seed + (0 if plain else SEED_OF_ROTATION))

    @cached_property
    def optimum(self) -> Floats:
        """x_opt, (D,), of which some functions use only the signs."""
        drawn, function = self._drawn_optimum(), self.function
        if function == SKEW_RASTRIGIN:
            drawn[::2] = np.abs(drawn[::2])
        elif function == LINEAR_SLOPE:
            drawn = np.where(drawn < 0.0, -REACH, REACH)
        elif function == ROSENBROCK:
            drawn *= 0.75
        elif function in (ROTATED_ROSENBROCK, GRIEWANK_ROSENBROCK):
            # Where the rotated and scaled vector plus 1/2 is 1 in all components.
            drawn = product(self.first_rotation.T, np.full(self.dimension, 0.5)) / self.scale
        elif function == SCHWEFEL:
            signs = np.where(uniform_numbers(self.dimension, self._seed) < 0.5, -1.0, 1.0)
            drawn = signs * SCHWEFEL_PLACE / 2.0
        elif function in (GALLAGHER_101, GALLAGHER_21):
            drawn = self.peaks.places[0].copy()
        elif function == LUNACEK:
            signs = np.where(normal_numbers(self.dimension, self._seed) < 0.0, -1.0, 1.0)
            drawn = signs * LUNACEK_PLACE / 2.0
        return drawn

    @property
    def scale(self) -> float:
        """The factor max(1, sqrt(D) / 8) of the functions with a Rosenbrock valley."""
        return max(1.0, math.sqrt(self.dimension) / 8.0)

    @cached_property
    def peaks(self) -> Peaks:
        """The local optima of Gallagher's functions."""
        many = self.function == GALLAGHER_101
        count, reach, first = (101, 5.0, math.sqrt(1000.0)) if many else (21, 4.9, 1000.0)
        order = np.argsort(uniform_numbers(count - 1, self._seed), kind="stable")
        # Square roots of alpha_i: C_i has powers of alpha_i from -1/4 to 1/4.
        roots = np.append(first, power(1000.0, order / (count - 2)))
        conditions = np.empty((count, self.dimension))
        for k, root in enumerate(roots):
            ranks = np.argsort(uniform_numbers(self.dimension, self._seed + 1000 * k), kind="stable")
            conditions[k] = power(root, ranks / (self.dimension - 1) - 0.5)
        drawn = uniform_numbers(count * self.dimension, self._seed).reshape(count, self.dimension)
        places = reach * (2.0 * drawn - 1.0)
        places[0] *= 0.8
        heights = np.append(10.0, 1.1 + 8.0 * np.arange(count - 1) / (count - 2))
        return Peaks(places, conditions, heights)

    def _drawn_optimum(self) -> Floats:
        """Return (D,) numbers from [-4, 4] with four digits behind the point, none of them 0."""
        seed = self._seed + (SEED_OF_ROTATION if self.function == BENT_CIGAR else 0)
        drawn = 8.0 * np.floor(1e4 * uniform_numbers(self.dimension, seed)) / 1e4 - 4.0
        drawn[drawn == 0.0] = -1e-5
        return drawn
