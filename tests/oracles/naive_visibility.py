"""The exact shortest path among the obstacles of a scenario, by the whole tangent visibility graph.

All tangents are tested against all obstacles, and Dijkstra searches the graph. Coordinates are taken as they
are, so that it is exact only near the origin.

A point is a circle of radius zero here, so that every segment is a common tangent of two circles.
Points and directions of the plane are complex numbers.
"""

import cmath
import heapq
import math
from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import NoPathError
from swarm_gym.scenarios import Circle, Polygon, Scenario

# How deep a path may enter an obstacle, relative to the extent of the scenario: well above the
# rounding errors of tangent points, well below anything that matters.
RELATIVE_TOLERANCE = 1e-12
# Angle between two points of an arc in the polyline that is returned.
SAMPLING_ANGLE = math.radians(1.0)


def shortest_path(scenario: Scenario) -> tuple[float, NDArray[np.float64]]:
    """Return the shortest path from start to target that does not enter the interior of any obstacle.

    It may touch obstacles, pass between two that only touch each other, and leave the workspace. To
    enter by no more than `RELATIVE_TOLERANCE` times the extent of the scenario counts as touching.

    Returns:
        The length in map units, and the path as a polyline in map coordinates, shape (k, 2). The
        length is that of the path itself; the points lie on the path, and between two points of an
        arc the polyline cuts the corner.

    Raises:
        ScenarioError: if the obstacles separate start and target.
    """
    circles = [o for o in scenario.solids if isinstance(o, Circle)]
    polygons = [o for o in scenario.solids if isinstance(o, Polygon)]
    discs = [_Disc(complex(circle.x, circle.y), circle.radius) for circle in circles]
    obstacles: list[_Disc | _HalfPlanes] = [*discs, *map(_HalfPlanes.of, polygons)]
    corners = [vertex for polygon in polygons for vertex in polygon.vertices]
    ends_and_corners = [_Disc(complex(*point), 0.0) for point in (scenario.start, scenario.target, *corners)]
    sites = [*ends_and_corners, *discs]
    extent = max(abs(site.centre - sites[0].centre) + site.radius for site in sites)

    graph = _Graph(sites, obstacles, RELATIVE_TOLERANCE * extent)
    length, points = graph.shortest_path()
    if not points:
        raise NoPathError(f"scenario {scenario.name!r}: the obstacles separate start and target")
    return length, np.array([(point.real, point.imag) for point in points])


class _Chord(NamedTuple):
    """A line that cuts a circle: its unit normal, and its distance from the centre along that."""

    normal: complex
    distance: float


class _Disc(NamedTuple):
    """A circle, or a point if its radius is zero."""

    centre: complex
    radius: float

    def depth(self, point: complex) -> float:
        """Return the distance of a point from the outside; negative at a point outside."""
        return self.radius - abs(point - self.centre)

    def is_entered(self, p: complex, q: complex, tolerance: float) -> bool:
        """Return whether the segment p q comes deeper than the tolerance."""
        along = q - p
        square = abs(along) ** 2
        t = ((self.centre - p) * along.conjugate()).real / square if square > 0.0 else 0.0
        return self.depth(p + min(max(t, 0.0), 1.0) * along) > tolerance

    def chords(self, disc: "_Disc") -> list[_Chord]:
        """Return lines through all points where the outline of this obstacle crosses that of a disc."""
        between = self.centre - disc.centre
        gap = abs(between)
        if gap == 0.0:
            return []
        return [_Chord(between / gap, (gap**2 + disc.radius**2 - self.radius**2) / (2 * gap))]


class _HalfPlanes(NamedTuple):
    """A convex polygon: unit normals that point inside, and where the edges lie along them."""

    normals: list[complex]
    offsets: list[float]

    @classmethod
    def of(cls, polygon: Polygon) -> "_HalfPlanes":
        ends = [(complex(*a), complex(*b)) for a, b in polygon.edges()]
        normals = [1j * (b - a) / abs(b - a) for a, b in ends]
        offsets = [_dot(normal, a) for normal, (a, _) in zip(normals, ends, strict=True)]
        return cls(normals, offsets)

    def depth(self, point: complex) -> float:
        """Return the distance of a point from the outside; negative at a point outside."""
        return min(_dot(n, point) - o for n, o in zip(self.normals, self.offsets, strict=True))

    def is_entered(self, p: complex, q: complex, tolerance: float) -> bool:
        """Return whether the segment p q, clipped edge by edge, comes deeper than the tolerance."""
        begin, end = 0.0, 1.0
        for normal, offset in zip(self.normals, self.offsets, strict=True):
            depth = _dot(normal, p) - offset - tolerance
            change = _dot(normal, q - p)
            if depth <= 0.0 and depth + change <= 0.0:
                return False
            if depth < 0.0:
                begin = max(begin, -depth / change)
            elif depth + change < 0.0:
                end = min(end, -depth / change)
        return begin < end

    def chords(self, disc: _Disc) -> list[_Chord]:
        """Return lines through all points where the outline of this obstacle crosses that of a disc."""
        return [
            _Chord(normal, offset - _dot(normal, disc.centre))
            for normal, offset in zip(self.normals, self.offsets, strict=True)
        ]


