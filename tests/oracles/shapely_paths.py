"""Exact shortest paths around a union of polygons and discs, by shapely, NumPy and a heap alone.

A path may touch the boundary of the union. It never runs along an edge inside it, because only the union
counts. Where obstacles touch in a single point, a point robot passes through.

The graph is that of common tangents. Its sites are circles: the convex corners of the union with the robot's
radius, the grown discs, and both ends. A corner for a point robot is a circle of radius 0. Each circle is cut
into arcs wherever the boundary of something else crosses it.
"""

import heapq
import math
from collections import defaultdict

import numpy as np

from oracles.entered_depth import Blocked

SIGNS = np.array([(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)])


def shortest_length(blocked: Blocked, start, goal):
    """Return the length of the shortest path between two points (x, y); infinite if there is none."""
    return shortest_route(blocked, start, goal)[0]


def shortest_route(blocked: Blocked, start, goal):
    """Return the length of the shortest path, and its points (k, 2); arcs join points on a circle.

    Raises:
        ValueError: if an end lies inside the grown union.
    """
    ends = np.array([complex(*start), complex(*goal)])
    if blocked.points_inside(ends).any():
        raise ValueError(f"an end of {start}, {goal} lies inside the union")
    if ends[0] == ends[1]:
        return 0.0, np.array([start, goal], dtype=float)
    graph = _Graph(blocked, ends)
    return graph.search()


class _Graph:
    """Points on circles, joined by free tangents and free arcs.

    Attributes:
        points: the nodes, as complex numbers; start and goal are the first two.
        neighbours: number of a node -> list of (number of another node, length between them).
    """

    def __init__(self, blocked, ends):
        self.blocked = blocked
        corners, quarters = _corners(blocked)
        discs, radii = blocked.grown_discs
        self.centres = np.concatenate([ends, corners, discs])
        self.radii = np.concatenate([[0.0, 0.0], np.full(len(corners), blocked.radius), radii])
        self.quarters = np.concatenate([np.zeros((2, 2)), quarters, np.zeros((len(discs), 2))])
        self.points = list(self.centres)  # the node of a site of radius 0 has the number of the site
        self.on_circle = defaultdict(list)  # number of a site -> its nodes
        self.neighbours = defaultdict(list)
        self._add_tangents()
        for site in np.flatnonzero(self.radii > 0.0):
            self._add_arcs(site)

    def search(self):
        """Return the length of the shortest path from node 0 to node 1, and its points."""
        lengths, before, heap = {0: 0.0}, {}, [(0.0, 0)]
        while heap:
            length, node = heapq.heappop(heap)
            if node == 1:
                way = [1]
                while way[-1] != 0:
                    way.append(before[way[-1]])
                points = np.array([self.points[k] for k in reversed(way)])
                return length, np.stack([points.real, points.imag], axis=-1)
            if length > lengths[node]:
                continue
            for other, step in self.neighbours[node]:
                if length + step < lengths.get(other, math.inf):
                    lengths[other], before[other] = length + step, node
                    heapq.heappush(heap, (length + step, other))
        return math.inf, np.empty((0, 2))

    def _add_tangents(self):
        i, j = np.triu_indices(len(self.centres), 1)
        for sign_i, sign_j in SIGNS:
            # A circle of radius 0 has one side only.
            chosen = ((self.radii[i] > 0.0) | (sign_i > 0)) & ((self.radii[j] > 0.0) | (sign_j > 0))
            a, b = i[chosen], j[chosen]
            begins, ends, exists = _tangents(
                self.centres[a], sign_i * self.radii[a], self.centres[b], sign_j * self.radii[b],
                self.blocked.tolerance,
            )  # fmt: skip
            a, b, begins, ends = a[exists], b[exists], begins[exists], ends[exists]
            free = self._free(a, b, begins, ends)
            for at, to, begin, end in zip(a[free], b[free], begins[free], ends[free], strict=True):
                self._connect(self._node(at, begin), self._node(to, end), abs(end - begin))

    def _free(self, a, b, begins, ends):
        steps = ends - begins
        free = _in_quarter(self.quarters[a], steps) & _in_quarter(self.quarters[b], -steps)
        for x, y in self.blocked.pinches[:, :2]:
            share = ((x + 1j * y - begins) * steps.conj()).real / np.maximum(np.abs(steps) ** 2, 1e-300)
            away = np.abs(begins + share * steps - (x + 1j * y))
            free &= (away > self.blocked.tolerance) | (share < 1e-9) | (share > 1.0 - 1e-9)
        free[free] = ~self.blocked.segments_inside(begins[free], ends[free])
        return free

    def _add_arcs(self, site):
        """Join neighbouring nodes on a circle by arcs; where something crosses the circle is a node, too."""
        centre, radius = self.centres[site], self.radii[site]
        for angle in _crossings(self.blocked, self.centres, self.radii, centre, radius):
            self._node(site, centre + radius * np.exp(1j * angle))
        nodes = np.array(self.on_circle[site], dtype=int)
        if not len(nodes):
            return
        angles = np.angle(np.array([self.points[node] for node in nodes]) - centre)
        order = np.argsort(angles)
        nodes, angles = nodes[order], angles[order]
        spans = np.diff(angles, append=angles[0] + math.tau)
        middles = centre + radius * np.exp(1j * (angles + spans / 2))
        for k in np.flatnonzero(~self.blocked.points_inside(middles)):
            self._connect(nodes[k], nodes[(k + 1) % len(nodes)], radius * spans[k])

    def _node(self, site, point):
        if self.radii[site] == 0.0:
            return int(site)
        self.points.append(point)
        self.on_circle[site].append(len(self.points) - 1)
        return len(self.points) - 1

    def _connect(self, a, b, length):
        self.neighbours[a].append((b, length))
        self.neighbours[b].append((a, length))


