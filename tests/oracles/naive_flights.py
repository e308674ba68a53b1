"""Flights over terrain in plain Python and shapely, cut at every line between cells.

Nothing is taken from the kernels but the numbers of the scenario.
"""

import math
from itertools import pairwise

import numpy as np
import shapely
from shapely import LineString, Point

PENALTY, PER_METRE = 1e4, 100.0
SLACK = 1e-6  # of the altitude band, where a flight runs along its limits
WEIGHTS = {
    "length": 5.0,
    "threats": 1.0,
    "altitude": 10.0,
    "angles": 1.0,
    "ground": 1.0,
    "band": 10.0,
    "limits": 100.0,
}


def ground(scenario, x, y):
    """Return the bilinear height of the ground."""
    rows, columns = scenario.heights.shape
    u, v = (x - scenario.origin[0]) / scenario.cell, (y - scenario.origin[1]) / scenario.cell
    i, j = min(math.floor(u), columns - 2), min(math.floor(v), rows - 2)
    a, b = u - i, v - j
    h = scenario.heights
    return (
        h[j, i] * (1 - a) * (1 - b)
        + h[j, i + 1] * a * (1 - b)
        + h[j + 1, i] * (1 - a) * b
        + h[j + 1, i + 1] * a * b
    )


def waypoints(scenario, encoding, vector):
    """Return (x, y, altitude above ground) from start to goal."""
    (x, y, above), (goal_x, goal_y, goal_above) = scenario.start, scenario.goal
    heading = math.atan2(goal_y - y, goal_x - x)
    found = [(x, y, above)]
    if encoding in ("waypoints", "shifted"):
        groups = 3 if encoding == "shifted" else 2
        n = len(vector) // groups
        for k in range(1, n + 1):
            share, sideways, up = k / (n + 1), vector[k - 1], vector[n + k - 1]
            forwards = vector[2 * n + k - 1] if encoding == "shifted" else 0.0
            to_x = x + share * (goal_x - x) + forwards * math.cos(heading) - sideways * math.sin(heading)
            to_y = y + share * (goal_y - y) + forwards * math.sin(heading) + sideways * math.cos(heading)
            found.append(clipped(scenario, to_x, to_y, above + share * (goal_above - above) + up))
    else:
        for r, psi, phi in np.reshape(vector, (-1, 3)):
            x, y, above = found[-1]
            x += r * math.cos(psi) * math.cos(phi)
            y += r * math.cos(psi) * math.sin(phi)
            above += r * math.sin(psi)
            found.append(clipped(scenario, x, y, above))
    found.append(scenario.goal)
    return found


def clipped(scenario, x, y, above):
    """Return the waypoint on the map and in the band that is nearest to one."""
    x_min, y_min, x_max, y_max = scenario.workspace
    lowest, highest = scenario.band
    return min(max(x, x_min), x_max), min(max(y, y_min), y_max), min(max(above, lowest), highest)


def polyline(scenario, encoding, vector):
    """Return (x, y, height) from start to goal."""
    return [(x, y, ground(scenario, x, y) + above) for x, y, above in waypoints(scenario, encoding, vector)]


def negative_share(values):
    """Return the share of [0, 1] in which the quadratic with these values at 0, 1/2 and 1 is negative."""
    begin, middle, end = values
    square, slope = 2 * (begin - 2 * middle + end), 4 * middle - 3 * begin - end
    roots = [root.real for root in np.roots([square, slope, begin]) if abs(root.imag) < 1e-12]
    cuts = [0.0, *sorted(root for root in roots if 0 < root < 1), 1.0]
    share = 0.0
    for low, high in pairwise(cuts):
        s = (low + high) / 2
        if square * s * s + slope * s + begin < 0:
            share += high - low
    return share


def pieces(scenario, one, other):
    """Return the shares at which a segment crosses lines between cells, its ends among them."""
    shares = {0.0, 1.0}
    for axis in (0, 1):
        begin, end = ((point[axis] - scenario.origin[axis]) / scenario.cell for point in (one, other))
        for line in range(math.ceil(min(begin, end)), math.floor(max(begin, end)) + 1):
            if begin != end:
                shares.add((line - begin) / (end - begin))
    return sorted(share for share in shares if 0 <= share <= 1)


