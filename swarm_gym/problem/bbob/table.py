"""The problem table of BBOB functions, see `tables`; `scenarios.bbob` draws what is in it."""

from typing import Generic, NamedTuple

import numpy as np

from swarm_gym.compiler.elementary import power, product
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.problem.bbob import conditioned, multimodal, separable
from swarm_gym.problem.bbob.transformations import subtract, transform
from swarm_gym.problem.padding import Floats, Integers, Real, Whole, pad
from swarm_gym.scenarios.bbob.scenario import BbobScenario


class BbobTable(NamedTuple, Generic[Whole, Real]):
    """The problem table of a BBOB function; in a stacked table every field has a leading problem axis.

    Matrices and peaks that a function does not have are empty.
    """

    dimension: Whole  # D
    function: Whole  # number of the formula: 1 to 24, or 25 and 26, functions 3 and 4 of a rotated vector
    lower: Floats  # (C,) bounds of decision vectors: the domain
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population: the domain
    initial_upper: Floats  # (C,)
    optimum: Floats  # (C,) x_opt
    scale: Real  # max(1, sqrt(D) / 8)
    weights: Floats  # (C,) what the function multiplies components or squares with, or its exponents
    inner: Floats  # (D, D) the matrix that x - x_opt is multiplied by, transposed
    outer: Floats  # (D, D) the matrix of the second transformation, transposed
    places: Floats  # (peaks, D) R (y_i - x_opt) of Gallagher's functions
    conditions: Floats  # (peaks, D) diagonals of C_i
    heights: Floats  # (peaks,) w_i


BbobTables = BbobTable[Integers, Floats]  # of stacked problems


def tabulate(scenario: BbobScenario) -> BbobTable:
    """Return the problem table of a scenario."""
    low, high = (pad(np.full(scenario.dimension, bound)) for bound in scenario.domain)
    drawn, number = scenario.drawn, scenario.form
    places, conditions, heights = np.zeros((0, 0)), np.zeros((0, 0)), np.zeros(0)
    if number in (21, 22):
        places, conditions, heights = drawn.peaks
        places = product(places - places[0], drawn.first_rotation.T)
    inner, outer = _matrices(scenario)
    return BbobTable(
        scenario.dimension,
        number,
        low,
        high,
        low,
        high,
        pad(np.array(scenario.optimum)),
        drawn.scale,
        pad(_weights(scenario)),
        np.ascontiguousarray(inner.T),
        np.ascontiguousarray(outer.T),
        places,
        conditions,
        heights,
    )


def _matrices(scenario: BbobScenario) -> tuple[Floats, Floats]:
    """Return the matrices of both transformations, (D, D), or empty ones."""
    drawn, number, dimension = scenario.drawn, scenario.form, scenario.dimension
    inner = outer = np.zeros((0, 0))
    if number not in (1, 2, 3, 4, 5, 8, 20):
        inner = drawn.first_rotation
    if number in (6, 13):
        inner = product(drawn.second_rotation * _powers(dimension, 10.0), inner)
    elif number == 7:
        inner, outer = _powers(dimension, 10.0)[:, None] * inner, drawn.second_rotation
    elif number == 12:
        outer = inner
    elif number == 15:
        outer = product(inner * _powers(dimension, 10.0), drawn.second_rotation)
    elif number == 16:
        outer = product(inner * _powers(dimension, 0.01), drawn.second_rotation)
    elif number in (17, 18):
        outer = _powers(dimension, 10.0 if number == 17 else 1000.0)[:, None] * drawn.second_rotation
    elif number in (23, 24):
        inner = product(drawn.second_rotation * _powers(dimension, 100.0), inner)
    return inner, outer


def _weights(scenario: BbobScenario) -> Floats:
    """Return (D,) the weights, or exponents, of a function; zeros where it has none."""
    dimension, number = scenario.dimension, scenario.form
    if number in (2, 10):
        return _powers(dimension, 1e12)
    if number in (3, 4, 20, 25, 26):
        return _powers(dimension, 10.0)
    if number == 5:
        return np.copysign(_powers(dimension, 100.0), scenario.optimum)
    if number == 7:
        return _powers(dimension, 1e4)
    if number == 14:
        return 2.0 + 4.0 * np.arange(dimension) / (dimension - 1)
    return np.zeros(dimension)


