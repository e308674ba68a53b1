"""The published generator of terrains, once more: one level and one quantity at a time, points as lists."""

import numpy as np
from scipy.interpolate import LinearNDInterpolator

SIDE = 900


def naive_terrain(stream, threats):
    """Return heights, threats, start and goal of the next terrain of a stream."""
    spread, rr = stream.rand() * 600 - 200, stream.rand() * 800 + 100
    heights = _heights(stream, spread, rr)
    unit = stream.rand(threats, 4)
    cylinders = np.empty((threats, 4))
    for k, (u, v, w, q) in enumerate(unit.tolist()):
        radius = np.round(60.0 + q * 30.0)
        x = np.round(min(radius, 90.0) + u * 0.7 * SIDE)
        y = np.round(min(radius, 90.0) + v * 0.9 * SIDE)
        cylinders[k] = x, y, np.round(heights[int(y), int(x)] - 10 + w * 40), radius
    while True:
        xs = np.round((0.02 + stream.rand() * 0.17) * SIDE)
        xe = np.round((1 - 0.02 - stream.rand() * 0.17) * SIDE)
        ys = np.round((0.02 + stream.rand() * 0.17) * SIDE)
        ye = np.round((1 - 0.02 - stream.rand() * 0.17) * SIDE)
        if all(np.hypot(x - xs, y - ys) > r + 11 for x, y, _, r in cylinders):
            return heights, cylinders, (xs, ys, 150.0), (xe, ye, 150.0)


def _heights(stream, spread, rr):
    count = stream.randint(1, 5)
    x, y = stream.randn(count), stream.randn(count)
    h, r = spread * stream.randn(count) + 130, rr * stream.randn(count) + spread
    for level in range(1, 9):
        new = 3 * count
        parent = np.array([k for k in range(count) for _ in range(3)])
        angle = 2 * np.pi * stream.rand(new)
        away = 0.75**level * (stream.rand(new) + 1)
        at_x, at_y = x[parent] + away * np.cos(angle), y[parent] + away * np.sin(angle)
        new_r = _linear(x, y, r, at_x, at_y) + (0.5**level * rr) * stream.randn(new)
        steps = (0.5**level / 0.75**level) * away * new_r
        h = np.append(h, _linear(x, y, h, at_x, at_y) + steps * stream.randn(new))
        x, y, r = np.append(x, at_x), np.append(y, at_y), np.append(r, new_r)
        count += new
    x, y = (x - np.median(x)) / np.std(x), (y - np.median(y)) / np.std(y)
    places = np.linspace(-1, 1, SIDE)
    return _linear(x, y, h, np.tile(places, SIDE), np.repeat(places, SIDE)).reshape(SIDE, SIDE)


def _linear(x, y, values, at_x, at_y):
    points = [(-100.0, -100.0), (-100.0, 100.0), (100.0, -100.0), (100.0, 100.0), *zip(x, y, strict=True)]
    return LinearNDInterpolator(points, np.append(np.zeros(4), values))(at_x, at_y)
