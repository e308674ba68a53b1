"""Plain-Python oracles: loops straight from the equations of the SPSFA paper.

The kernels are held against them. Nothing here shares code with the package but the classes that
describe a scenario. A path is a list of offsets y' of its waypoints; a swarm is lists of paths.
"""

import math
import statistics
from functools import cache

from swarm_gym.scenarios import Circle, Polygon, Scenario

MASK = 2**64 - 1
FEASIBLE = 1e-9
TOUCHING = 1e-9  # extents that overlap by no more than a rounding


class Sfc64:
    """The generator "sfc64" of PractRand on Python integers."""

    def __init__(self, words):
        self.a, self.b, self.c, self.counter = (int(word) for word in words)

    def word(self):
        result = (self.a + self.b + self.counter) & MASK
        self.counter = (self.counter + 1) & MASK
        self.a = self.b ^ (self.b >> 11)
        self.b = (self.c + (self.c << 3)) & MASK
        rotated = ((self.c << 24) | (self.c >> 40)) & MASK
        self.c = (rotated + result) & MASK
        return result

    def uniform(self):
        return (self.word() >> 11) / 2**53

    def words(self):
        return [self.a, self.b, self.c, self.counter]


class Stream:
    """Eight generators in turn; a vector of n numbers takes n // 8 + 1 numbers from each."""

    def __init__(self, words):
        self.lanes = [Sfc64([row[lane] for row in words]) for lane in range(8)]

    def uniform(self, n):
        return self.padded_uniform(n)[:n]

    def padded_uniform(self, n):
        """Return all numbers that are drawn for a vector of n, whose count is a multiple of eight."""
        return [self.lanes[k % 8].uniform() for k in range(8 * (n // 8 + 1))]

    def words(self):
        return [list(row) for row in zip(*(lane.words() for lane in self.lanes), strict=True)]


# Geometry: a segment is given by its end points (x0, y0), (x1, y1) with x0 < x1.


def added(numbers):
    """Return the sum, rounded after each term as in kernels; `sum` compensates from Python 3.12 on."""
    total = 0.0
    for number in numbers:
        total += number
    return total


def height(segment, x):
    (x0, y0), (x1, y1) = segment
    return y0 + (y1 - y0) / (x1 - x0) * (x - x0)


def mirrored(segment):
    return tuple((x, -y) for x, y in segment)


def circle_lift(cx, cy, radius, segment):
    """Return the shift up that puts the segment above the circle; None without an overlap in x.

    A line above the circle touches it at a tangent at distance `radius` from the centre. If that point is not
    over the segment, the end of the segment that is nearest to it counts.
    """
    (x0, y0), (x1, y1) = segment
    begin, end = max(x0, cx - radius), min(x1, cx + radius)
    if begin >= end - TOUCHING:
        return None
    angle = math.atan2(y1 - y0, x1 - x0)
    touch = cx - radius * math.sin(angle)
    if begin <= touch <= end:
        return cy + radius / math.cos(angle) - height(segment, cx)
    x = begin if touch < begin else end
    half_chord = math.sqrt(max((radius - (x - cx)) * (radius + (x - cx)), 0.0))
    return cy + half_chord - height(segment, x)


def circle_shifts(cx, cy, radius, segment):
    up = circle_lift(cx, cy, radius, segment)
    if up is None:
        return None
    return up, circle_lift(cx, -cy, radius, mirrored(segment))


def chord(vertices, x):
    """Return the lowest and highest y of a convex polygon (counter-clockwise) at x, by its half planes."""
    low, high = -math.inf, math.inf
    for k in range(len(vertices)):
        (xa, ya), (xb, yb) = vertices[k - 1], vertices[k]
        if xa == xb:
            continue
        y = ya + (yb - ya) * ((x - xa) / (xb - xa))
        if xb > xa:  # the inside is on the left of an edge: above one that runs to the right
            low = max(low, y)
        else:
            high = min(high, y)
    return low, high


def polygon_shifts(vertices, segment):
    """Return the shifts up and down: the largest over all x at which a piecewise linear function breaks."""
    xs = [x for x, _ in vertices]
    begin, end = max(segment[0][0], min(xs)), min(segment[1][0], max(xs))
    if begin >= end - TOUCHING:
        return None
    up, down = -math.inf, -math.inf
    for x in [begin, end] + [x for x in xs if begin < x < end]:
        low, high = chord(vertices, x)
        up = max(up, high - height(segment, x))
        down = max(down, height(segment, x) - low)
    return up, down


def shifts(obstacle, segment):
    """Return the shifts (up, down) that clear an obstacle; None without contact."""
    if isinstance(obstacle, Circle):
        found = circle_shifts(obstacle.x, obstacle.y, obstacle.radius, segment)
    else:
        found = polygon_shifts(obstacle.vertices, segment)
    if found is None or found[0] <= 0 or found[1] <= 0:
        return None
    return found


def degree_of_collision(obstacle, segment):
    """Return the distance between the segment and its cleared parallel."""
    found = shifts(obstacle, segment)
    if found is None:
        return 0.0
    (x0, y0), (x1, y1) = segment
    return min(found) * math.cos(math.atan2(y1 - y0, x1 - x0))


# Paths: everything is turned into the frame of eq. 1, one obstacle and one segment at a time.


@cache
def turned_obstacles(scenario):
    (sx, sy), (tx, ty) = scenario.start, scenario.target
    angle = math.atan2(ty - sy, tx - sx)

    def turn(x, y):
        return (
            (x - sx) * math.cos(angle) + (y - sy) * math.sin(angle),
            (y - sy) * math.cos(angle) - (x - sx) * math.sin(angle),
        )

    turned = []
    for obstacle in scenario.obstacles:
        if isinstance(obstacle, Circle):
            turned.append(Circle(*turn(obstacle.x, obstacle.y), obstacle.radius))
        else:
            turned.append(Polygon(tuple(turn(*vertex) for vertex in obstacle.vertices)))
    return turned


def straight_line(scenario):
    return math.dist(scenario.start, scenario.target)


def waypoints(scenario, offsets):
    """Return (x', y') of start, waypoints and target."""
    spacing = straight_line(scenario) / (len(offsets) + 1)
    ys = [0.0, *(float(y) for y in offsets), 0.0]
    return [(j * spacing, y) for j, y in enumerate(ys)]


def map_points(scenario, offsets):
    """Return the map coordinates of start, waypoints and target."""
    (sx, sy), (tx, ty) = scenario.start, scenario.target
    length = straight_line(scenario)
    along, left = (((tx - sx) / length, (ty - sy) / length), (-(ty - sy) / length, (tx - sx) / length))
    return [
        (sx + x * along[0] + y * left[0], sy + x * along[1] + y * left[1])
        for x, y in waypoints(scenario, offsets)
    ]


@cache
def bounds(scenario: Scenario, num_waypoints: int):
    """Return the lowest and highest offset inside the workspace at each waypoint, by bisection."""
    x_min, y_min, x_max, y_max = scenario.workspace
    lower, upper = [], []
    for j in range(1, num_waypoints + 1):
        for sign, ends in ((-1.0, lower), (1.0, upper)):
            inside, outside = 0.0, 2 * math.hypot(x_max - x_min, y_max - y_min)
            for _ in range(200):
                middle = (inside + outside) / 2
                offsets = [0.0] * num_waypoints
                offsets[j - 1] = sign * middle
                x, y = map_points(scenario, offsets)[j]
                if x_min <= x <= x_max and y_min <= y <= y_max:
                    inside = middle
                else:
                    outside = middle
            ends.append(sign * inside)
    return lower, upper


def collision(scenario, offsets):
    points = waypoints(scenario, offsets)
    total = 0.0
    for j in range(len(points) - 1):
        for obstacle in turned_obstacles(scenario):
            total += degree_of_collision(obstacle, (points[j], points[j + 1]))
    return total


def length(scenario, offsets):
    points = waypoints(scenario, offsets)
    return math.fsum(math.dist(points[j], points[j + 1]) for j in range(len(points) - 1))


def evaluate(scenario, offsets, length_weight):
    """Return fitness and degree of collision."""
    collides = collision(scenario, offsets)
    return length_weight * length(scenario, offsets) + (1 - length_weight) * collides, collides


def clip(value, low, high):
    return low if value < low else high if value > high else value


def repaired(scenario, offsets, repair_degree):
    """Repair a path: one pass over segments and obstacles in order, each with the present waypoints."""
    n = len(offsets)
    lower, upper = bounds(scenario, n)
    offsets = [float(y) for y in offsets]
    for j in range(n + 1):
        for obstacle in turned_obstacles(scenario):
            points = waypoints(scenario, offsets)
            found = shifts(obstacle, (points[j], points[j + 1]))
            if found is None:
                continue
            up, down = found
            move = repair_degree * up if up <= down else -repair_degree * down
            for waypoint in (j, j + 1):
                if 1 <= waypoint <= n:
                    k = waypoint - 1
                    offsets[k] = clip(offsets[k] + move, lower[k], upper[k])
    return offsets


# Populations.


def summary(swarm, mean_weight):
    """Return E(P), mean and standard deviation of the collision, feasible share, diversity."""
    collisions = [member.collision for member in swarm.members]
    return *population_collision(collisions, mean_weight), diversity([m.position for m in swarm.members])


def diversity(positions):
    """Return the root mean square of the distances from the mean position."""
    mean = [statistics.mean(column) for column in zip(*positions, strict=True)]
    return math.sqrt(statistics.mean(math.dist(position, mean) ** 2 for position in positions))


def population_collision(collisions, mean_weight):
    """Return E(P), mean, standard deviation and feasible share (eq. 7)."""
    mean = statistics.mean(collisions)
    deviation = statistics.stdev(collisions) if len(collisions) > 1 else 0.0
    feasible = sum(value <= FEASIBLE for value in collisions) / len(collisions)
    return mean_weight * mean + (1 - mean_weight) * deviation, mean, deviation, feasible


def growth_box(positions, lower, upper):
    """Return the extremes of the population in each component; the bounds if it has no extent there."""
    box = []
    for k in range(len(lower)):
        values = [position[k] for position in positions]
        if min(values) < max(values):
            box.append((min(values), max(values)))
        else:
            box.append((lower[k], upper[k]))
    return [low for low, _ in box], [high for _, high in box]


def deletion_order(fitness, collisions):
    """Return the members in the order in which shrinking deletes them."""
    members = range(len(fitness))
    infeasible = [i for i in members if collisions[i] > FEASIBLE]
    feasible = [i for i in members if collisions[i] <= FEASIBLE]
    infeasible.sort(key=lambda i: (collisions[i], fitness[i], i), reverse=True)
    feasible.sort(key=lambda i: (fitness[i], i), reverse=True)
    return infeasible + feasible


def firefly_move(position, brighter, uniforms, lower, upper, noise, attractiveness, absorption):
    """Return the position after a move by eq. 13 to 15, inside the bounds."""
    squared = math.fsum((b - a) ** 2 for a, b in zip(position, brighter, strict=True))
    attraction = attractiveness * math.exp(-absorption * squared)
    return [
        clip(a + attraction * (b - a) + noise * (u - 0.5), low, high)
        for a, b, u, low, high in zip(position, brighter, uniforms, lower, upper, strict=True)
    ]
