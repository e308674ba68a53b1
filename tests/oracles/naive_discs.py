"""The shortest path of a disc on an occupancy grid, by shapely and a graph of all tangents, in plain Python.

Nodes are the points where common tangents touch the circles around all corners of blocked cells. Edges are
the tangents, and the arcs between neighbours on a circle. What is free, shapely's distances say.
"""

import math

import numpy as np
import scipy.sparse
import shapely

from helpers.grids import area_of

TOUCHING = 1e-9  # how much closer than its radius the disc may come
SAMPLES = 24  # points of an arc that are tested


def shortest_disc_path(blocked, radius, start, goal):
    """Return the length of the path of the centre, in cells; infinite if there is none."""
    if not blocked.any():
        return math.dist(start, goal)
    area = area_of(blocked).simplify(0.0)
    height, width = blocked.shape
    grid = shapely.box(-0.5, -0.5, width - 0.5, height - 0.5).buffer(TOUCHING)

    def free(shapes):
        return (shapely.distance(shapes, area) >= radius - TOUCHING) & shapely.covers(grid, shapes)

    if not free(shapely.points([start, goal])).all():
        return math.inf
    corners = np.unique(shapely.get_coordinates(area), axis=0)
    nodes, edges, on_circle = [start, goal], [(0, 1)], {}

    def touching(circle, angle):
        x, y = corners[circle]
        nodes.append((x + radius * math.cos(angle), y + radius * math.sin(angle)))
        on_circle.setdefault(circle, []).append((angle % math.tau, len(nodes) - 1))
        return len(nodes) - 1

    for one, (x, y) in enumerate(corners):
        for node, (from_x, from_y) in enumerate((start, goal)):
            distance = math.hypot(from_x - x, from_y - y)
            half = math.acos(min(radius / distance, 1.0))
            ahead = math.atan2(from_y - y, from_x - x)
            edges += [(node, touching(one, ahead + sign * half)) for sign in (-1, 1)]
        for other in range(one + 1, len(corners)):
            to_x, to_y = corners[other] - (x, y)
            distance, ahead = math.hypot(to_x, to_y), math.atan2(to_y, to_x)
            for sign in (-1, 1):
                angle = ahead + sign * math.pi / 2
                edges.append((touching(one, angle), touching(other, angle)))
                if distance >= 2 * radius - TOUCHING:
                    angle = ahead + sign * math.acos(min(2 * radius / distance, 1.0))
                    edges.append((touching(one, angle), touching(other, angle + math.pi)))
    points = np.array(nodes)
    ends = np.array(edges)
    ends = ends[free(shapely.linestrings(points[ends]))]
    lengths = np.hypot(*(points[ends[:, 0]] - points[ends[:, 1]]).T)
    arcs, arc_lengths, samples = [], [], []
    for circle, touched in on_circle.items():
        touched.sort()
        for (angle, node), (following, neighbour) in zip(touched, touched[1:] + touched[:1], strict=True):
            turn = (following - angle) % math.tau
            arcs.append((node, neighbour))
            arc_lengths.append(radius * turn)
            angles = angle + turn * np.linspace(0.0, 1.0, SAMPLES)
            samples.append(corners[circle] + radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1))
    if arcs:
        passable = free(shapely.points(np.array(samples).reshape(-1, 2))).reshape(-1, SAMPLES).all(axis=1)
        ends = np.concatenate([ends, np.array(arcs)[passable]])
        lengths = np.concatenate([lengths, np.array(arc_lengths)[passable]])
    # Sparse graphs have no edges of length 0, and add up edges that occur twice.
    lengths = np.maximum(lengths, 1e-13)
    order = np.lexsort((lengths, ends.max(axis=1), ends.min(axis=1)))
    ends, lengths = np.sort(ends, axis=1)[order], lengths[order]
    kept = np.append(True, (np.diff(ends, axis=0) != 0).any(axis=1))
    graph = scipy.sparse.csr_array((lengths[kept], ends[kept].T), shape=(len(nodes), len(nodes)))
    return float(scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=0)[1])
