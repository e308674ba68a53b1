"""The firefly algorithm in NumPy: what the kernels are measured against.

It is written the way one writes it without a compiler, with the loops over pairs in Python and everything
else in arrays, and gives the same cost as the kernels up to rounding (a test holds them together).
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import Problem

Floats = NDArray[np.float64]


class NumpyFirefly:
    """FA with the SPSFA paper's parameters on circles and polygons, without repair."""

    def __init__(self, problem: Problem, size: int, seed: int):
        self.table = problem.table
        self.lower, self.upper = problem.bounds
        self.generator = np.random.default_rng(seed)
        pairs = problem.pairs
        self.segment = np.array([pair.segment for pair in pairs], dtype=np.int64)
        self.is_circle = np.array([pair.circle is not None for pair in pairs], dtype=np.bool_)
        self.circle = np.array([pair.circle or (0.0,) * 5 for pair in pairs]).reshape(-1, 5)
        # Corners as a rectangle (pairs, most, 3); the missing ones repeat the last.
        most = max((len(pair.corners) for pair in pairs), default=0) or 1
        corners = [(pair.corners or ((0.0,) * 3,)) for pair in pairs]
        self.corner = np.array([[c[min(k, len(c) - 1)] for k in range(most)] for c in corners]).reshape(
            -1, most, 3
        )
        low, high = problem.initial_bounds
        self.positions = low + (high - low) * self.generator.random((size, len(low)))
        self.fitness = np.array([self.evaluate(x) for x in self.positions])
        self.evaluations = size

    def evaluate(self, position: Floats) -> float:
        """Fitness of one member, shape (n,)."""
        table = self.table
        path = np.concatenate([[0.0], position, [0.0]])
        rise = np.diff(path)
        lengths = np.sqrt(table.spacing**2 + rise**2)
        left, slope = path[self.segment], rise[self.segment] / table.spacing
        cosine = table.spacing / lengths[self.segment]
        x, y, radius, begin, end = self.circle.T
        touch = radius * slope * cosine
        u, v = np.clip(-touch, begin, end), np.clip(touch, begin, end)
        circle_up = y + np.sqrt(radius**2 - u**2) - (left + slope * (x + u))
        circle_down = left + slope * (x + v) - (y - np.sqrt(radius**2 - v**2))
        heights = left[:, None] + slope[:, None] * self.corner[..., 0]
        polygon_up = (self.corner[..., 1] - heights).max(axis=1)
        polygon_down = (heights - self.corner[..., 2]).max(axis=1)
        up = np.where(self.is_circle, circle_up, polygon_up)
        down = np.where(self.is_circle, circle_down, polygon_down)
        collision = np.where((up > 0) & (down > 0), np.minimum(up, down) * cosine, 0.0).sum()
        return float(table.length_weight * lengths.sum() + (1 - table.length_weight) * collision)

    def iterate(self) -> None:
        """One iteration: every firefly moves towards every brighter one and is evaluated at once."""
        positions, fitness = self.positions, self.fitness
        for i in range(len(positions)):
            for j in range(len(positions)):
                if fitness[j] < fitness[i]:
                    difference = positions[j] - positions[i]
                    attraction = 0.1 * np.exp(-5e-6 * (difference @ difference))
                    noise = 2.0 * (self.generator.random(len(difference)) - 0.5)
                    moved = positions[i] + attraction * difference + noise
                    positions[i] = np.clip(moved, self.lower, self.upper)
                    fitness[i] = self.evaluate(positions[i])
                    self.evaluations += 1
