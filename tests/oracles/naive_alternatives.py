"""The oracle of alternatives: exact shortest paths by the sides of obstacles, with shapely."""

import heapq
import itertools
import math

import shapely

from oracles.naive_corridors import winding_number


def shortest_by_sides(blocked, posts, start, goal, longest):
    """Return the shortest path of each class up to a length: {sides: (length, points)}.

    It is Dijkstra's algorithm over the corners of a shape that see each other. A path passes a post
    above as often as it crosses the ray upwards from it to the right. Crossings back are subtracted.

    Args:
        blocked: shape of all obstacles.
        posts: a point (x, y) in each obstacle; no corner has its x.
        start: (x, y) of the start.
        goal: (x, y) of the goal.
        longest: length of the longest path.
    """
    corners = set(map(tuple, shapely.get_coordinates(blocked).tolist()))
    nodes = [start, *sorted(corners), goal]
    core = blocked.buffer(-1e-7)
    sees = {node: [] for node in nodes}
    for one, other in itertools.permutations(nodes, 2):
        if not shapely.LineString([one, other]).intersects(core):
            sees[one].append(other)
    queue, best, found = [(0.0, start, (0,) * len(posts), None)], set(), {}
    while queue:
        length, node, sides, before = heapq.heappop(queue)
        if (node, sides) in best:
            continue
        best.add((node, sides))
        if node == goal:
            found[sides] = (length, _points((node, before)))
            continue
        for onward in sees[node]:
            reached = length + math.dist(node, onward)
            if reached <= longest:
                passed = tuple(
                    side + _crossing(node, onward, post) for side, post in zip(sides, posts, strict=True)
                )
                heapq.heappush(queue, (reached, onward, passed, (node, before)))
    return found


def sides_between(path, other, posts):
    """Return how often the closed curve of two paths with the same ends winds around each post."""
    closed = [*map(tuple, path), *map(tuple, other[-2:0:-1])]
    return tuple(winding_number(closed, post) for post in posts)


def _crossing(one, other, post):
    if (one[0] < post[0]) == (other[0] < post[0]):
        return 0
    y = one[1] + (other[1] - one[1]) * (post[0] - one[0]) / (other[0] - one[0])
    return 0 if y < post[1] else 1 if other[0] > one[0] else -1


def _points(reached):
    points = []
    while reached is not None:
        node, reached = reached
        points.append(node)
    return points[::-1]
