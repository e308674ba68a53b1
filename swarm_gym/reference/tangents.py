"""A* over the common tangents of sites: a shortest path consists of these and of arcs between them.

Source: T. Lozano-Perez, M. A. Wesley, "An algorithm for planning collision-free paths among polyhedral
obstacles", Commun. ACM 22 (1979); circles are treated alike. Nothing is computed before it is needed: the
tangents that leave a site when a path first arrives there, and whether one is free when it is the most
promising one.
"""

import math
from typing import NamedTuple

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.reference.free_arcs import USELESS, Sites, ahead, is_in_hull, slack_of
from swarm_gym.reference.priority_queue import PriorityQueue, enter, take_first
from swarm_gym.reference.solids import NONE, Cells, Floats, Integers, Solids, extended, is_blocked

START, TARGET = 0, 1  # numbers of their sites
UNKNOWN, FREE, BLOCKED = range(3)  # states of tangents


class Tangents(NamedTuple):
    """Common tangents of sites, each in one direction, with room for more."""

    ends: Floats
    "Points p and q of each, (n, 4)."
    angles: Floats
    "Directions of p from the centre of its site, and of q, (n, 2)."
    lengths: Floats
    "Distances from p to q, (n,)."
    sites: Integers
    "Site at q, (n,)."
    signs: Integers
    "Whether a path goes on counter-clockwise around that site, 1, or clockwise, -1, (n,)."
    states: Integers
    "Whether the tangent is free, if that is known, (n,)."
    parents: Integers
    "Tangent before it on the shortest path to it, or -1, (n,)."
    queue: PriorityQueue
    "Lengths of paths from the start to q, and the order of the search."


@kernel
def make_tangents(room: int) -> Tangents:
    """Return no tangents, with room for some."""
    return Tangents(
        np.zeros((room, 4)),
        np.zeros((room, 2)),
        np.zeros(room),
        np.zeros(room, np.int64),
        np.zeros(room, np.int64),
        np.zeros(room, np.int64),
        np.full(room, -1, np.int64),
        PriorityQueue(
            np.zeros(room, np.int64),
            np.full(room, -1, np.int64),
            np.full(room, np.inf),
            np.full(room, np.inf),
        ),
    )


@kernel
def with_room(tangents: Tangents, room: int) -> Tangents:
    """Return the same tangents with more room."""
    queue = tangents.queue
    return Tangents(
        extended(tangents.ends, room, 0.0),
        extended(tangents.angles, room, 0.0),
        extended(tangents.lengths, room, 0.0),
        extended(tangents.sites, room, 0),
        extended(tangents.signs, room, 0),
        extended(tangents.states, room, UNKNOWN),
        extended(tangents.parents, room, -1),
        PriorityQueue(
            extended(queue.entries, room, 0),
            extended(queue.places, room, -1),
            extended(queue.cost, room, np.inf),
            extended(queue.length, room, np.inf),
        ),
    )


