"""The fitness of Bezier curves on a grid map in NumPy: what other libraries get as their cost.

It is written the way one writes it without a compiler, for a whole population at a time, and gives the same
as the kernel up to rounding (a test holds them together).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import GridProblem

Floats = NDArray[np.float64]


def numpy_fitness(problem: GridProblem) -> Callable[[Floats], Floats]:
    """Fitness (...,) of decision vectors (..., dimension) inside the bounds, of a Bezier curve."""
    curve, grid, penalty = problem.curve, problem.scenario.map, problem.penalty
    basis = np.ascontiguousarray(curve.weights.T)

    def fitness(vectors: Floats) -> Floats:
        # A curve stays among its control points, so that no sample is outside the map.
        control_points = grid.to_cells(curve.control_points(vectors))
        columns, rows = control_points[..., 0] @ basis, control_points[..., 1] @ basis
        across, down = np.diff(columns), np.diff(rows)
        length = grid.resolution * np.sqrt(across * across + down * down).sum(axis=-1)
        # Coordinates are not negative: the nearest cell centre is found by cutting off decimals.
        infeasible = grid.blocked[(rows + 0.5).astype(int), (columns + 0.5).astype(int)]
        return length + penalty * np.count_nonzero(infeasible, axis=-1)

    return fitness
