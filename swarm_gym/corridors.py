"""Corridors: on which sides of the obstacles paths pass, and how many such ways a population has found.

Every obstacle has a post, one point inside it. The signature of a path says for each post how often the path
passes to its left, seen from the start towards the target: 1 if it passes there once, 0 if it passes to the
right. A pass backwards counts -1. Two paths with the same ends have the same signature exactly if the closed
curve of both winds around no post. Such paths are in one corridor. So corridors are homology classes; only
homotopy classes, which also know the order of turns around several posts, can be finer.

Source: S. Bhattacharya, M. Likhachev, V. Kumar, "Topological constraints in search-based robot path
planning", Autonomous Robots 33(3), 2012. The paper places a point in each obstacle, too, and integrates a
complex function along the path. Signed crossings of a ray from each point tell the same classes apart.

| map | obstacles | post |
|---|---|---|
| circles and polygons | all; those that overlap or touch are one | the middle of the first one |
| cells | blocked cells that touch at sides or corners, off the border; the 64 largest | the deepest cell |
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.errors import SettingError
from swarm_gym.problem import AnalyticProblem, GridProblem, Problem
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes
from swarm_gym.problem.grid.encoding import BezierCurve
from swarm_gym.scenarios import Circle, GridMap, Obstacle, Point

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_GRID_POSTS = 64  # largest components of blocked cells that count; cost grows with their number
CURVE_STEP = 16  # of so many samples of a curve, the first is a point of the path that is classified


class Posts(NamedTuple):
    """The posts of a map, and the direction from the start to the target."""

    points: Floats  # (P, 2) posts in map coordinates
    forward: Floats  # (2,) unit vector


@dataclass(frozen=True, eq=False)
class Corridors:
    """The corridors of a problem, for its decision vectors.

    Attributes:
        problem: the problem.
        posts: posts of its map.
        points: function that turns decision vectors, (m, dimension), into paths, (m, k, 2). A Bezier curve
            is a polyline through every 16th sample and the last.
    """

    problem: Problem
    posts: Posts
    points: Callable[[Floats], Floats]

    @classmethod
    def of(cls, problem: Problem) -> "Corridors":
        """Return the corridors of a problem.

        Raises:
            SettingError: if decision vectors are not whole paths on a map.
        """
        posts = posts_of(problem)
        points = problem.points
        if isinstance(problem, GridProblem) and isinstance(problem.curve, BezierCurve):
            curve = problem.curve
            last = len(curve.first) - 1
            kept = np.append(np.arange(0, last, CURVE_STEP), last)
            weights = np.asfortranarray(curve.weights[kept])
            points = replace(curve, first=curve.first[kept], weights=weights).points
        return cls(problem, posts, points)

    def signatures(self, vectors: Floats) -> Integers:
        """Return the signatures, (m, P), of the paths of decision vectors, (m, dimension)."""
        return signatures(self.points(vectors), self.posts)

    def count(self, vectors: Floats) -> int:
        """Return the number of corridors in which the paths of decision vectors, (m, dimension), lie."""
        return count_corridors(self.points(vectors), self.posts)


class KnownCorridors:
    """The corridors of the problems of a simulation, made when they are first needed.

    A problem is known by its number. When another problem has taken that number, as happens when a robot
    drives, its corridors are made again.
    """

    def __init__(self) -> None:
        self._known: dict[int, Corridors] = {}

    def of(self, number: int, problem: Problem) -> Corridors:
        """Return the corridors of a problem, which has this number now.

        Raises:
            SettingError: if decision vectors are not whole paths on a map.
        """
        known = self._known.get(number)
        if known is None or known.problem is not problem:
            known = self._known[number] = Corridors.of(problem)
        return known


def require_paths(asked: str, problem: Problem) -> None:
    """Raise an error if the decision vectors of a problem are not whole paths on a map.

    Args:
        asked: name of the option that needs such paths, for the message.
        problem: the problem.

    Raises:
        SettingError: for walks and test functions.
    """
    if not isinstance(problem, AnalyticProblem | GridProblem):
        raise SettingError(
            f"{asked}: corridors are counted among members that are whole paths on a map, but scenario "
            f"{problem.scenario.name!r} gives a {type(problem).__name__} here; choose another layout, or "
            "waypoints or a Bezier curve on a map"
        )


def posts_of(problem: Problem) -> Posts:
    """Return the posts of the map of a problem.

    Raises:
        SettingError: if decision vectors are not whole paths on a map.
    """
    require_paths("posts", problem)
    assert isinstance(problem, AnalyticProblem | GridProblem)
    if isinstance(problem, AnalyticProblem):
        points = obstacle_posts(problem.scenario.obstacles, problem.scenario.tolerance)
    else:
        points = grid_posts(problem.scenario.map)
    axes = RotatedAxes.of(problem.scenario)
    return Posts(np.array(points, dtype=np.float64).reshape(-1, 2), np.array([axes.cosine, axes.sine]))


@lru_cache(maxsize=256)  # robots that drive get new problems on the same map
def obstacle_posts(obstacles: tuple[Obstacle, ...], tolerance: float) -> tuple[Point, ...]:
    """Return one post for each group of circles and polygons that are apart by a tolerance at most.

    The post lies in the first obstacle of the group: the centre of a circle, the mean of a polygon's
    vertices.
    """
    cores = [_core(obstacle) for obstacle in obstacles]
    extents = np.array([(*(c.min(axis=0) - r), *(c.max(axis=0) + r)) for c, r in cores]).reshape(-1, 4)
    group = list(range(len(obstacles)))  # union-find: the number of an earlier member, or of itself

    def first(i: int) -> int:
        while group[i] != i:
            group[i] = group[group[i]]
            i = group[i]
        return i

    for i, j in combinations(range(len(obstacles)), 2):
        apart = max((extents[i, :2] - extents[j, 2:]).max(), (extents[j, :2] - extents[i, 2:]).max())
        if apart <= tolerance and first(i) != first(j) and _touch(*cores[i], *cores[j], tolerance):
            one, other = sorted((first(i), first(j)))
            group[other] = one
    posts = [cores[i][0].mean(axis=0).tolist() for i in range(len(obstacles)) if first(i) == i]
    return tuple((x, y) for x, y in posts)


@lru_cache(maxsize=64)
def grid_posts(grid: GridMap) -> tuple[Point, ...]:
    """Return one post for each of the 64 largest obstacles of a grid map, the largest first.

    An obstacle is a connected component of blocked cells, which have eight neighbours. Components at the
    border of the map do not count, since no path passes behind them. The post is the centre of the cell that
    is deepest in the component, in steps to the next free cell.
    """
    from scipy import ndimage

    labels, count = ndimage.label(grid.blocked, np.ones((3, 3), dtype=np.bool_))
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    sizes[0] = 0
    for side in (labels[0], labels[-1], labels[:, 0], labels[:, -1]):
        sizes[side] = 0
    largest = np.argsort(-sizes, kind="stable")[:MOST_GRID_POSTS]
    largest = largest[sizes[largest] > 0]
    depth = ndimage.distance_transform_cdt(grid.blocked, "taxicab")
    cells = ndimage.maximum_position(depth, labels, largest)
    posts = grid.to_map(np.array(cells).reshape(-1, 2)[:, ::-1])
    return tuple((x, y) for x, y in posts.tolist())


def signatures(paths: ArrayLike, posts: Posts) -> Integers:
    """Return how often paths pass to the left of posts, net of the times that they come back there.

    Args:
        paths: (m, k, 2) polylines in map coordinates.
        posts: the posts, P of them.

    Returns:
        (m, P) signed numbers of crossings of the ray that leads from the post to the left.
    """
    return _signatures_entry(np.ascontiguousarray(paths, dtype=np.float64), *posts)


def count_corridors(paths: ArrayLike, posts: Posts) -> int:
    """Return how many different signatures the paths, (m, k, 2) in map coordinates, have; 0 for no path."""
    return _count_entry(np.ascontiguousarray(paths, dtype=np.float64), *posts)


@entry
def _signatures_entry(paths: Floats, points: Floats, forward: Floats) -> Integers:
    return _classify(paths, points, forward)


@entry
def _count_entry(paths: Floats, points: Floats, forward: Floats) -> int:
    found = _classify(paths, points, forward)
    representatives = np.empty(found.shape[0], dtype=np.int64)
    count = 0
    for i in range(found.shape[0]):
        is_new = True
        for c in range(count):
            if _are_equal(found[representatives[c]], found[i]):
                is_new = False
                break
        if is_new:
            representatives[count] = i
            count += 1
    return count


@kernel
def _classify(paths: Floats, points: Floats, forward: Floats) -> Integers:
    """Return the signatures, (m, P), of paths, (m, k, 2).

    A segment crosses the line through a post across the start-target line if its ends lie before and behind
    that line; an end on the line lies before it. The crossing is to the left of the post if the post lies to
    the right of the segment. Left and right are seen in the forward direction of the segment.
    """
    found = np.zeros((paths.shape[0], points.shape[0]), dtype=np.int64)
    along = np.empty(points.shape[0])
    for j in range(points.shape[0]):
        along[j] = points[j, 0] * forward[0] + points[j, 1] * forward[1]
    for i in range(paths.shape[0]):
        x, y = paths[i, 0, 0], paths[i, 0, 1]
        here = x * forward[0] + y * forward[1]
        for k in range(1, paths.shape[1]):
            next_x, next_y = paths[i, k, 0], paths[i, k, 1]
            there = next_x * forward[0] + next_y * forward[1]
            for j in range(points.shape[0]):
                if (here <= along[j]) != (there <= along[j]):
                    side = (next_x - x) * (points[j, 1] - y) - (next_y - y) * (points[j, 0] - x)
                    if here <= along[j]:
                        found[i, j] += side < 0.0
                    else:
                        found[i, j] -= side > 0.0
            x, y, here = next_x, next_y, there
    return found


@kernel(borrows=True)
def _are_equal(one: Integers, other: Integers) -> bool:
    j = 0
    while j < one.shape[0] and one[j] == other[j]:
        j += 1
    return j == one.shape[0]


def _core(obstacle: Obstacle) -> tuple[Floats, float]:
    """Return vertices, (v, 2), and a radius: the obstacle is all that is no farther from their hull."""
    if isinstance(obstacle, Circle):
        return np.array([[obstacle.x, obstacle.y]], dtype=np.float64), float(obstacle.radius)
    return np.array(obstacle.vertices), 0.0


def _touch(one: Floats, radius: float, other: Floats, other_radius: float, tolerance: float) -> bool:
    """Return whether two obstacles, see `_core`, overlap or are no farther apart than a tolerance."""
    distance = min(_distance(one, other), _distance(other, one))
    return distance - radius - other_radius <= tolerance or _overlap(one, other)


def _distance(points: Floats, outline: Floats) -> float:
    """Return the least distance of points, (n, 2), from a closed polyline, (v, 2)."""
    sides = np.roll(outline, -1, axis=0) - outline
    squares = (sides**2).sum(axis=1)
    offsets = points[:, None] - outline
    along = (offsets * sides).sum(axis=2)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    away = offsets - share[..., None] * sides
    return float(np.hypot(away[..., 0], away[..., 1]).min())


def _overlap(one: Floats, other: Floats) -> bool:
    """Return whether no side of either convex hull, of counter-clockwise vertices, separates them.

    Two single points do not overlap.
    """
    polygons = [(a, b) for a, b in ((one, other), (other, one)) if len(a) > 1]
    for outline, points in polygons:
        sides = np.roll(outline, -1, axis=0) - outline
        offsets = points[:, None] - outline
        inside = sides[:, 0] * offsets[..., 1] - sides[:, 1] * offsets[..., 0] > 0.0
        if not inside.any(axis=0).all():
            return False
    return bool(polygons)
