"""Plain-Python oracles for paths on grid maps: loops straight from the MOA paper and its readings.

Everything is done in map coordinates, point by point; the kernels work in cells, on tables of weights. Shared
with the package are only the classes that describe a scenario, and the table of nearest free cells, of which
there may be several: that they are nearest is a test of its own.
"""

import itertools
import math

from oracles import naive

# Samples of a Bezier curve; the least number of them along waypoints, of which each segment has as many as
# another, a multiple of eight.
NUM_SAMPLES = 1000
LEAST_WEIGHT = 1 / 3
NEARLY = 1e-9


def cell_of(grid, x, y):
    """(column, row) of the cell that a point lies in."""
    (left, top), side = grid.origin, grid.resolution
    rows_down = (top - y) if grid.y_up else (y - top)
    return math.floor((x - left) / side + 0.5), math.floor(rows_down / side + 0.5)


def centre_of(grid, column, row):
    (left, top), side = grid.origin, grid.resolution
    return left + column * side, top - row * side if grid.y_up else top + row * side


def extremes_of_centres(grid):
    """Least and largest x, and y, of the centres of cells."""
    height, width = grid.blocked.shape
    corners = centre_of(grid, 0, 0), centre_of(grid, width - 1, height - 1)
    return [(min(pair), max(pair)) for pair in zip(*corners, strict=True)]


def is_blocked(grid, column, row):
    height, width = grid.blocked.shape
    return not (0 <= column < width and 0 <= row < height) or bool(grid.blocked[row, column])


def de_casteljau(points, t):
    while len(points) > 1:
        points = [((1 - t) * a + t * c, (1 - t) * b + t * d) for (a, b), (c, d) in itertools.pairwise(points)]
    return points[0]


def bernstein(degree, i, t):
    return math.comb(degree, i) * t**i * (1 - t) ** (degree - i)


class Bezier:
    """A curve whose free control points are all x, then all y of the decision vector."""

    def __init__(self, scenario, num_points):
        self.scenario, self.num_points, self.dimension = scenario, num_points, 2 * num_points
        extremes = extremes_of_centres(scenario.map)
        self.lower, self.upper = [[ends[k] for ends in extremes for _ in range(num_points)] for k in (0, 1)]

    def beside_the_line(self, offsets):
        """Return the vector whose control points are evenly spaced, at these offsets from the line."""
        points = naive.map_points(self.scenario, offsets)[1:-1]
        return [x for x, _ in points] + [y for _, y in points]

    def control_points(self, vector):
        d = self.num_points
        return [self.scenario.start, *((vector[i], vector[d + i]) for i in range(d)), self.scenario.target]

    def samples(self, vector):
        points = self.control_points(vector)
        return [de_casteljau(points, k / (NUM_SAMPLES - 1)) for k in range(NUM_SAMPLES)]

    def weights(self, sample):
        """Return the weights of the free control points in a sample."""
        t, degree = sample / (NUM_SAMPLES - 1), self.num_points + 1
        return [bernstein(degree, i, t) for i in range(1, degree)]

    def move(self, vector, i, dx, dy):
        for k, by in ((i, dx), (self.num_points + i, dy)):
            vector[k] = naive.clip(vector[k] + by, self.lower[k], self.upper[k])


class Waypoints:
    """A polyline; component i of the decision vector is the offset of waypoint i to the left."""

    def __init__(self, scenario, num_points):
        self.scenario, self.num_points, self.dimension = scenario, num_points, num_points
        self.lower, self.upper = self.bounds()
        self.per_segment = math.ceil(NUM_SAMPLES / (num_points + 1) / 8) * 8

    def bounds(self):
        """Between the centres of the outermost cells; an offset of 0 is always allowed."""
        line, beside = (
            self.control_points([0.0] * self.num_points),
            self.control_points([1.0] * self.num_points),
        )
        lower, upper = [], []
        for foot, point in zip(line[1:-1], beside[1:-1], strict=True):
            low, high = -math.inf, math.inf
            for axis, ends in enumerate(extremes_of_centres(self.scenario.map)):
                rate = point[axis] - foot[axis]
                if abs(rate) > 1e-12:
                    offsets = [(end - foot[axis]) / rate for end in ends]
                    low, high = max(low, min(offsets)), min(high, max(offsets))
            lower.append(min(low, 0.0))
            upper.append(max(high, 0.0))
        return lower, upper

    def beside_the_line(self, offsets):
        return list(offsets)

    def control_points(self, vector):
        return naive.map_points(self.scenario, vector)

    def samples(self, vector):
        points, m = self.control_points(vector), self.per_segment
        samples = []
        for (a, b), (c, d) in itertools.pairwise(points):
            samples += [(a + k / m * (c - a), b + k / m * (d - b)) for k in range(m)]
        return [*samples, self.scenario.target]

    def weights(self, sample):
        segment, k = divmod(sample, self.per_segment)
        weights = [0.0] * (self.num_points + 3)  # start, waypoints, target, and nothing behind it
        weights[segment], weights[segment + 1] = 1 - k / self.per_segment, k / self.per_segment
        return weights[1 : self.num_points + 1]

    def move(self, vector, i, dx, dy):
        (sx, sy), (tx, ty) = self.scenario.start, self.scenario.target
        length = math.dist((sx, sy), (tx, ty))
        left = (dy * (tx - sx) - dx * (ty - sy)) / length
        vector[i] = naive.clip(vector[i] + left, self.lower[i], self.upper[i])


