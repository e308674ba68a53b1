"""The oracle of corridors: signatures by interpolation in rotated coordinates, winding numbers by angles."""

import math
from itertools import pairwise

from swarm_gym.problem.geometry.rotated_axes import RotatedAxes


def signature(path, posts, axes: RotatedAxes):
    """Return for each post how often a path passes to its left, net of the times that it comes back."""
    rotated = [axes.from_map(tuple(point)) for point in path]
    found = []
    for post in posts:
        along, across = axes.from_map(tuple(post))
        count = 0
        for (x0, y0), (x1, y1) in pairwise(rotated):
            if min(x0, x1) <= along < max(x0, x1):
                height = y0 + (y1 - y0) * (along - x0) / (x1 - x0)
                if height > across:
                    count += 1 if x1 > x0 else -1
        found.append(count)
    return found


def count(paths, posts, axes: RotatedAxes):
    """Return the number of different signatures of paths."""
    return len({tuple(signature(path, posts, axes)) for path in paths})


def winding_number(closed, point):
    """Return how often a closed polygon, a list of points, winds counter-clockwise around a point."""
    x, y = point
    total = 0.0
    for (x0, y0), (x1, y1) in zip(closed, [*closed[1:], closed[0]], strict=True):
        one, other = (x0 - x, y0 - y), (x1 - x, y1 - y)
        total += math.atan2(
            one[0] * other[1] - one[1] * other[0],
            one[0] * other[0] + one[1] * other[1],
        )
    return round(total / math.tau)
