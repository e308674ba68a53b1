"""The exact shortest path among the obstacles of a scenario, by a tangent visibility graph.

Source: T. Lozano-Perez, M. A. Wesley, "An algorithm for planning collision-free paths among polyhedral
obstacles", Commun. ACM 22 (1979). Circles are treated alike: a shortest path consists of arcs of circles and
of segments. A segment is tangent to an obstacle at both ends, or ends at start or target.

Everything is computed in coordinates whose origin is the start and whose unit is the extent of the scenario.
"""

import math
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry
from swarm_gym.errors import NoPathError
from swarm_gym.reference.free_arcs import Places, make_sites
from swarm_gym.reference.solids import Solids, make_cells
from swarm_gym.reference.tangents import search
from swarm_gym.reference.taut_polyline import write_polyline
from swarm_gym.scenarios import Circle, Scenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# How deep a path may enter an obstacle, relative to the extent of the scenario: well above the
# rounding errors of tangent points, well below anything that matters.
RELATIVE_TOLERANCE = 1e-12
# How deep besides, for the rounding of coordinates, relative to the spacing of float64 at the largest one.
ROUNDINGS = 4.0


def shortest_path(scenario: Scenario) -> tuple[float, Floats]:
    """Return the shortest path from start to target that does not enter the interior of any obstacle.

    It may touch obstacles, pass between two that only touch each other, and leave the workspace. To
    enter by no more than `RELATIVE_TOLERANCE` times the extent of the scenario counts as touching;
    so do four times the spacing of numbers at the largest coordinate.

    Returns:
        The length in map units, and the path as a polyline in map coordinates, shape (k, 2). The
        length is the length of the path itself. Around discs the polyline lies outside the arcs and touches
        them.

    Raises:
        ScenarioError: if the obstacles separate start and target.
    """
    scene = _scene(scenario)
    length, points = find_path(scene.solids, scene.places, scene.box)
    if not math.isfinite(length):
        raise NoPathError(f"scenario {scenario.name!r}: the obstacles separate start and target")
    path = scenario.start + scene.extent * points
    path[0], path[-1] = scenario.start, scenario.target
    moves = np.any(path[1:] != path[:-1], axis=1)
    return scene.extent * length, path[np.append(True, moves)]


@entry
def find_path(solids: Solids, places: Places, box: Floats) -> tuple[float, Floats]:
    """Return the length and the points of the shortest path; the length is infinite if there is none.

    Args:
        solids: the obstacles.
        places: ends of the path, and places where it can bend.
        box: left, lower, right and upper end of the scene, (4,).
    """
    cells = make_cells(solids, box[0], box[1], box[2], box[3])
    sites = make_sites(solids, cells, places)
    tangents, last = search(solids, cells, sites)
    if last < 0:
        return math.inf, np.zeros((0, 2))
    return tangents.queue.length[last], write_polyline(solids, cells, sites, tangents, last)


class _Scene(NamedTuple):
    solids: Solids
    places: Places
    box: Floats
    extent: float


def _scene(scenario: Scenario) -> _Scene:
    """Return a scenario as arrays, in coordinates around the start, with obstacles that are alike once."""
    obstacles = tuple(dict.fromkeys(scenario.solids))
    discs = [(o.x, o.y, o.radius) for o in obstacles if isinstance(o, Circle)]
    outlines = [o.vertices for o in obstacles if not isinstance(o, Circle)]
    given_discs = np.array(discs, dtype=np.float64).reshape(-1, 3)
    corners = np.array(list(chain.from_iterable(outlines)), dtype=np.float64).reshape(-1, 2)
    ends = np.array([scenario.start, scenario.target])

    largest = max(float(np.abs(part).max(initial=0.0)) for part in (ends, given_discs[:, :2], corners))
    given_discs[:, :2] -= ends[0]
    corners -= ends[0]
    ends -= ends[0]
    reach = np.hypot(given_discs[:, 0], given_discs[:, 1]) + given_discs[:, 2]
    extent = max(float(part.max(initial=0.0)) for part in (np.hypot(*ends.T), np.hypot(*corners.T), reach))
    tolerance = RELATIVE_TOLERANCE + ROUNDINGS * float(np.spacing(largest)) / extent
    given_discs /= extent
    corners /= extent
    ends /= extent

    corners, sizes = _without_repetitions(corners, np.array([len(outline) for outline in outlines], np.int64))
    circles, first, planes, before, after = _polygons(corners, sizes)
    num_polygons, num_discs = len(sizes), len(given_discs)
    solids = Solids(
        np.concatenate([circles, given_discs]),
        np.concatenate([first, np.full(num_discs, first[-1])]),
        planes,
        tolerance,
    )
    points = np.concatenate([ends, corners])
    places = Places(
        np.concatenate([np.column_stack([points, np.zeros(len(points))]), given_discs]),
        np.concatenate(
            [[-1, -1], np.repeat(np.arange(num_polygons), sizes), num_polygons + np.arange(num_discs)]
        ).astype(np.int64),
        np.concatenate(
            [np.zeros((2, 4)), np.hstack([corners[before], corners[after]]), np.zeros((num_discs, 4))]
        ),
    )
    around, radii = places.circles[:, :2], places.circles[:, 2:]
    box = np.concatenate([(around - radii).min(axis=0), (around + radii).max(axis=0)])
    return _Scene(solids, places, box, extent)


def _neighbours(sizes: Integers) -> tuple[Integers, Integers, Integers]:
    """Return the first corner of each polygon and their number, and the corners before and after each one."""
    first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    before, after = np.arange(-1, first[-1] - 1), np.arange(1, first[-1] + 1)
    before[first[:-1]], after[first[1:] - 1] = first[1:] - 1, first[:-1]
    return first, before, after


def _without_repetitions(corners: Floats, sizes: Integers) -> tuple[Floats, Integers]:
    """Return the corners of polygons without those that rounding put onto the next, and their new numbers.

    A polygon with less than three corners is left out: it has no inside.
    """
    _, _, after = _neighbours(sizes)
    owners = np.repeat(np.arange(len(sizes)), sizes)
    kept = np.any(corners != corners[after], axis=1)
    left = np.bincount(owners[kept], minlength=len(sizes))
    kept &= left[owners] >= 3
    return corners[kept], left[left >= 3]


def _polygons(corners: Floats, sizes: Integers) -> tuple[Floats, Integers, Floats, Integers, Integers]:
    """Return circles around polygons, the first plane of each, all planes, and the neighbours of each corner.

    Args:
        corners: corners of all polygons, each counter-clockwise, (m, 2).
        sizes: numbers of corners.
    """
    first, before, after = _neighbours(sizes)
    edges = corners[after] - corners
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    normals = np.column_stack([-edges[:, 1], edges[:, 0]]) / lengths[:, None]
    # A short edge has a direction that rounding can turn; its line is put outside the corners next to it.
    near = (corners[before], corners, corners[after], corners[after[after]])
    offsets = np.min([np.einsum("ij,ij->i", normals, one) for one in near], axis=0)
    circles = np.zeros((len(sizes), 3))
    if len(sizes):
        least = np.minimum.reduceat(corners, first[:-1])
        most = np.maximum.reduceat(corners, first[:-1])
        circles[:, :2] = 0.5 * (least + most)
        away = corners - np.repeat(circles[:, :2], sizes, axis=0)
        circles[:, 2] = np.maximum.reduceat(np.hypot(away[:, 0], away[:, 1]), first[:-1])
    return circles, first, np.column_stack([normals, offsets]), before, after
