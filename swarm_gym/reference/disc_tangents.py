"""Common tangents of the circles around corners of blocked cells: a disc of their radius moves along them.

Two corners whose circles have a free common tangent see each other. The disc that moves along the tangent
covers the triangles, or the rectangle, between the tangent and the line of sight: all points of these but the
corners are closer to the tangent than the radius. So nothing blocked lies there, and at most the outer side
of the line of sight touches blocked cells. Therefore candidates are the corners in sight.

A lane is a free arc with a direction: lane 2 k goes along arc k towards smaller angles, lane 2 k + 1 towards
larger ones.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.reference.disc_arcs import QUARTER, SLACK, FreeArcs, cells_are_free
from swarm_gym.reference.grid_sight import CornerSight, SightGrid, see_every_corner


class DiscTangents(NamedTuple):
    """Free tangents from a corner or a point, which a path follows from the lane it is on to another one."""

    from_lanes: NDArray[np.int64]
    "Lane that the tangent leaves, (k,); 0 for tangents from a point."
    from_angles: NDArray[np.float64]
    "Angle at which it leaves that lane, (k,)."
    to_lanes: NDArray[np.int64]
    "Lane that it enters, (k,)."
    to_angles: NDArray[np.float64]
    "Angle at which it enters that lane, (k,)."
    lengths: NDArray[np.float64]
    "Length in cells, (k,)."
    work: int
    "Rows of the grid that were compared with candidates, and fifty for each corner in sight."


class Touch(NamedTuple):
    """The point where a tangent touches the circle around a corner."""

    lane: int
    "Lane that a path there is on, or -1 if it is on none."
    angle: float
    "Angle of the point in the quarter of the corner."


@entry
def tangents_from_corner(
    grid: SightGrid, arcs: FreeArcs, corner: int, radius: float, sight: CornerSight
) -> DiscTangents:
    """Find the free tangents from the circle around a corner to those around the corners that it sees.

    Args:
        grid: the grid with its corners.
        arcs: free arcs around them.
        corner: number of the corner.
        radius: radius of the disc in cells.
        sight: scratch arrays.
    """
    x, y = float(grid.corner_columns[corner]), float(grid.corner_rows[corner])
    seen = see_every_corner(grid, x, y, sight)
    found = _make_tangents(4 * seen)
    size, work = 0, 50 * seen
    for k in range(seen):
        other = sight.corners[k]
        if arcs.first[other] == arcs.first[other + 1]:
            continue
        to_x, to_y = float(grid.corner_columns[other]), float(grid.corner_rows[other])
        distance = math.hypot(to_x - x, to_y - y)
        ahead_x, ahead_y = (to_x - x) / distance, (to_y - y) / distance
        for inner in (False, True):
            wide = 2.0 * radius if inner else 0.0
            if wide - distance > SLACK:
                continue
            length = math.sqrt(max((distance - wide) * (distance + wide), 0.0))
            sine, cosine = min(wide / distance, 1.0), length / distance
            for turn in (-1, 1):
                # The direction from the corner to the point where the tangent leaves its circle. A path that
                # is there turns so that its angle about the corner grows (1) or shrinks (-1).
                normal_x = sine * ahead_x + turn * cosine * ahead_y
                normal_y = sine * ahead_y - turn * cosine * ahead_x
                begin = _touch(grid, arcs, corner, radius, normal_x, normal_y, turn)
                if begin.lane < 0:
                    continue
                side = -1 if inner else 1
                end = _touch(grid, arcs, other, radius, side * normal_x, side * normal_y, side * turn)
                if end.lane < 0:
                    continue
                work += int(abs(to_y - y) + 2.0 * radius)
                if not strip_is_free(
                    grid,
                    x + radius * normal_x,
                    y + radius * normal_y,
                    to_x + side * radius * normal_x,
                    to_y + side * radius * normal_y,
                    radius - SLACK,
                ):
                    continue
                found.from_lanes[size], found.from_angles[size] = begin.lane, begin.angle
                found.to_lanes[size], found.to_angles[size] = end.lane, end.angle
                found.lengths[size] = length
                size += 1
    return _cut(found, size, work)


@entry
def tangents_from_point(
    grid: SightGrid, arcs: FreeArcs, x: float, y: float, radius: float, sight: CornerSight
) -> DiscTangents:
    """Find the free tangents from a point to the circles around the corners that it sees.

    Args:
        grid: the grid with its corners.
        arcs: free arcs around them.
        x: shifted column of the point, around which the disc is free.
        y: shifted row of the point.
        radius: radius of the disc in cells.
        sight: scratch arrays.
    """
    seen = see_every_corner(grid, x, y, sight)
    found = _make_tangents(2 * seen)
    size, work = 0, 50 * seen
    for k in range(seen):
        other = sight.corners[k]
        to_x, to_y = float(grid.corner_columns[other]), float(grid.corner_rows[other])
        distance = math.hypot(to_x - x, to_y - y)
        if arcs.first[other] == arcs.first[other + 1] or radius - distance > SLACK:
            continue
        ahead_x, ahead_y = (to_x - x) / distance, (to_y - y) / distance
        length = math.sqrt(max((distance - radius) * (distance + radius), 0.0))
        sine, cosine = min(radius / distance, 1.0), length / distance
        for turn in (-1, 1):
            normal_x = -sine * ahead_x + turn * cosine * ahead_y
            normal_y = -sine * ahead_y - turn * cosine * ahead_x
            end = _touch(grid, arcs, other, radius, normal_x, normal_y, turn)
            if end.lane < 0:
                continue
            end_x, end_y = to_x + radius * normal_x, to_y + radius * normal_y
            work += int(abs(to_y - y) + 2.0 * radius)
            if not strip_is_free(grid, x, y, end_x, end_y, radius - SLACK):
                continue
            found.to_lanes[size], found.to_angles[size] = end.lane, end.angle
            found.lengths[size] = length
            size += 1
    return _cut(found, size, work)


@entry
def strip_is_free(grid: SightGrid, x0: float, y0: float, x1: float, y1: float, reach: float) -> bool:
    """Return whether no blocked cell enters the rectangle of all points that are next to a segment.

    Args:
        grid: the grid, outside of which everything is free.
        x0: shifted column of one end.
        y0: shifted row of that end.
        x1: shifted column of the other end.
        y1: shifted row of the other end.
        reach: how far the rectangle reaches to both sides of the segment.
    """
    length = math.hypot(x1 - x0, y1 - y0)
    if length == 0.0:
        return True
    across_x, across_y = reach * (y0 - y1) / length, reach * (x1 - x0) / length
    xs = (x0 - across_x, x0 + across_x, x1 + across_x, x1 - across_x)
    ys = (y0 - across_y, y0 + across_y, y1 + across_y, y1 - across_y)
    top, bottom = min(ys[0], ys[1], ys[2], ys[3]), max(ys[0], ys[1], ys[2], ys[3])
    begin = int(max(math.floor(top), 1.0))
    end = int(min(math.ceil(bottom), grid.blocked.shape[0] - 1.0))
    for row in range(begin, end):
        left, right = math.inf, -math.inf
        for k in range(4):
            from_x, from_y, to_x, to_y = xs[k], ys[k], xs[(k + 1) % 4], ys[(k + 1) % 4]
            if max(from_y, to_y) < row or min(from_y, to_y) > row + 1:
                continue
            if from_y == to_y:
                low, high = 0.0, 1.0
            else:
                one, two = (row - from_y) / (to_y - from_y), (row + 1 - from_y) / (to_y - from_y)
                low, high = max(min(one, two), 0.0), min(max(one, two), 1.0)
            one, two = from_x + low * (to_x - from_x), from_x + high * (to_x - from_x)
            left, right = min(left, one, two), max(right, one, two)
        if left < right and not cells_are_free(grid, row, left, right):
            return False
    return True


@kernel
def _touch(
    grid: SightGrid, arcs: FreeArcs, corner: int, radius: float, x: float, y: float, turn: int
) -> Touch:
    """Return where a path touches the circle around a corner.

    Args:
        grid: the grid with its corners.
        arcs: free arcs around them.
        corner: number of the corner.
        radius: radius of the circle in cells.
        x: columns from the corner to that point, as a share of the radius.
        y: rows from the corner to that point, as a share of the radius.
        turn: 1 if the path turns from the columns to the rows, -1 if it turns the other way.
    """
    side, step = -grid.blocked_columns[corner], -grid.blocked_rows[corner]
    along, across = side * x, step * y
    rounding = SLACK / max(radius, 1.0)
    if along < -rounding or across < -rounding:
        return Touch(-1, 0.0)
    angle = min(max(math.atan2(across, along), 0.0), QUARTER)
    for arc in range(arcs.first[corner], arcs.first[corner + 1]):
        if arcs.low[arc] <= angle <= arcs.high[arc]:
            grows = turn * side * step > 0
            return Touch(2 * arc + 1 if grows else 2 * arc, angle)
    return Touch(-1, 0.0)


@kernel
def _make_tangents(most: int) -> DiscTangents:
    return DiscTangents(
        np.zeros(most, np.int64), np.zeros(most), np.zeros(most, np.int64), np.zeros(most), np.zeros(most), 0
    )


@kernel
def _cut(found: DiscTangents, size: int, work: int) -> DiscTangents:
    return DiscTangents(
        found.from_lanes[:size].copy(),
        found.from_angles[:size].copy(),
        found.to_lanes[:size].copy(),
        found.to_angles[:size].copy(),
        found.lengths[:size].copy(),
        work,
    )
