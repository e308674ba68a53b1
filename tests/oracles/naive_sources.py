"""Plain-Python oracle for sources of new members: uniform in a box, or smooth bends beside the line or ways.

A problem gives its bounds, `num_points`, `width` (largest extent across the line), `beside_the_line` and
`ways`. The former turns the offsets of evenly spaced points from the start-target line into a decision
vector; the latter are the decision vectors that bends lie beside instead of the line, or None.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from oracles import naive

NUM_HARMONICS, NUM_STOMP = 3, 6


@dataclass(frozen=True)
class Source:
    """A source of new members, with the share of members that immigrants replace."""

    smooth_share: float = 0.0
    amplitude: float = 0.5
    bends: str = "harmonics"
    immigrants: float = 0.0


def newcomer(problem, source, stream, lower, upper):
    """Return the position of a new member, and whether it is a smooth bend."""
    numbers = stream.padded_uniform(problem.dimension)
    if source.smooth_share > 0:
        if numbers[0] < source.smooth_share:
            return bend(problem, source, numbers), True
        numbers = stream.padded_uniform(problem.dimension)
    return [a + (b - a) * u for a, b, u in zip(lower, upper, numbers, strict=False)], False


def bend(problem, source, numbers):
    """Return a bend inside the bounds; number 1 says how large it is, those from 2 on what form it has."""
    offsets = form(source.bends, numbers[2:], problem.num_points)
    largest = max(abs(offset) for offset in offsets)
    scale = numbers[1] * source.amplitude * problem.width / largest
    vector = problem.beside_the_line([scale * offset for offset in offsets])
    if problem.ways is not None:
        way = problem.ways[int(numbers[0] / source.smooth_share * len(problem.ways))]
        line = problem.beside_the_line([0.0] * len(offsets))
        vector = [a + (b - c) for a, b, c in zip(way, vector, line, strict=True)]
    return [naive.clip(*values) for values in zip(vector, problem.lower, problem.upper, strict=True)]


def form(bends, numbers, count):
    """Return the offsets of `count` evenly spaced points before they are scaled."""
    if bends == "harmonics":
        places = [j / (count + 1) for j in range(1, count + 1)]
        terms = [
            [(2 * numbers[h - 1] - 1) * math.sin(h * math.pi * t) / h**1.5 for t in places]
            for h in range(1, NUM_HARMONICS + 1)
        ]
    else:
        weighted = zip(normals(numbers), principal(count), strict=False)
        terms = [[normal * y for y in mode] for normal, mode in weighted]
    return [math.fsum(column) for column in zip(*terms, strict=True)]


def normals(numbers):
    """Return six normal numbers, by Box and Muller."""
    found = []
    for u, v in zip(numbers[0:NUM_STOMP:2], numbers[1:NUM_STOMP:2], strict=True):
        radius = math.sqrt(-2 * math.log(1 - u))
        found += [radius * math.cos(2 * math.pi * v), radius * math.sin(2 * math.pi * v)]
    return found


@cache
def covariance(count):
    """Return the inverse of A^T A, where A takes second differences and all points outside are zero."""
    rows = np.zeros((count + 2, count))
    for i in range(count + 2):
        for j, weight in ((i - 2, 1.0), (i - 1, -2.0), (i, 1.0)):
            if 0 <= j < count:
                rows[i, j] = weight
    return np.linalg.inv(rows.T @ rows)


@cache
def principal(count):
    """Return the widest principal components; the first point of each lies on the left of the line."""
    variances, directions = np.linalg.eigh(covariance(count))
    modes = []
    for k in reversed(range(max(count - NUM_STOMP, 0), count)):
        mode = directions[:, k] * math.sqrt(variances[k] / variances[-1])
        modes.append((mode if mode[0] > 0 else -mode).tolist())
    return modes
