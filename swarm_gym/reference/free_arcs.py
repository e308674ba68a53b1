"""Sites at which a shortest path can bend: corners and discs, and their arcs that no other obstacle covers.

A corner of a polygon is a circle of radius zero here. Its arc goes from the outward normal of one edge to
the normal of the other. A line through the corner that does not enter the polygon has its normal there.
"""

import math
from typing import NamedTuple

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.reference.solids import (
    NONE,
    Cells,
    Floats,
    Integers,
    Solids,
    begin_query,
    cell_at,
    depth,
    extended,
    is_new,
)

ANGULAR_SLACK = 1e-9  # by which a normal may miss an arc, for rounding; segments are tested besides
USELESS, SINGLE, WIDE, MANY = range(4)  # kinds of sites, by their arcs


class Places(NamedTuple):
    """Start, target, corners and discs, in this order, as they are given."""

    circles: Floats
    "Centre and radius, (s, 3); the radius of ends and corners is zero."
    owners: Integers
    "Obstacle of each place, or -1, (s,)."
    neighbours: Floats
    "Coordinates of the vertices before and after each corner, (s, 4)."


class Sites(NamedTuple):
    """Places with their free arcs; a path bends along these."""

    circles: Floats
    "Centre and radius, (s, 3)."
    kinds: Integers
    "No arc, a single arc of less than half a turn, a single longer one, or several and whole circles, (s,)."
    hulls: Floats
    "Directions of both ends of a single arc, (s, 4)."
    first: Integers
    "Index of the first arc of each site, and the number of arcs, (s + 1,)."
    arcs: Floats
    "Angles of both ends of each arc; the first lies in [0, 2 pi), the second is larger, (a, 2)."


@kernel
def make_sites(solids: Solids, cells: Cells, places: Places) -> Sites:
    """Return the sites of a scene."""
    count = places.circles.shape[0]
    kinds = np.full(count, USELESS)
    hulls, first, arcs = np.zeros((count, 4)), np.zeros(count + 1, np.int64), np.zeros((count + 1, 2))
    blocked, outside = np.zeros((16, 2)), np.zeros((solids.planes.shape[0], 2))
    for s in range(count):
        n = first[s]
        if s < 2:
            _put(arcs, n, 0.0, math.tau)
            n += 1
        elif places.circles[s, 2] > 0.0:
            num_blocked, blocked = _blocked_arcs(solids, cells, places, s, blocked, outside)
            if n + num_blocked + 1 + count > arcs.shape[0]:
                arcs = extended(arcs, 2 * (n + num_blocked + 1 + count), 0.0)
            n += write_gaps(blocked, num_blocked, arcs, n)
        elif not _is_covered(solids, cells, places, s):
            n += _write_corner(places, s, arcs, n)
        first[s + 1] = n
        if n == first[s] + 1 and arcs[n - 1, 1] - arcs[n - 1, 0] < math.tau:
            begin, end = arcs[n - 1, 0], arcs[n - 1, 1]
            kinds[s] = SINGLE if end - begin < math.pi else WIDE
            hulls[s, 0], hulls[s, 1] = math.cos(begin), math.sin(begin)
            hulls[s, 2], hulls[s, 3] = math.cos(end), math.sin(end)
        elif n > first[s]:
            kinds[s] = MANY
    return Sites(places.circles, kinds, hulls, first, arcs)


@kernel
def is_in_hull(sites: Sites, s: int, x: float, y: float, slack: float) -> bool:
    """Return whether a direction can lie on a free arc of a site, or misses it by no more than an angle."""
    kind, hulls = sites.kinds[s], sites.hulls
    if kind == MANY:
        return True
    behind_begin = hulls[s, 0] * y - hulls[s, 1] * x >= -slack
    before_end = x * hulls[s, 3] - y * hulls[s, 2] >= -slack
    if kind == SINGLE:
        return behind_begin and before_end
    return kind == WIDE and (behind_begin or before_end)


