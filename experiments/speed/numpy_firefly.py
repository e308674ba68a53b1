"""The firefly algorithm in NumPy, with which the kernels are compared.

It is written as one would write it without a compiler: loops over pairs in Python, everything else in arrays.
Its cost equals that of the kernels up to rounding, which a test checks.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.pairs import Pair
from swarm_gym.scenarios import make_scenario, require_analytic

Floats = NDArray[np.float64]


def analytic_problem(case: str) -> AnalyticProblem:
    """Return the problem of a scenario with circles and polygons, as an environment has it."""
    return AnalyticProblem(require_analytic(make_scenario(case)))


class NumpyFirefly:
    """A swarm of the firefly algorithm with the SPSFA paper's parameters, on analytic maps, without repair.

    Args:
        problem: problem whose cost is minimised.
        size: population size.
        seed: seed of all random numbers.
    """

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
        """Store constant arrays over the pairs of a segment with a circle, and with a polygon."""
        polygons = [pair for pair in pairs if not pair.circle]
        self.circle_segment = np.array([pair.segment for pair in circles], dtype=np.int64)
        columns = np.array([pair.circle for pair in circles]).reshape(-1, 5).T
        self.x, self.y, self.radius, self.begin, self.end = np.ascontiguousarray(columns)
        self.squared_radius = self.radius**2
        self.polygon_segment = np.array([pair.segment for pair in polygons], dtype=np.int64)
        # Corners as an array (3, pairs, most); polygons with fewer corners repeat their last one.
        most = max((len(pair.corners) for pair in polygons), default=1)
        corners = [[p.corners[min(k, len(p.corners) - 1)] for k in range(most)] for p in polygons]
        self.corner_x, self.corner_top, self.corner_bottom = (
            np.array(corners).reshape(-1, most, 3).transpose(2, 0, 1).copy()
        )

    def evaluate(self, position: Floats) -> float:
        """Return the fitness of one member, (n,)."""
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
        """Carry out one iteration: every firefly moves towards every brighter one; each move is evaluated."""
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
