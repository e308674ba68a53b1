"""Test functions on the device; formulas as in `swarm_gym.problem.function.table`.

Lane k holds component k. Lanes beyond the dimension hold 0, which changes no sum.
"""

import math

from swarm_gym.gpu.warps import NUM_LANES, cosine, exponential, from_lane, kernel, maximum, total
from swarm_gym.problem.function.table import BOOTH, EASOM, RASTRIGIN, SUM_SQUARES, FunctionTables


@kernel
def squared_sine(half_turns: float) -> float:
    """Return sin(pi x)^2 as `swarm_gym.problem.function.table.squared_sine` does."""
    turned = half_turns - math.floor(half_turns + 0.5)
    turned = maximum(turned, 0.0 - turned)
    is_large = turned > 0.25
    angle = math.pi * (0.5 - turned if is_large else turned)
    square = angle * angle
    factor = -2.50507602534068634195e-08 + square * 1.58969099521155010221e-10
    factor = 2.75573137070700676789e-06 + square * factor
    factor = -1.98412698298579493134e-04 + square * factor
    factor = 8.33333333332248946124e-03 + square * factor
    factor = -1.66666666666666324348e-01 + square * factor
    sine = angle + angle * square * factor
    squared = sine * sine
    return 1.0 - squared if is_large else squared


@kernel
def evaluate(tables: FunctionTables, p: int, lane: int, place: float) -> tuple[float, float]:
    """Return the value of the function of problem `p`, and 0 as degree of collision.

    Some constants are float64, so that values are computed in it and rounded at the end.
    """
    number = tables.optimum.dtype.type
    return number(value(tables, p, lane, place)), number(0.0)


@kernel
def value(tables: FunctionTables, p: int, lane: int, place: float) -> float:
    """Return the value of the function of problem `p`."""
    function, dimension = tables.function[p], tables.dimension[p]
    z = place - tables.optimum[p, lane]
    if function == RASTRIGIN:
        return total(z * z + 20.0 * squared_sine(z))
    if function == EASOM:
        product, squares = 1.0, 0.0
        for k in range(dimension):
            each = from_lane(z, k)
            product *= cosine(each)
            squares += each * each
        return 1.0 - product * exponential(-squares)
    found = 0.0
    if function == SUM_SQUARES:
        for k in range(dimension):
            each = from_lane(z, k)
            found += (k + 1.0) * (each * each)
        return found
    if function == BOOTH:
        for k in range(0, dimension, 2):
            first, second = from_lane(z, k), from_lane(z, k + 1)
            found += (first + 2.0 * second) * (first + 2.0 * second)
            found += (2.0 * first + second) * (2.0 * first + second)
        return found
    # Bohachevsky: lane k has the term of components k and k + 1.
    second = from_lane(z, (lane + 1) % NUM_LANES)
    term = z * z + 2.0 * (second * second)
    bends = 0.6 * squared_sine(1.5 * z) + 0.8 * squared_sine(2.0 * second)
    for k in range(dimension - 1):
        found += from_lane(term, k)
        found += from_lane(bends, k)
    return found


@kernel
def repair(tables: FunctionTables, p: int, lane: int, place: float, repair_degree: float) -> float:
    """Return the component as it is, since there are no obstacles."""
    return place


@kernel
def draw_bend(
    tables: FunctionTables, p: int, lane: int, amplitude: float, kind: int, noise: float, share: float
) -> float:
    """Return 0: vectors of test functions are no paths, and their sources are always uniform."""
    return 0.0