@kernel
def slack_of(sites: Sites, s: int, tolerance: float, length: float) -> float:
    """Return the angle by which a tangent of some length may miss an arc of a site, for rounding.

    At a corner that costs no way, and the direction of a short tangent is little known. On a disc a path may
    go back by as much.
    """
    radius = sites.circles[s, 2]
    if radius > 0.0:
        return 1e-13 / max(radius, 1e-9)
    return ANGULAR_SLACK + tolerance / max(length, tolerance)


@kernel
def ahead(sites: Sites, s: int, sign: int, angle: float, slack: float) -> float:
    """Return the free angle ahead of a place on a site, in a direction; negative if the place is blocked."""
    for k in range(sites.first[s], sites.first[s + 1]):
        length = sites.arcs[k, 1] - sites.arcs[k, 0]
        if length >= math.tau:
            return length
        behind = angle - sites.arcs[k, 0]
        if behind < -slack:
            behind += math.tau
        if behind <= length + slack:
            return max(length - behind if sign > 0 else behind, 0.0)
    return -1.0


@kernel
def write_gaps(arcs: Floats, count: int, gaps: Floats, n: int) -> int:
    """Write the arcs that `count` arcs of a circle leave free from index `n` on; return their number.

    Arcs begin in [0, 2 pi) and end at larger angles; they are sorted in place.
    """
    if count == 0:
        _put(gaps, n, 0.0, math.tau)
        return 1
    for k in range(1, count):
        begin, end = arcs[k, 0], arcs[k, 1]
        place = k
        while place > 0 and arcs[place - 1, 0] > begin:
            _put(arcs, place, arcs[place - 1, 0], arcs[place - 1, 1])
            place -= 1
        _put(arcs, place, begin, end)
    reach = -math.inf
    for k in range(count):
        reach = max(reach, arcs[k, 1] - math.tau)
    before = n
    for k in range(count):
        if arcs[k, 0] > reach:
            turn = math.tau if reach < 0.0 else 0.0
            _put(gaps, n, reach + turn, arcs[k, 0] + turn)
            n += 1
        reach = max(reach, arcs[k, 1])
    return n - before


@kernel
def _put(arcs: Floats, n: int, begin: float, end: float) -> None:
    arcs[n, 0], arcs[n, 1] = begin, end


@kernel
def _write_corner(places: Places, s: int, arcs: Floats, n: int) -> int:
    """Write the arc of a corner; return 1, or 0 if the outline does not bend there."""
    x, y = places.circles[s, 0], places.circles[s, 1]
    in_x, in_y = x - places.neighbours[s, 0], y - places.neighbours[s, 1]
    out_x, out_y = places.neighbours[s, 2] - x, places.neighbours[s, 3] - y
    turn = math.atan2(in_x * out_y - in_y * out_x, in_x * out_x + in_y * out_y)
    if turn <= 0.0:
        return 0
    begin = math.atan2(-in_x, in_y) % math.tau
    _put(arcs, n, begin, begin + turn)
    return 1


@kernel
def _is_covered(solids: Solids, cells: Cells, places: Places, s: int) -> bool:
    """Return whether no path can bend at a corner: it lies in an obstacle, or a disc rounds it off."""
    x, y = places.circles[s, 0], places.circles[s, 1]
    column, row = cell_at(cells, x, y)
    cell = row * cells.columns + column
    for k in range(cells.first[cell], cells.first[cell + 1]):
        o = cells.entries[k]
        if o == places.owners[s]:
            continue
        deep = depth(solids, o, x, y)
        if deep > solids.tolerance:
            return True
        if deep >= -solids.tolerance and solids.first[o] == solids.first[o + 1]:
            # The corner lies on a circle. Do both edges lead to its side of the tangent?
            to_x, to_y = solids.circles[o, 0] - x, solids.circles[o, 1] - y
            least = -solids.tolerance * solids.circles[o, 2]
            before = (places.neighbours[s, 0] - x) * to_x + (places.neighbours[s, 1] - y) * to_y
            after = (places.neighbours[s, 2] - x) * to_x + (places.neighbours[s, 3] - y) * to_y
            if before >= least and after >= least and solids.circles[o, 2] > 10.0 * solids.tolerance:
                return True
    return False


