"""An independent check of flights over terrain: dense points, plain bilinear ground, and discs of shapely."""

import math
from functools import partial
from itertools import pairwise

from pyproj import Proj
from shapely.geometry import LineString, Point

STEP = 0.2  # of a cell, between two points


def faults(scenario, waypoints, touch=1e-6, ground=None):
    """Return what is wrong with a flight, (k, 3) of x, y and height above sea level, as sentences.

    The ground, a function of x and y, is that of the scenario by default.
    """
    found = []
    ground = ground or partial(_ground, scenario)
    ends = (waypoints[0], scenario.start), (waypoints[-1], scenario.goal)
    for (x, y, z), (end_x, end_y, above) in ends:
        if math.dist((x, y), (end_x, end_y)) > touch or abs(z - ground(x, y) - above) > touch:
            found.append(f"an end at {(x, y, z)} is not {(end_x, end_y, above)}")
    lowest, highest = scenario.band
    for x, y, z in _points(scenario, waypoints):
        above = z - ground(x, y)
        if not lowest - touch <= above <= highest + touch:
            found.append(f"{above:.4f} m above ground at {(x, y)}")
    for number, (x, y, top, radius) in enumerate(scenario.threats.tolist()):
        disc = Point(x, y).buffer(radius, quad_segs=64)
        for begin, end in pairwise(waypoints):
            line = LineString([begin, end])
            if line.distance(Point(x, y)) < radius + scenario.drone_size - touch:
                inside = line.intersection(disc.buffer(scenario.drone_size))
                if not inside.is_empty and min(c[2] for c in inside.coords) < top - touch:
                    found.append(f"threat {number} is met between {begin} and {end}")
    for begin, end in pairwise(waypoints):
        level = math.dist(begin[:2], end[:2])
        if math.degrees(math.atan2(abs(end[2] - begin[2]), level)) > scenario.largest_climb + touch:
            found.append(f"too steep between {begin} and {end}")
    for a, b, c in zip(waypoints[:-2], waypoints[1:-1], waypoints[2:], strict=True):
        turn = math.atan2(c[1] - b[1], c[0] - b[0]) - math.atan2(b[1] - a[1], b[0] - a[0])
        if abs(math.degrees(math.remainder(turn, math.tau))) > scenario.largest_turn + touch:
            found.append(f"a turn that is too sharp at {b}")
    return found


def _points(scenario, waypoints):
    for begin, end in pairwise(waypoints):
        count = max(math.ceil(math.dist(begin[:2], end[:2]) / (STEP * scenario.cell)), 1)
        for k in range(count + 1):
            s = k / count
            yield tuple(p + s * (q - p) for p, q in zip(begin, end, strict=True))


def ground_in_degrees(elevation, longitude, latitude):
    """Return the ground of an elevation model in degrees as a function of metres around a place."""
    plane = Proj(proj="aeqd", lon_0=longitude, lat_0=latitude, ellps="WGS84")

    def ground(x, y):
        east, north = plane(x, y, inverse=True)
        (first, south), (dx, dy) = elevation.origin, elevation.spacing
        return bilinear(elevation.heights, (east - first) / dx, (north - south) / dy)

    return ground


def _ground(scenario, x, y):
    """Return the height of the ground of a scenario."""
    u, v = (x - scenario.origin[0]) / scenario.cell, (y - scenario.origin[1]) / scenario.cell
    return bilinear(scenario.heights, u, v)


def bilinear(heights, u, v):
    """Return the mean of four posts, weighted by the opposite areas."""
    rows, columns = heights.shape
    i, j = min(max(int(u), 0), columns - 2), min(max(int(v), 0), rows - 2)
    return sum(
        heights[j + dj, i + di] * abs(1 - di - (u - i)) * abs(1 - dj - (v - j))
        for di in (0, 1)
        for dj in (0, 1)
    )
