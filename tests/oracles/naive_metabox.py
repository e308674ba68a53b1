"""The published cost of a flight, once more: tuples, angles between vectors, distances by shapely."""

import math
from itertools import pairwise

import numpy as np
from shapely.geometry import LineString, Point

PENALTY, SAMPLES, LIMIT = 1e4, 12, 45.0
DRONE, DANGER = 1.0, 10.0
MIDDLE, LOWEST, HIGHEST = 150.0, 100.0, 200.0


def cost(scenario, encoding, vector):
    """Return the cost `metabox` of a flight over a published terrain.

    Coordinates begin with 1, and posts are one metre apart. Waypoints may coincide. Then the last segment
    before a waypoint and the first one after it that have a length give the directions there.
    """
    points = [
        (x, y, _nearest(scenario, x, y) + above, above)
        for x, y, above in waypoints(scenario, encoding, vector)
    ]
    steps = [np.subtract(after[:3], before[:3]) for before, after in pairwise(points)]
    length = sum(float(np.linalg.norm(step)) for step in steps)
    threats = sum(
        _threat(LineString([before[:2], after[:2]]).distance(Point(x, y)), radius)
        for before, after in pairwise(points)
        for x, y, _, radius in scenario.threats.tolist()
    )
    altitude = sum(abs(above - MIDDLE) for *_, above in points[1:-1])
    angles = 0.0
    level = [complex(*step[:2]) for step in steps]
    for k in range(len(steps) - 1):
        before = next((step for step in level[k::-1] if step), level[0])
        after = next((step for step in level[k + 1 :] if step), level[-1])
        turn = _angle(after / before) if before else 0.0
        climbs = [
            math.degrees(math.atan2(steps[k][2], abs(before))),
            math.degrees(math.atan2(steps[k + 1][2], abs(after))),
        ]
        angles += sum(angle for angle in (turn, abs(climbs[1] - climbs[0])) if angle > LIMIT)
    grounded = any(_is_grounded(scenario, before, after) for before, after in pairwise(points))
    return 5.0 * length + threats + 10.0 * altitude + angles + (PENALTY if grounded else 0.0)


def waypoints(scenario, encoding, vector):
    """Return (x, y, altitude above ground) from start to goal, clipped to the map and to the band."""
    (x, y, above), (goal_x, goal_y, goal_above) = scenario.start, scenario.goal
    side = float(len(scenario.heights))
    found = [(x, y, above)]
    if encoding in ("waypoints", "shifted"):
        groups = np.reshape(vector, (3 if encoding == "shifted" else 2, -1)).tolist()
        n = len(groups[0])
        ahead = complex(goal_x - x, goal_y - y)
        direction = ahead / abs(ahead)
        for k in range(n):
            share = (k + 1) / (n + 1)
            at = complex(x, y) + share * ahead + groups[0][k] * 1j * direction
            at += groups[2][k] * direction if encoding == "shifted" else 0.0
            found.append((at.real, at.imag, above + share * (goal_above - above) + groups[1][k]))
    else:
        for r, climb, heading in np.reshape(vector, (-1, 3)):
            x, y, above = found[-1]
            level = r * math.cos(climb)
            moved = x + level * math.sin(heading), y + level * math.cos(heading), above + r * math.sin(climb)
            found.append(_clipped(*moved, side))
    return [*(_clipped(*one, side) for one in found), scenario.goal]


def _clipped(x, y, above, side):
    return min(max(x, 1.0), side), min(max(y, 1.0), side), min(max(above, LOWEST), HIGHEST)


def _nearest(scenario, x, y):
    """Return the height of the nearest cell, whose coordinates begin with 1."""
    return scenario.heights[round(y) - 1, round(x) - 1]


def _threat(distance, radius):
    if distance < radius + DRONE:
        return PENALTY
    return max(radius + DRONE + DANGER - distance, 0.0)


def _angle(quotient):
    return abs(math.degrees(math.atan2(quotient.imag, quotient.real)))


def _is_grounded(scenario, before, after):
    """Return whether one of the samples is not above the ground, read as if coordinates began with 0."""
    heights = scenario.heights
    for share in np.linspace(0.0, 1.0, SAMPLES):
        x, y, z = (p + share * (q - p) for p, q in zip(before[:3], after[:3], strict=True))
        if max(x, y) > len(heights) - 1:
            return True
        i, j = min(int(x), len(heights) - 2), min(int(y), len(heights) - 2)
        a, b = x - i, y - j
        ground = (
            (1 - a) * (1 - b) * heights[j, i]
            + a * (1 - b) * heights[j, i + 1]
            + (1 - a) * b * heights[j + 1, i]
            + a * b * heights[j + 1, i + 1]
        )
        if z <= ground:
            return True
    return False
