"""First populations of Bezier curves around a way."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import GridProblem
from swarm_gym.problem.geometry.curves import nearest_curves

Floats = NDArray[np.float64]

WIDEST = 0.1  # standard deviation of the control points of the widest member, as a share of the map's width


def guided_population(problem: GridProblem, way: Floats, size: int, seed: int) -> Floats:
    """Return decision vectors, (size, dimension), around a way from start to target, (k, 2).

    The first member is the Bezier curve nearest to the way, by least squares; the others have their control
    points moved at random, the later the farther.
    """
    low, high = problem.bounds
    (nearest,) = nearest_curves(way[None], problem.num_points)
    rng = np.random.default_rng(seed)
    widths = WIDEST * (high - low).max() * np.arange(size)[:, None] / max(size - 1, 1)
    return np.clip(nearest + widths * rng.normal(size=(size, len(nearest))), low, high)