@kernel
def search(solids: Solids, cells: Cells, sites: Sites) -> tuple[Tangents, int]:
    """Return tangents, and the last one of the shortest path; -1 if there is no path."""
    num_sites = sites.kinds.shape[0]
    tangents = make_tangents(4 * num_sites)
    fans = np.full((num_sites, 2, 2), -1)  # first tangent that leaves a site in a direction, and the next fan's
    count, size, site, sign = NONE, NONE, NONE + START, NONE + 1
    node, length, angle, free = NONE - 1, 0.0, 0.0, math.tau
    target_x, target_y = sites.circles[TARGET, 0], sites.circles[TARGET, 1]
    while True:
        direction = (sign + 1) // 2
        if fans[site, direction, 0] < 0:
            if count + 2 * num_sites > tangents.states.shape[0]:
                tangents = with_room(tangents, 2 * (count + 2 * num_sites))
            fans[site, direction, 0] = count
            count = _add_fan(solids, sites, site, sign, tangents, count)
            fans[site, direction, 1] = count
        queue, radius, slack = tangents.queue, sites.circles[site, 2], slack_of(sites, site)
        for k in range(fans[site, direction, 0], fans[site, direction, 1]):
            turn = sign * (tangents.angles[k, 0] - angle)
            if turn < -slack:
                turn += math.tau
            if site == START:
                turn = 0.0
            longer = length + radius * max(turn, 0.0) + tangents.lengths[k]
            if turn <= free + slack and longer < queue.length[k] and tangents.states[k] != BLOCKED:
                rest_x, rest_y = target_x - tangents.ends[k, 2], target_y - tangents.ends[k, 3]
                tangents.parents[k] = node
                queue.length[k] = longer
                queue.cost[k] = longer + math.sqrt(rest_x * rest_x + rest_y * rest_y)
                size = enter(queue, size, k)
        node = -1
        while size > 0 and node < 0:
            node = take_first(queue, size)
            size -= 1
            if tangents.states[node] == UNKNOWN:
                px, py = tangents.ends[node, 0], tangents.ends[node, 1]
                blocked = is_blocked(solids, cells, px, py, tangents.ends[node, 2], tangents.ends[node, 3])
                tangents.states[node] = BLOCKED if blocked else FREE
            if tangents.states[node] == BLOCKED:
                node = -1
        if node < 0 or tangents.sites[node] == TARGET:
            return tangents, node
        site, sign, length = tangents.sites[node], tangents.signs[node], queue.length[node]
        angle = tangents.angles[node, 1]
        free = ahead(sites, site, sign, angle)


@kernel
def _add_fan(solids: Solids, sites: Sites, i: int, sign: int, tangents: Tangents, count: int) -> int:
    """Add the tangents that leave a site in a direction, and bend at free places; return the new number."""
    circles, tolerance = sites.circles, solids.tolerance
    x, y, radius = circles[i, 0], circles[i, 1], circles[i, 2]
    for j in range(TARGET, sites.kinds.shape[0]):
        if j == i or sites.kinds[j] == USELESS:
            continue
        to_x, to_y, other = circles[j, 0] - x, circles[j, 1] - y, circles[j, 2]
        square = to_x * to_x + to_y * to_y
        gap = math.sqrt(square)
        if gap <= tolerance:
            continue
        for side in range(1 if j == TARGET else 2):
            sign_there = sign if side == 0 else -sign
            step = sign_there * other - sign * radius
            if abs(step) > gap + tolerance:
                continue
            length = math.sqrt(max(0.0, (gap - step) * (gap + step)))
            scale = 1.0 / (gap * math.sqrt(length * length + step * step))
            # The direction of the tangent turns by the angle of (length, -step) from that between centres.
            along_x = (to_x * length + to_y * step) * scale
            along_y = (to_y * length - to_x * step) * scale
            x_here, y_here, x_there, y_there = along_y, -along_x, along_y, -along_x
            if sign < 0:
                x_here, y_here = -x_here, -y_here
            if sign_there < 0:
                x_there, y_there = -x_there, -y_there
            if i != START and not is_in_hull(sites, i, x_here, y_here):
                continue
            if j != TARGET and not is_in_hull(sites, j, x_there, y_there):
                continue
            there = math.atan2(y_there, x_there) % math.tau
            if j != TARGET and ahead(sites, j, sign_there, there) < 0.0:
                continue
            here = math.atan2(y_here, x_here) % math.tau
            tangents.ends[count, 0], tangents.ends[count, 1] = x + radius * x_here, y + radius * y_here
            tangents.ends[count, 2] = circles[j, 0] + other * x_there
            tangents.ends[count, 3] = circles[j, 1] + other * y_there
            tangents.angles[count, 0], tangents.angles[count, 1] = here, there
            tangents.lengths[count] = length
            tangents.sites[count], tangents.signs[count] = j, sign_there
            count += 1
    return count