class _Arc(NamedTuple):
    disc: _Disc
    begin: float
    angle: float

    def samples(self) -> list[complex]:
        """Points inside the arc, in order."""
        pieces = max(1, math.ceil(abs(self.angle) / SAMPLING_ANGLE))
        return [
            self.disc.centre + cmath.rect(self.disc.radius, self.begin + self.angle * k / pieces)
            for k in range(1, pieces)
        ]


class _Edge(NamedTuple):
    node: int
    length: float
    arc: _Arc | None


class _Graph:
    """All segments and arcs that a shortest path can consist of; nodes are their ends.

    The first two sites are start and target.
    """

    def __init__(self, sites: list[_Disc], obstacles: list[_Disc | _HalfPlanes], tolerance: float):
        self.sites = sites
        self.obstacles = obstacles
        self.tolerance = tolerance
        self.points: list[complex] = []
        self.edges: list[list[_Edge]] = []
        # Of every site the angles of the nodes on it; a point has a single node.
        self.nodes: list[list[tuple[float, int]]] = [[] for _ in sites]
        self.ends = self._node(0, 0j), self._node(1, 0j)
        self._add_segments()
        for number, site in enumerate(sites):
            if site.radius > 0.0:
                self._add_arcs(number, site)

    def shortest_path(self) -> tuple[float, list[complex]]:
        """Length and points of the shortest path (Dijkstra); without points if there is none."""
        start, target = self.ends
        distance = [math.inf] * len(self.points)
        distance[start] = 0.0
        arrival: dict[int, tuple[int, _Arc | None]] = {}
        queue = [(0.0, start)]
        while queue:
            so_far, node = heapq.heappop(queue)
            if so_far > distance[node]:
                continue
            for edge in self.edges[node]:
                if so_far + edge.length < distance[edge.node]:
                    distance[edge.node] = so_far + edge.length
                    arrival[edge.node] = node, edge.arc
                    heapq.heappush(queue, (distance[edge.node], edge.node))
        if target not in arrival:
            return math.inf, []
        points, node = [self.points[target]], target
        while node != start:
            node, arc = arrival[node]
            points += arc.samples()[::-1] if arc else []
            points.append(self.points[node])
        return distance[target], points[::-1]

    def _add_segments(self) -> None:
        for (i, a), (j, b) in combinations(enumerate(self.sites), 2):
            for to_a, to_b in _tangents(a, b, self.tolerance):
                p, q = a.centre + a.radius * to_a, b.centre + b.radius * to_b
                if not any(o.is_entered(p, q, self.tolerance) for o in self.obstacles):
                    self._connect(self._node(i, to_a), self._node(j, to_b), abs(q - p))

    def _add_arcs(self, number: int, disc: _Disc) -> None:
        """Add the free arcs of a circle, cut where other obstacles begin or end."""
        others = [obstacle for obstacle in self.obstacles if obstacle is not disc]
        for other in others:
            for chord in other.chords(disc):
                if abs(chord.distance) <= disc.radius:
                    for side in (1, -1):
                        half = cmath.rect(1.0, side * math.acos(chord.distance / disc.radius))
                        self._node(number, chord.normal * half)
        nodes = sorted(self.nodes[number])
        for (begin, here), (end, there) in pairwise([*nodes, *nodes[:1]]):
            angle = (end - begin) % math.tau
            middle = disc.centre + cmath.rect(disc.radius, begin + angle / 2)
            # Nothing begins or ends inside the arc, so its middle stands for all of it.
            if not any(other.depth(middle) > self.tolerance for other in others):
                self._connect(here, there, disc.radius * angle, _Arc(disc, begin, angle))

    def _node(self, number: int, direction: complex) -> int:
        """Find or make the node of a site in a direction from its centre."""
        site, known = self.sites[number], self.nodes[number]
        if site.radius == 0.0 and known:
            return known[0][1]
        node = len(self.points)
        self.points.append(site.centre + site.radius * direction)
        self.edges.append([])
        known.append((cmath.phase(direction) % math.tau, node))
        return node

    def _connect(self, a: int, b: int, length: float, arc: _Arc | None = None) -> None:
        back = arc and _Arc(arc.disc, arc.begin + arc.angle, -arc.angle)
        self.edges[a].append(_Edge(b, length, arc))
        self.edges[b].append(_Edge(a, length, back))


def _tangents(a: _Disc, b: _Disc, tolerance: float) -> Iterator[tuple[complex, complex]]:
    """Give both ends of all common tangents of two circles, as unit directions from the centres."""
    between = b.centre - a.centre
    gap = abs(between)
    crossings = (1, -1) if a.radius > 0.0 and b.radius > 0.0 else (1,)
    sides = (1, -1) if a.radius > 0.0 or b.radius > 0.0 else (1,)
    for crossing in crossings:  # -1: the tangent passes between the circles
        step = a.radius - crossing * b.radius
        if gap <= tolerance or abs(step) > gap + tolerance:
            continue
        rise = math.sqrt(max(0.0, (gap - step) * (gap + step)))
        for side in sides:
            direction = between / gap * complex(step, side * rise) / math.hypot(step, rise)
            yield direction, crossing * direction


def _dot(a: complex, b: complex) -> float:
    return a.real * b.real + a.imag * b.imag
