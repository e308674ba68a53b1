"""Test functions as the kernels read them, see `tables`; formulas are in `scenarios.function_scenario`."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel, kernel
from swarm_gym.problem.layout import pad
from swarm_gym.scenarios import FunctionScenario

Floats = NDArray[np.float64]

RASTRIGIN, SUM_SQUARES, EASOM, BOOTH, BOHACHEVSKY = range(5)
NUMBERS = {
    "rastrigin": RASTRIGIN,
    "sum-squares": SUM_SQUARES,
    "easom": EASOM,
    "booth": BOOTH,
    "bohachevsky": BOHACHEVSKY,
}


class FunctionTable(NamedTuple):
    """What the kernels need of one problem; in a stacked table every field has a leading problem axis."""

    dimension: Any  # D: a number, in a stacked table an array
    function: Any  # which one, of `NUMBERS`, likewise
    lower: Floats  # (C,) bounds of decision vectors: the domain
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) where the first population is drawn: the domain
    initial_upper: Floats  # (C,)
    optimum: Floats  # (C,) where the function is 0


def tabulate(scenario: FunctionScenario) -> FunctionTable:
    """The table of a scenario."""
    low, high = (pad(np.full(scenario.dimension, bound)) for bound in scenario.domain)
    optimum = pad(np.array(scenario.optimum))
    return FunctionTable(scenario.dimension, NUMBERS[scenario.function], low, high, low, high, optimum)


@kernel
def select(tables: FunctionTable, index: int) -> FunctionTable:
    """One problem out of stacked tables, as views."""
    return FunctionTable(
        tables.dimension[index],
        tables.function[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.optimum[index],
    )


@inlined_kernel
def evaluate(table: FunctionTable, path: Floats) -> tuple[float, float]:
    """The value, and no collision; see `tables`."""
    return value(table.function, table.dimension, table.optimum, path), 0.0


@inlined_kernel
def repair(table: FunctionTable, path: Floats, repair_degree: float) -> None:
    """Nothing to repair; see `tables`."""


@kernel
def value(function: int, dimension: int, optimum: Floats, path: Floats) -> float:
    """The value of a function at `path`, (C + 1,), whose first entry does not count; never below 0.

    Not inlined: beside its sines, the call costs nothing.
    """
    total = 0.0
    if function == RASTRIGIN:
        for k in range(dimension):
            z = path[k + 1] - optimum[k]
            total += z * z + 20.0 * _squared_sine(math.pi * z)
    elif function == SUM_SQUARES:
        for k in range(dimension):
            z = path[k + 1] - optimum[k]
            total += (k + 1.0) * (z * z)
    elif function == EASOM:
        product, squares = 1.0, 0.0
        for k in range(dimension):
            z = path[k + 1] - optimum[k]
            product *= math.cos(z)
            squares += z * z
        total = 1.0 - product * math.exp(-squares)
    elif function == BOOTH:
        for k in range(0, dimension, 2):
            first, second = path[k + 1] - optimum[k], path[k + 2] - optimum[k + 1]
            total += (first + 2.0 * second) ** 2 + (2.0 * first + second) ** 2
    else:  # Bohachevsky's
        for k in range(dimension - 1):
            first, second = path[k + 1] - optimum[k], path[k + 2] - optimum[k + 1]
            total += first * first + 2.0 * (second * second)
            total += 0.6 * _squared_sine(1.5 * math.pi * first)
            total += 0.8 * _squared_sine(2.0 * math.pi * second)
    return total


@inlined_kernel
def _squared_sine(angle: float) -> float:
    """(1 - cos(2 angle)) / 2, without cancellation where it is small."""
    sine = math.sin(angle)
    return sine * sine


@kernel
def values_in_plane(table: FunctionTable, first: Floats, second: Floats) -> Floats:
    """Values over a plane, with the optimum's components where none are given.

    Args:
        table: the problem.
        first: (n,) values of the first component.
        second: (m,) of the second, where there is one.

    Returns:
        Shape (m, n).
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