def below_and_outside(scenario, one, other):
    """Return the shares of a segment below the ground and outside the altitude band."""
    below = outside = 0.0
    lowest, highest = scenario.band[0] - SLACK, scenario.band[1] + SLACK
    for begin, end in pairwise(pieces(scenario, one, other)):
        values = []
        for share in (begin, (begin + end) / 2, end):
            x, y, z = (a + share * (b - a) for a, b in zip(one, other, strict=True))
            values.append(z - ground(scenario, x, y))
        below += (end - begin) * negative_share(values)
        outside += (end - begin) * negative_share([value - lowest for value in values])
        outside += (end - begin) * negative_share([highest - value for value in values])
    return below, outside


def inside_and_depth(scenario, one, other, threat):
    """Return the share of a segment inside a cylinder, and its depth in the zone of danger around it."""
    x, y, top, radius = threat
    top += scenario.drone_size
    contact = radius + scenario.drone_size
    rise = other[2] - one[2]
    begin, end = 0.0, 1.0
    if rise != 0:
        crossing = (top - one[2]) / rise
        begin, end = (0.0, min(1.0, crossing)) if rise > 0 else (max(0.0, crossing), 1.0)
    elif one[2] >= top:
        return 0.0, 0.0
    if begin >= end:
        return 0.0, 0.0
    part = [[a + share * (b - a) for a, b in zip(one[:2], other[:2], strict=True)] for share in (begin, end)]
    distance = LineString(part).distance(Point(x, y))
    if distance >= contact:
        return 0.0, max(contact + scenario.danger_distance - distance, 0.0)
    dx, dy, to_x, to_y = other[0] - one[0], other[1] - one[1], one[0] - x, one[1] - y
    square, slope = dx * dx + dy * dy, 2 * (dx * to_x + dy * to_y)
    if square == 0.0:
        return end - begin, 0.0
    low, high = sorted(np.roots([square, slope, to_x**2 + to_y**2 - contact**2]).real)
    return min(end, high) - max(begin, low), 0.0


def terms(scenario, encoding, vector):
    """Return the terms of the documented cost, weighted, by name, and the degree of collision."""
    found = dict.fromkeys(WEIGHTS, 0.0)
    points = polyline(scenario, encoding, vector)
    middle = sum(scenario.band) / 2
    found["altitude"] = sum(abs(above - middle) for *_, above in waypoints(scenario, encoding, vector)[1:-1])
    collision = 0.0
    steps = [np.subtract(other, one) for one, other in pairwise(points)]
    climbs = [math.degrees(math.atan2(dz, math.hypot(dx, dy))) for dx, dy, dz in steps if dx or dy or dz]
    headings = [math.degrees(math.atan2(dy, dx)) for dx, dy, _ in steps if dx or dy]
    turns = [abs(math.remainder(other - one, 360)) for one, other in pairwise(headings)]
    found["angles"] = sum(turns) + sum(abs(other - one) for one, other in pairwise(climbs))
    found["limits"] = sum(max(turn - scenario.largest_turn, 0) for turn in turns)
    found["limits"] += sum(max(abs(climb) - scenario.largest_climb, 0) for climb in climbs)
    for one, other in pairwise(points):
        metres = math.dist(one, other)
        found["length"] += metres
        for threat in scenario.threats.tolist():
            inside, depth = inside_and_depth(scenario, one, other, threat)
            found["threats"] += depth + (PENALTY + PER_METRE * inside * metres if inside > 0 else 0)
            collision += inside * metres
        below, outside = below_and_outside(scenario, one, other)
        found["ground"] += PENALTY + PER_METRE * below * metres if below > 0 else 0
        found["band"] += outside * metres
        collision += below * metres
    return {name: WEIGHTS[name] * value for name, value in found.items()}, collision


def worst(scenario, points, samples=2000):
    """Return the least height above ground and the least distance from contact, at dense samples.

    A distance counts where the flight is below the top of a cylinder.
    """
    above, distance = math.inf, math.inf
    for one, other in pairwise(np.asarray(points)):
        x, y, z = (one + np.linspace(0, 1, samples)[:, None] * (other - one)).T
        above = min(above, *(c - ground(scenario, a, b) for a, b, c in zip(x, y, z, strict=True)))
        places = shapely.points(x, y)
        for threat_x, threat_y, top, radius in scenario.threats.tolist():
            away = shapely.distance(places, Point(threat_x, threat_y))[z < top + scenario.drone_size]
            distance = min(distance, away.min(initial=math.inf) - radius - scenario.drone_size)
    return above, distance