class Problem:
    """The oracle of a `GridProblem`."""

    def __init__(self, problem):
        kind = {"bezier": Bezier, "waypoints": Waypoints}[problem.encoding]
        self.map, self.penalty = problem.scenario.map, problem.penalty
        self.path = kind(problem.scenario, problem.num_points)
        self.dimension, self.lower, self.upper = self.path.dimension, self.path.lower, self.path.upper
        self.initial_lower, self.initial_upper = self.lower, self.upper
        self.unit_length = math.sqrt(self.dimension)
        self._nearest = problem.table.nearest
        self.num_points, self.ways = problem.num_points, problem.ways
        across = Waypoints(problem.scenario, self.num_points)
        self.width = max(high - low for low, high in zip(across.lower, across.upper, strict=True))

    def beside_the_line(self, offsets):
        return self.path.beside_the_line(offsets)

    def nearest_free(self, column, row):
        """The free cell that the package takes for the nearest one of a cell, or of the border beside it."""
        height, width = self.map.blocked.shape
        column, row = naive.clip(column, -1, width), naive.clip(row, -1, height)
        return tuple(self._nearest[(row + 1) * (width + 2) + column + 1].tolist())

    def infeasible(self, vector):
        """Return for each sample whether its cell is blocked or outside the map."""
        return self.are_infeasible(self.path.samples(vector))

    def are_infeasible(self, samples):
        return [is_blocked(self.map, *cell_of(self.map, *point)) for point in samples]

    def cost(self, vector):
        """Fitness and degree of collision."""
        samples = self.path.samples(vector)
        pieces = list(itertools.pairwise(samples))
        length = math.fsum(math.dist(a, b) for a, b in pieces)
        blocked = math.fsum(self.blocked_length(a, b) for a, b in pieces)
        return length + self.penalty * len(pieces) * blocked / length, blocked

    def sampled_fitness(self, vector):
        """Fitness as the MOA paper has it: a penalty for each infeasible sample."""
        samples = self.path.samples(vector)
        length = math.fsum(math.dist(a, b) for a, b in itertools.pairwise(samples))
        return length + self.penalty * sum(self.are_infeasible(samples))

    def blocked_length(self, a, b):
        """Length of a segment in blocked cells; grid lines cut it, and the middle of a part stands for it."""
        (left, top), side = self.map.origin, self.map.resolution
        shares = {0.0, 1.0}
        for axis, first in enumerate((left, top)):
            begin, end = sorted((a[axis], b[axis]))
            if begin == end:
                continue
            for line in range(
                math.ceil((begin - first) / side - 0.5), math.floor((end - first) / side - 0.5) + 1
            ):
                share = (first + (line + 0.5) * side - a[axis]) / (b[axis] - a[axis])
                shares.add(naive.clip(share, 0.0, 1.0))
        blocked = 0.0
        for begin, end in itertools.pairwise(sorted(shares)):
            middle = [p + (begin + end) / 2 * (q - p) for p, q in zip(a, b, strict=True)]
            if is_blocked(self.map, *cell_of(self.map, *middle)):
                blocked += end - begin
        return blocked * math.dist(a, b)

    def runs(self, vector):
        """Lists of consecutive infeasible samples."""
        runs, flags = [], self.infeasible(vector)
        for k, flag in enumerate(flags):
            if flag and k > 0 and flags[k - 1]:
                runs[-1].append(k)
            elif flag:
                runs.append([k])
        return runs

    def repaired(self, vector, repair_degree):
        samples, moves = self.path.samples(vector), [[0.0, 0.0] for _ in range(self.path.num_points)]
        for run in self.runs(vector):
            ways = []
            for k in run:
                cell = cell_of(self.map, *samples[k])
                free = centre_of(self.map, *self.nearest_free(*cell))
                ways.append((free[0] - samples[k][0], free[1] - samples[k][1]))
            columns = zip(*(self.path.weights(k) for k in run), strict=True)
            weights = [math.fsum(column) / len(run) for column in columns]
            heaviest = 0
            for k, weight in enumerate(weights):
                if weight > (1.0 + NEARLY) * weights[heaviest]:
                    heaviest = k
            for axis in (0, 1):
                mean = math.fsum(way[axis] for way in ways) / len(run)
                moves[heaviest][axis] += mean / max(weights[heaviest], LEAST_WEIGHT)
        vector = [float(value) for value in vector]
        for i, (dx, dy) in enumerate(moves):
            if dx or dy:
                self.path.move(vector, i, repair_degree * dx, repair_degree * dy)
        return vector
