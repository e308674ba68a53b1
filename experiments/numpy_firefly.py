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
        table = problem.table
        self.table = table
        self.generator = np.random.default_rng(seed)
        self.segment = np.repeat(np.arange(len(table.first_pair) - 1), np.diff(table.first_pair))
        corners = np.diff(table.first_corner)
        self.is_circle = corners == 0
        self.most = int(corners.max(initial=1))
        # Corners as a rectangle (pairs, most); the missing ones repeat the first.
        columns = np.minimum(np.arange(self.most), np.maximum(corners - 1, 0)[:, None])
        index = np.minimum(table.first_corner[:-1, None] + columns, max(len(table.corner) - 1, 0))
        self.corner = table.corner[index] if len(table.corner) else np.zeros((len(index), self.most, 3))
        spread = table.initial_upper - table.initial_lower
        self.positions = table.initial_lower + spread * self.generator.random((size, len(spread)))
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
        x, y, radius, begin, end = table.pair_circle.T
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
        table, positions, fitness = self.table, self.positions, self.fitness
        for i in range(len(positions)):
            for j in range(len(positions)):
                if fitness[j] < fitness[i]:
                    difference = positions[j] - positions[i]
                    attraction = 0.1 * np.exp(-5e-6 * (difference @ difference))
                    noise = 2.0 * (self.generator.random(len(difference)) - 0.5)
                    moved = positions[i] + attraction * difference + noise
                    positions[i] = np.clip(moved, table.lower, table.upper)
                    fitness[i] = self.evaluate(positions[i])
                    self.evaluations += 1
