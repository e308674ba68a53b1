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
from swarm_gym.reference.free_arcs import ANGULAR_SLACK, USELESS, Sites, ahead, is_in_hull, slack_of
from swarm_gym.reference.priority_queue import PriorityQueue, enter, take_first
from swarm_gym.reference.solids import NONE, Cells, Floats, Integers, Solids, extended, is_blocked

START, TARGET = 0, 1  # numbers of their sites
DEPARTURE, ARRIVAL, LENGTH = range(
    4, 7
)  # columns of the lines of tangents, after the coordinates of both ends
SITE, SIGN, STATE, PARENT = range(4)  # columns of their marks
UNKNOWN, FREE, BLOCKED = -1, 0, 1  # states of tangents


class Tangents(NamedTuple):
    """Common tangents of sites, each in one direction, with room for more."""

    lines: Floats
    "Ends p and q, directions of p from the centre of its site and of q from its, and length of each, (n, 7)."
    marks: Integers
    "Site at q, sense of the bend there, state, and tangent before it on the shortest path, (n, 4)."
    queue: PriorityQueue
    "Lengths of paths from the start to q, and the order of the search."


@kernel
def with_room(tangents: Tangents, room: int) -> Tangents:
    """Return the same tangents with more room."""
    queue = tangents.queue
    return Tangents(
        extended(tangents.lines, room, 0.0),
        extended(tangents.marks, room, -1),
        PriorityQueue(
            extended(queue.entries, room, -1),
            extended(queue.places, room, -1),
            extended(queue.cost, room, np.inf),
            extended(queue.length, room, np.inf),
        ),
    )


@kernel
def search(solids: Solids, cells: Cells, sites: Sites) -> tuple[Tangents, int]:
    """Return tangents, and the last one of the shortest path; -1 if there is no path."""
    num_sites = sites.kinds.shape[0]
    integers, lengths = np.empty(0, np.int64), np.empty(0)
    queue = PriorityQueue(integers, integers, lengths, lengths)
    tangents = Tangents(np.empty((0, 7)), np.empty((0, 4), np.int64), queue)
    fans = np.full(
        (num_sites, 2, 2), -1
    )  # first tangent that leaves a site in a direction, and the next fan's
    count, size, site, sign = NONE, NONE, NONE + START, NONE + 1
    node, length, angle, free, slack_before = NONE - 1, 0.0, 0.0, math.tau, 0.0
    target_x, target_y = sites.circles[TARGET, 0], sites.circles[TARGET, 1]
    while True:
        direction = (sign + 1) // 2
        if fans[site, direction, 0] < 0:
            if count + 2 * num_sites > tangents.marks.shape[0]:
                tangents = with_room(tangents, 2 * (count + 2 * num_sites))
            fans[site, direction, 0] = count
            count = _add_fan(solids, sites, site, sign, tangents, count)
            fans[site, direction, 1] = count
        queue, radius = tangents.queue, sites.circles[site, 2]
        for k in range(fans[site, direction, 0], fans[site, direction, 1]):
            slack = slack_before + slack_of(sites, site, solids.tolerance, tangents.lines[k, LENGTH])
            turn = sign * (tangents.lines[k, DEPARTURE] - angle)
            if turn < -slack:
                turn += math.tau
            if site == START:
                turn = 0.0
            longer = length + radius * max(turn, 0.0) + tangents.lines[k, LENGTH]
            if turn <= free + slack and longer < queue.length[k] and tangents.marks[k, STATE] != BLOCKED:
                rest_x, rest_y = target_x - tangents.lines[k, 2], target_y - tangents.lines[k, 3]
                tangents.marks[k, PARENT] = node
                queue.length[k] = longer
                queue.cost[k] = longer + math.sqrt(rest_x * rest_x + rest_y * rest_y)
                size = enter(queue, size, k)
        node = -1
        while size > 0 and node < 0:
            node = take_first(queue, size)
            size -= 1
            if tangents.marks[node, STATE] == UNKNOWN:
                px, py = tangents.lines[node, 0], tangents.lines[node, 1]
                blocked = is_blocked(solids, cells, px, py, tangents.lines[node, 2], tangents.lines[node, 3])
                tangents.marks[node, STATE] = BLOCKED if blocked else FREE
            if tangents.marks[node, STATE] == BLOCKED:
                node = -1
        if node < 0 or tangents.marks[node, SITE] == TARGET:
            return tangents, node
        site, sign, length = tangents.marks[node, SITE], tangents.marks[node, SIGN], queue.length[node]
        angle = tangents.lines[node, ARRIVAL]
        slack_before = slack_of(sites, site, solids.tolerance, tangents.lines[node, LENGTH])
        free = ahead(sites, site, sign, angle, slack_before)


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
        slack = ANGULAR_SLACK + tolerance / gap
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
            if i != START and not is_in_hull(sites, i, x_here, y_here, slack):
                continue
            if j != TARGET and not is_in_hull(sites, j, x_there, y_there, slack):
                continue
            there = math.atan2(y_there, x_there) % math.tau
            if j != TARGET and ahead(sites, j, sign_there, there, slack_of(sites, j, tolerance, gap)) < 0.0:
                continue
            here = math.atan2(y_here, x_here) % math.tau
            tangents.lines[count, 0], tangents.lines[count, 1] = x + radius * x_here, y + radius * y_here
            tangents.lines[count, 2] = circles[j, 0] + other * x_there
            tangents.lines[count, 3] = circles[j, 1] + other * y_there
            tangents.lines[count, DEPARTURE], tangents.lines[count, ARRIVAL] = here, there
            tangents.lines[count, LENGTH] = length
            tangents.marks[count, SITE], tangents.marks[count, SIGN] = j, sign_there
            count += 1
    return count