def _powers(dimension: int, alpha: float) -> Floats:
    """Return (D,) the diagonal of Lambda^alpha: alpha^(k / (D - 1) / 2) for k = 0 ... D - 1."""
    return power(alpha, 0.5 * np.arange(dimension) / (dimension - 1))


@kernel
def select(tables: BbobTables, index: int) -> BbobTable:
    """Return one problem table out of stacked ones, as views."""
    return BbobTable(
        tables.dimension[index],
        tables.function[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.optimum[index],
        tables.scale[index],
        tables.weights[index],
        tables.inner[index],
        tables.outer[index],
        tables.places[index],
        tables.conditions[index],
        tables.heights[index],
    )


@kernel(inline="late")
def evaluate(table: BbobTable, path: Floats) -> tuple[float, float]:
    """Return the value of the function above its least one, and 0 as degree of collision; see `tables`.

    Rounding can leave a value of -1e-15 near an optimum; it counts as 0.
    """
    return max(0.0, value(table, path)), 0.0


@kernel(inline="late")
def repair(table: BbobTable, path: Floats, repair_degree: float) -> None:
    """Do nothing, since there are no obstacles; see `tables`."""


@kernel
def value(table: BbobTable, path: Floats) -> float:
    """Return the value, f_opt left out, at `path`, (C + 1,), whose first entry does not count."""
    function = table.function
    y, z = np.empty(table.dimension), np.empty(table.dimension)
    subtract(path, table.optimum, y)
    if function <= 5:
        found = _separable(table, path, y)
    elif function == 8:
        found = conditioned.rosenbrock_valley(y, table.scale)
    elif function == 20:
        found = multimodal.schwefel(table.weights, table.optimum, path, z)
    elif function == 24:
        found = multimodal.lunacek(table.inner, table.optimum, path, y, z)
    else:
        transform(table.inner, y, z)
        found = _conditioned(table, path, z, y) if function <= 14 else _multimodal(table, path, z, y)
    return found


@kernel(inline="late")
def _separable(table: BbobTable, path: Floats, y: Floats) -> float:
    function = table.function
    if function == 1:
        found = separable.sphere(y)
    elif function == 2:
        found = separable.ellipsoid(table.weights, y)
    elif function == 3:
        found = separable.separable_rastrigin(table.weights, y)
    elif function == 4:
        found = separable.skew_rastrigin(table.weights, path, y)
    else:
        found = separable.linear_slope(table.weights, path, y)
    return found


@kernel(inline="late")
def _conditioned(table: BbobTable, path: Floats, y: Floats, z: Floats) -> float:
    function = table.function
    if function == 6:
        found = conditioned.attractive_sector(table.optimum, y)
    elif function == 7:
        found = conditioned.step_ellipsoid(table.weights, table.outer, path, y, z)
    elif function == 9:
        found = conditioned.rosenbrock_valley(y, table.scale)
    elif function == 10:
        found = separable.ellipsoid(table.weights, y)
    elif function == 11:
        found = conditioned.discus(y)
    elif function == 12:
        found = conditioned.bent_cigar(table.outer, y, z)
    elif function == 13:
        found = conditioned.sharp_ridge(y)
    else:
        found = conditioned.different_powers(table.weights, y)
    return found


@kernel(inline="late")
def _multimodal(table: BbobTable, path: Floats, y: Floats, z: Floats) -> float:
    function = table.function
    if function == 15:
        found = multimodal.rotated_rastrigin(table.outer, y, z)
    elif function == 16:
        found = multimodal.weierstrass(table.outer, path, y, z)
    elif function <= 18:
        found = multimodal.schaffers(table.outer, path, y, z)
    elif function == 19:
        found = multimodal.griewank_rosenbrock(y, table.scale)
    elif function <= 22:
        found = multimodal.gallagher(table.places, table.conditions, table.heights, path, y)
    elif function == 23:
        found = multimodal.katsuura(path, y)
    elif function == 25:
        found = separable.separable_rastrigin(table.weights, y)
    else:
        found = separable.skew_rastrigin(table.weights, path, y)
    return found


@entry
def values_at(table: BbobTable, vectors: Floats) -> Floats:
    """Return the values, (n,), at decision vectors, (n, D), as `evaluate` has them."""
    path = np.zeros(table.optimum.shape[0] + 1)
    out = np.empty(vectors.shape[0])
    for row in range(vectors.shape[0]):
        path[1 : table.dimension + 1] = vectors[row]
        out[row], _ = evaluate(table, path)
    return out
