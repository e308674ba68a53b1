"""The problem table of test functions, see `tables`; formulas are in `scenarios.function_scenario`."""

import math
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.compiler.simd import NUM_LANES, Lanes, broadcast, floor, load, maximum, total, where
from swarm_gym.problem.padding import Floats, Integers, Whole, pad
from swarm_gym.scenarios import FunctionScenario

LanesOrFloat = TypeVar("LanesOrFloat", Lanes, float)

RASTRIGIN, SUM_SQUARES, EASOM, BOOTH, BOHACHEVSKY = range(5)
NUMBERS = {
    "rastrigin": RASTRIGIN,
    "sum-squares": SUM_SQUARES,
    "easom": EASOM,
    "booth": BOOTH,
    "bohachevsky": BOHACHEVSKY,
}


class FunctionTable(NamedTuple, Generic[Whole]):
    """The problem table of a test function; in a stacked table every field has a leading problem axis."""

    dimension: Whole  # D
    function: Whole  # one of `NUMBERS`
    lower: Floats  # (C,) bounds of decision vectors: the domain
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population: the domain
    initial_upper: Floats  # (C,)
    optimum: Floats  # (C,) vector at which the function is 0


FunctionTables = FunctionTable[Integers]  # of stacked problems


def tabulate(scenario: FunctionScenario) -> FunctionTable:
    """Return the problem table of a scenario."""
    low, high = (pad(np.full(scenario.dimension, bound)) for bound in scenario.domain)
    optimum = pad(np.array(scenario.optimum))
    return FunctionTable(scenario.dimension, NUMBERS[scenario.function], low, high, low, high, optimum)


@kernel
def select(tables: FunctionTables, index: int) -> FunctionTable:
    """Return one problem table out of stacked ones, as views."""
    return FunctionTable(
        tables.dimension[index],
        tables.function[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.optimum[index],
    )


@kernel(inline="late")
def evaluate(table: FunctionTable, path: Floats) -> tuple[float, float]:
    """Return the value of the function, and 0 as degree of collision; see `tables`."""
    return value(table.function, table.dimension, table.optimum, path), 0.0


@kernel(inline="late")
def repair(table: FunctionTable, path: Floats, repair_degree: float) -> None:
    """Do nothing, since there are no obstacles; see `tables`."""


@kernel(inline="late")
def value(function: int, dimension: int, optimum: Floats, path: Floats) -> float:
    """Return the value, at least 0, of a function at `path`, (C + 1,), whose first entry does not count."""
    if function == RASTRIGIN:
        return _rastrigin(optimum, path)
    if function == SUM_SQUARES:
        return _sum_squares(dimension, optimum, path)
    if function == EASOM:
        return _easom(dimension, optimum, path)
    if function == BOOTH:
        return _booth(dimension, optimum, path)
    return _bohachevsky(dimension, optimum, path)


@kernel(inline="late")
def _rastrigin(optimum: Floats, path: Floats) -> float:
    values = broadcast(0.0)
    for k in range(0, optimum.shape[0], NUM_LANES):
        z = load(path, k + 1) - load(optimum, k)  # 0 beyond the dimension, where it changes nothing
        values = values + (z * z + 20.0 * squared_sine(z))
    return total(values)


@kernel(inline="late")
def _sum_squares(dimension: int, optimum: Floats, path: Floats) -> float:
    value = 0.0
    for k in range(dimension):
        z = path[k + 1] - optimum[k]
        value += (k + 1.0) * (z * z)
    return value


@kernel(inline="late")
def _easom(dimension: int, optimum: Floats, path: Floats) -> float:
    product, squares = 1.0, 0.0
    for k in range(dimension):
        z = path[k + 1] - optimum[k]
        product *= math.cos(z)
        squares += z * z
    return 1.0 - product * math.exp(-squares)


@kernel(inline="late")
def _booth(dimension: int, optimum: Floats, path: Floats) -> float:
    value = 0.0
    for k in range(0, dimension, 2):
        first, second = path[k + 1] - optimum[k], path[k + 2] - optimum[k + 1]
        value += (first + 2.0 * second) ** 2 + (2.0 * first + second) ** 2
    return value


@kernel(inline="late")
def _bohachevsky(dimension: int, optimum: Floats, path: Floats) -> float:
    value = 0.0
    for k in range(dimension - 1):
        first, second = path[k + 1] - optimum[k], path[k + 2] - optimum[k + 1]
        value += first * first + 2.0 * (second * second)
        value += 0.6 * squared_sine(1.5 * first) + 0.8 * squared_sine(2.0 * second)
    return value


@kernel(inline="late")
def squared_sine(half_turns: LanesOrFloat) -> LanesOrFloat:
    """Return sin(pi x)^2 of lanes or a number: (1 - cos(2 pi x)) / 2, without cancellation where it is small.

    The sine of the C library knows no lanes, and took two thirds of the time of a fish swarm on Rastrigin's
    function. An angle in half turns is reduced exactly: the square repeats itself after one half turn.
    Beyond pi / 4, the square is 1 less the square of the complement. The polynomial comes from the kernel
    sine of Sun's fdlibm (k_sin.c), for angles up to pi / 4. The result is exact to a few last bits.
    """
    turned = half_turns - floor(half_turns + 0.5)  # from -1/2 to 1/2
    turned = maximum(turned, 0.0 - turned)
    is_large = turned > 0.25
    angle = math.pi * where(is_large, 0.5 - turned, turned)
    square = angle * angle
    factor = -2.50507602534068634195e-08 + square * 1.58969099521155010221e-10
    factor = 2.75573137070700676789e-06 + square * factor
    factor = -1.98412698298579493134e-04 + square * factor
    factor = 8.33333333332248946124e-03 + square * factor
    factor = -1.66666666666666324348e-01 + square * factor
    sine = angle + angle * square * factor
    return where(is_large, 1.0 - sine * sine, sine * sine)


@entry
def values_in_plane(table: FunctionTable, first: Floats, second: Floats) -> Floats:
    """Return the values over a plane; components beyond the first two come from the optimum.

    Args:
        table: the problem table.
        first: (n,) values of the first component.
        second: (m,) values of the second component, where there is one.

    Returns:
        An array of shape (m, n).
    """
    path = np.zeros(table.optimum.shape[0] + 1)
    path[1:] = table.optimum
    out = np.empty((second.shape[0], first.shape[0]))
    for row in range(second.shape[0]):
        if table.dimension > 1:
            path[2] = second[row]
        for column in range(first.shape[0]):
            path[1] = first[column]
            out[row, column] = value(table.function, table.dimension, table.optimum, path)
    return out