def _corners(blocked):
    """Return the corners around which a path can turn, and for each the quarter it is bound to, or (0, 0)."""
    begins, ends = blocked.edges
    pinches = blocked.pinches
    at = pinches[:, 0] + 1j * pinches[:, 1]
    steps = ends - begins
    # The edge before each corner is the one that ends there, which in a ring is the one before it.
    edge_before = {}
    for k, end in enumerate(ends):
        edge_before.setdefault(end, []).append(k)
    convex = {
        begin
        for begin, step in zip(begins, steps, strict=True)
        if any(_cross(steps[k], step) > 0.0 for k in edge_before[begin])
    }
    corners = np.array(sorted(convex - set(at), key=lambda z: (z.real, z.imag)), dtype=complex)
    quarters = np.concatenate([np.zeros((len(corners), 2)), pinches[:, 2:]])
    return np.concatenate([corners, at]), quarters


def _in_quarter(quarters, steps):
    return (quarters[:, 0] * steps.real >= 0.0) & (quarters[:, 1] * steps.imag >= 0.0)


def _tangents(p, a, q, b, tolerance):
    """Return begins and ends of common tangents of circles, and which exist; a and b are signed radii.

    A tangent with unit normal n touches at p + a n and q + b n, so n (q - p) = a - b.
    """
    steps = q - p
    distances = np.abs(steps)
    exists = (np.abs(a - b) <= distances + tolerance) & (distances > 0.0)
    distances = np.where(exists, distances, 1.0)
    cosines = np.clip((a - b) / distances, -1.0, 1.0)
    normals = steps / distances * (cosines + 1j * np.sqrt(1.0 - cosines**2))
    return p + a * normals, q + b * normals, exists


def _crossings(blocked, centres, radii, centre, radius):
    """Return the angles on a circle at which circles, grown edges and the sides of the box cross it."""
    steps = centres - centre
    distances = np.abs(steps)
    others = (distances > 0.0) & (radii > 0.0)
    steps, distances, radii = steps[others], distances[others], radii[others]
    found = [_angles(steps, (distances**2 + radius**2 - radii**2) / (2.0 * distances * radius))]
    begins, ends = blocked.edges
    normals = 1j * (ends - begins) / np.abs(ends - begins)
    heights = ((begins - centre) * normals.conj()).real
    sides = {-blocked.radius, blocked.radius}
    found += [_angles(normals, (heights + side) / radius) for side in sides]
    if blocked.box is not None:
        x0, y0, x1, y1 = blocked.box
        outward = np.array([-1.0, -1j, 1.0, 1j])
        heights = np.array([centre.real - x0, centre.imag - y0, x1 - centre.real, y1 - centre.imag])
        found.append(_angles(outward, heights / radius))
    return np.concatenate(found)


def _angles(directions, cosines):
    """Return the angles of unit vectors that have these cosines with the directions, where there are some."""
    some = np.abs(cosines) <= 1.0 + 1e-9
    middle, half = np.angle(directions[some]), np.arccos(np.clip(cosines[some], -1.0, 1.0))
    return np.concatenate([middle - half, middle + half])


def _cross(a, b):
    return a.real * b.imag - a.imag * b.real
