"""The firefly algorithm in NumPy: what the kernels are measured against.

It is written the way one writes it without a compiler, with the loops over pairs in Python and everything
else in arrays, and gives the same cost as the kernels up to rounding (a test holds them together).
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.pairs import Pair
from swarm_gym.scenarios import make_scenario, require_analytic

Floats = NDArray[np.float64]


def analytic_problem(case: str) -> AnalyticProblem:
    """The problem of an environment of a scenario with circles and polygons."""
    return AnalyticProblem(require_analytic(make_scenario(case)))


class NumpyFirefly:
    """FA with the SPSFA paper's parameters on circles and polygons, without repair."""

    def __init__(self, problem: AnalyticProblem, size: int, seed: int):
        table = problem.table
        self.spacing, self.length_weight = float(table.spacing), float(table.length_weight)
        self.lower, self.upper = problem.bounds
        self.generator = np.random.default_rng(seed)
        self._tabulate([pair for pair in problem.pairs if pair.circle], problem.pairs)
        self.path = np.zeros(problem.num_waypoints + 2)
        low, high = problem.initial_bounds
        self.positions = low + (high - low) * self.generator.random((size, len(low)))
        self.fitness = np.array([self.evaluate(x) for x in self.positions])
        self.evaluations = size

    def _tabulate(self, circles: list[Pair], pairs: list[Pair]) -> None:
        """Arrays over the pairs with circles, and over those with polygons: what does not change."""
        polygons = [pair for pair in pairs if not pair.circle]
        self.circle_segment = np.array([pair.segment for pair in circles], dtype=np.int64)
        columns = np.array([pair.circle for pair in circles]).reshape(-1, 5).T
        self.x, self.y, self.radius, self.begin, self.end = np.ascontiguousarray(columns)
        self.squared_radius = self.radius**2
        self.polygon_segment = np.array([pair.segment for pair in polygons], dtype=np.int64)
        # Corners as a rectangle (3, pairs, most); the missing ones repeat the last.
        most = max((len(pair.corners) for pair in polygons), default=1)
        corners = [[p.corners[min(k, len(p.corners) - 1)] for k in range(most)] for p in polygons]
        self.corner_x, self.corner_top, self.corner_bottom = (
            np.array(corners).reshape(-1, most, 3).transpose(2, 0, 1).copy()
        )

    def evaluate(self, position: Floats) -> float:
        """Fitness of one member, shape (n,)."""
        path = self.path
        path[1:-1] = position
        rise = path[1:] - path[:-1]
        lengths = np.sqrt(self.spacing**2 + rise * rise)
        slope, cosine = rise / self.spacing, self.spacing / lengths
        collision = 0.0
        if len(self.circle_segment):
            segment = self.circle_segment
            left, incline, c = path[segment], slope[segment], cosine[segment]
            touch = self.radius * incline * c
            u = np.minimum(np.maximum(-touch, self.begin), self.end)
            v = np.minimum(np.maximum(touch, self.begin), self.end)
            up = self.y + np.sqrt(self.squared_radius - u * u) - (left + incline * (self.x + u))
            down = left + incline * (self.x + v) - (self.y - np.sqrt(self.squared_radius - v * v))
            collision += np.maximum(np.minimum(up, down), 0.0) @ c
        if len(self.polygon_segment):
            segment = self.polygon_segment
            heights = path[segment, None] + slope[segment, None] * self.corner_x
            up = (self.corner_top - heights).max(axis=1)
            down = (heights - self.corner_bottom).max(axis=1)
            collision += np.maximum(np.minimum(up, down), 0.0) @ cosine[segment]
        return float(self.length_weight * lengths.sum() + (1 - self.length_weight) * collision)

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
                    positions[i] = np.minimum(np.maximum(moved, self.lower), self.upper)
                    fitness[i] = self.evaluate(positions[i])
                    self.evaluations += 1
