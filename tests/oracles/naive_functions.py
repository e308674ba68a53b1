"""Test functions in plain Python, as textbooks print them; shifted ones of x minus the shift."""

import itertools
import math


def rastrigin(x):
    return 10 * len(x) + math.fsum(a**2 - 10 * math.cos(2 * math.pi * a) for a in x)


def sum_squares(x):
    return math.fsum(k * a**2 for k, a in enumerate(x, 1))


def easom(x):
    """1 - cos(x1) cos(x2) exp(-(x1 - pi)^2 - (x2 - pi)^2), with a plus where the dimension is odd."""
    sign = -1 if len(x) % 2 == 0 else 1
    return 1 + sign * math.prod(map(math.cos, x)) * math.exp(-math.fsum((a - math.pi) ** 2 for a in x))


def booth(x):
    return math.fsum(
        (a + 2 * b - 7) ** 2 + (2 * a + b - 5) ** 2 for a, b in zip(x[::2], x[1::2], strict=True)
    )


def bohachevsky(x):
    return math.fsum(
        a**2 + 2 * b**2 - 0.3 * math.cos(3 * math.pi * a) - 0.4 * math.cos(4 * math.pi * b) + 0.7
        for a, b in itertools.pairwise(x)
    )


# The function, where its least value is, and the extent of its domain.
FUNCTIONS = {
    "rastrigin": (rastrigin, [0.0], 5.12),
    "sum-squares": (sum_squares, [0.0], 10.0),
    "easom": (easom, [math.pi], 10.0),
    "booth": (booth, [1.0, 3.0], 10.0),
    "bohachevsky": (bohachevsky, [0.0], 10.0),
}


class Problem:
    """The oracle of a `FunctionProblem`."""

    unit_length = 1.0

    def __init__(self, problem):
        scenario = problem.scenario
        self.function, own, extent = FUNCTIONS[scenario.function]
        self.dimension = scenario.dimension
        self.moved = [there - own[k % len(own)] for k, there in enumerate(scenario.optimum)]
        self.lower, self.upper = [-extent] * self.dimension, [extent] * self.dimension
        self.initial_lower, self.initial_upper = self.lower, self.upper

    def cost(self, vector):
        return self.function([a - by for a, by in zip(vector, self.moved, strict=True)]), 0.0

    def repaired(self, vector, repair_degree):
        return list(vector)