@kernel
def _blocked_arcs(
    solids: Solids, cells: Cells, places: Places, s: int, blocked: Floats, outside: Floats
) -> tuple[int, Floats]:
    """Return the number of arcs of a disc that lie in other obstacles, and the arcs.

    Args:
        solids: the obstacles.
        cells: the obstacles by cells.
        places: all places.
        s: number of the disc among the places.
        blocked: array that the arcs are written to; a longer one is returned if it is too short.
        outside: scratch, as long as there are planes.
    """
    x, y, radius = places.circles[s, 0], places.circles[s, 1], places.circles[s, 2]
    left, low = cell_at(cells, x - radius, y - radius)
    right, high = cell_at(cells, x + radius, y + radius)
    count = NONE
    begin_query(cells)
    for row in range(low, high + 1):
        for column in range(left, right + 1):
            cell = row * cells.columns + column
            for k in range(cells.first[cell], cells.first[cell + 1]):
                o = cells.entries[k]
                if o == places.owners[s] or not is_new(cells, o):
                    continue
                needed = count + 1 + solids.first[o + 1] - solids.first[o]
                if needed > blocked.shape[0]:
                    blocked = extended(blocked, 2 * needed, 0.0)
                if _meet(solids, o, x, y, radius):
                    if solids.first[o] == solids.first[o + 1]:
                        count += _write_arc_in_disc(solids, o, x, y, radius, blocked, count)
                    else:
                        count += _write_arcs_in_polygon(solids, o, x, y, radius, blocked, count, outside)
    return count, blocked


@kernel
def _meet(solids: Solids, o: int, x: float, y: float, radius: float) -> bool:
    """Return whether a circle can come deeper into an obstacle than the tolerance."""
    reach = solids.circles[o, 2] - solids.tolerance
    gap = math.sqrt((solids.circles[o, 0] - x) ** 2 + (solids.circles[o, 1] - y) ** 2)
    return reach > 0.0 and gap < radius + reach and gap + reach > radius


@kernel
def _write_arc_in_disc(
    solids: Solids, o: int, x: float, y: float, radius: float, arcs: Floats, n: int
) -> int:
    """Write the arc of a circle that lies in a disc that it meets; return 1."""
    reach = solids.circles[o, 2] - solids.tolerance
    to_x, to_y = solids.circles[o, 0] - x, solids.circles[o, 1] - y
    gap = math.sqrt(to_x * to_x + to_y * to_y)
    half = math.pi
    if gap + radius > reach:
        # (gap^2 + radius^2 - reach^2) / (2 gap radius), without differences of squares
        cosine = (gap + (radius - reach) * ((radius + reach) / gap)) / (2.0 * radius)
        half = math.acos(min(max(cosine, -1.0), 1.0))
    begin = (math.atan2(to_y, to_x) - half) % math.tau
    _put(arcs, n, begin, begin + 2.0 * half)
    return 1


@kernel
def _write_arcs_in_polygon(
    solids: Solids, o: int, x: float, y: float, radius: float, arcs: Floats, n: int, outside: Floats
) -> int:
    """Write the arcs of a circle that lie in a polygon from index `n` on; return their number."""
    planes, count = solids.planes, NONE
    for k in range(solids.first[o], solids.first[o + 1]):
        level = planes[k, 2] + solids.tolerance - planes[k, 0] * x - planes[k, 1] * y
        if level >= radius:
            return 0
        if level > -radius:
            half = math.acos(level / radius)
            begin = (math.atan2(planes[k, 1], planes[k, 0]) + half) % math.tau
            _put(outside, count, begin, begin + math.tau - 2.0 * half)
            count += 1
    return write_gaps(outside, count, arcs, n)
