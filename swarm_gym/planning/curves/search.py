"""A search for drivable curves: hybrid A* over positions and headings, with an exact last curve to the goal.

D. Dolgov, S. Thrun, M. Montemerlo and J. Diebel, "Path planning for autonomous vehicles in unknown
semi-structured environments", International Journal of Robotics Research 29(5), 2010. States are poses of any
numbers. Of those in one cell of position and heading, the cheapest is kept. Steps are short arcs. The
estimate of the rest is the larger one of two. One comes from a guide, see `guide`; the other is the cost of
the curve without obstacles, by its length and changes of direction.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.planning.curves.field import Field, cost_along, driven, is_free
from swarm_gym.planning.curves.guide import rest_from
from swarm_gym.planning.curves.pieces import advanced, connected, most_pieces
from swarm_gym.reference.priority_queue import PriorityQueue, enter, take_first

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Numbers of a search that change.
NODES, WAITING, EXPANDED, BEST_NODE, FIRST_FOUND, TRIED = range(6)
BEST_COST, FARTHEST = range(2)


class Limits(NamedTuple):
    """Limits and costs of curves, in lattice steps."""

    radius: float
    "Radius of the smallest turning circle."
    reverses: bool
    "True if the robot may drive backwards."
    bending: float
    "Cost of a unit of length on the smallest circle, besides the length; it grows with curvature squared."
    changing: float
    "Cost of a change of direction."


class Search(NamedTuple):
    """States of a search; nodes are numbered in the order in which they are found."""

    poses: Floats
    "Pose of each node, (n, 3)."
    pieces: Floats
    "Piece that leads to each node, (n, 2)."
    parents: Integers
    "Node before each node; -1 at a start, (n,)."
    queue: PriorityQueue
    "Waiting nodes, by their cost so far and the estimate of the rest."
    keys: Integers
    "Cell of position and heading by hash, -1 where none is, (h,)."
    values: Integers
    "Cheapest node in that cell, (h,)."
    last: Floats
    "Pieces of the last curve from the best node to the goal, (`most_pieces`, 2)."
    counts: Integers
    "Nodes, waiting, expanded, best node, expanded when the first curve was found, last curves tried, (6,)."
    numbers: Floats
    "Cost of the best curve, and largest distance from a start, (2,)."
    cell: float
    "Side of a cell of positions."
    headings: int
    "Number of cells of headings."
    step: float
    "Length of a step."
    weight: float
    "Factor of the estimate of the rest."


def make_search(most: int, cell: float, headings: int, step: float, weight: float, reverses: bool) -> Search:
    """Return an empty search of at most so many nodes.

    `reverses` says whether the robot may drive backwards; other arguments are as in `Search`.
    """
    slots = 1 << (2 * most - 1).bit_length()
    queue = PriorityQueue(
        np.empty(most, np.int64), np.full(most, -1, np.int64), np.empty(most), np.empty(most)
    )
    return Search(
        np.empty((most, 3)),
        np.empty((most, 2)),
        np.empty(most, np.int64),
        queue,
        np.full(slots, -1, np.int64),
        np.empty(slots, np.int64),
        np.zeros((most_pieces(reverses), 2)),
        np.array([0, 0, 0, -1, -1, 0], np.int64),
        np.array([math.inf, 0.0]),
        cell,
        headings,
        step,
        weight,
    )


@entry
def begin(guide: Floats, limits: Limits, goals: Floats, free: bool, search: Search, starts: Floats) -> None:
    """Enter poses that a curve may begin with.

    Args:
        guide: estimates of the rest.
        limits: limits and costs.
        goals: poses that a curve may end with, (m, 3).
        free: whether any heading will do at the goal; then `goals` has one row.
        search: the search.
        starts: poses, (k, 3).
    """
    scratch = np.zeros((most_pieces(limits.reverses), 2))
    for k in range(starts.shape[0]):
        _reach(
            guide, limits, goals, free, search, -1,
            starts[k, 0], starts[k, 1], starts[k, 2], 0.0, 0.0, 0.0, scratch,
        )  # fmt: skip


@entry
def expand(
    field: Field,
    guide: Floats,
    limits: Limits,
    goals: Floats,
    free: bool,
    search: Search,
    count: int,
    patience: int,
) -> bool:
    """Expand up to so many nodes; return whether the search has ended.

    It ends when nothing waits that can be better, or when its arrays are full. Once a curve is known, it also
    ends after `patience` further nodes. `field` has the obstacles and costs; other arguments are as in
    `begin`.
    """
    counts, numbers, queue = search.counts, search.numbers, search.queue
    scratch, end = np.zeros((most_pieces(limits.reverses), 2)), np.zeros(3)
    for _ in range(count):
        if counts[WAITING] == 0:
            return True
        if counts[FIRST_FOUND] >= 0 and counts[EXPANDED] - counts[FIRST_FOUND] >= patience:
            return True
        node = take_first(queue, counts[WAITING])
        counts[WAITING] -= 1
        if queue.cost[node] >= numbers[BEST_COST]:
            counts[WAITING] = 0
            return True
        x, y, heading = search.poses[node, 0], search.poses[node, 1], search.poses[node, 2]
        so_far, length = queue.length[node], search.pieces[node, 1]
        counts[EXPANDED] += 1
        rest = rest_from(guide, x, y)
        # The last curve is tried often near the goal and seldom far from it.
        if counts[EXPANDED] % (1 + int(rest / (4.0 * limits.radius + 8.0))) == 0 or search.parents[node] < 0:
            for k in range(goals.shape[0]):
                end[0], end[1], end[2] = goals[k, 0], goals[k, 1], goals[k, 2]
                _try_last(field, limits, free, search, node, so_far, end, scratch)
        for direction in (1.0, -1.0):
            if direction < 0.0 and not limits.reverses:
                continue
            changing = limits.changing if length * direction < 0.0 else 0.0
            for bend in (0.0, 1.0, -1.0, 0.5, -0.5):
                curvature = bend / limits.radius
                cost = driven(field, x, y, heading, curvature, direction * search.step)
                if math.isinf(cost):
                    continue
                cost += changing + limits.bending * bend * bend * search.step
                to_x, to_y, to_heading = advanced(x, y, heading, curvature, direction * search.step)
                if not _reach(
                    guide, limits, goals, free, search, node,
                    to_x, to_y, to_heading, so_far + cost, curvature, direction * search.step, scratch,
                ):  # fmt: skip
                    return True
    return False


@kernel(inline="late")
def price_of_changes(limits: Limits) -> float:
    """Return the cost of a change of direction; infinite if the robot only drives forwards."""
    return limits.changing if limits.reverses else math.inf


@kernel
def _reach(
    guide: Floats,
    limits: Limits,
    goals: Floats,
    free: bool,
    search: Search,
    parent: int,
    x: float,
    y: float,
    heading: float,
    cost: float,
    curvature: float,
    length: float,
    scratch: Floats,
) -> bool:
    """Enter a pose unless a cheaper one is in its cell; return whether there is room for more nodes."""
    counts = search.counts
    rest = rest_from(guide, x, y)
    if math.isinf(rest) or cost + rest * 0.5 >= search.numbers[BEST_COST]:
        return True
    side = 1 << 20
    column = math.floor(x / search.cell) + (side >> 1)
    row = math.floor(y / search.cell) + (side >> 1)
    turn = int((heading % math.tau) / math.tau * search.headings) % search.headings
    key = ((column * side + row) * search.headings + turn) * 2 + (1 if length < 0.0 else 0)
    mask = search.keys.shape[0] - 1
    slot = (key ^ (key >> 17) ^ (key >> 31) * 7919) & mask
    slot = (slot * 2654435761) & mask
    while search.keys[slot] != -1 and search.keys[slot] != key:
        slot = (slot + 1) & mask
    queue = search.queue
    if search.keys[slot] == key:
        node = search.values[slot]
        if queue.length[node] <= cost:
            return True
        if queue.places[node] < 0:  # it was expanded, or is a start
            if queue.length[node] <= cost * (1.0 + 1e-9) or search.weight > 1.0:
                return True
            node = -1
    else:
        node = -1
    if node < 0:
        if counts[NODES] >= search.parents.shape[0]:
            return False
        node = counts[NODES]
        counts[NODES] += 1
        search.keys[slot] = key
        search.values[slot] = node
    search.poses[node, 0], search.poses[node, 1], search.poses[node, 2] = x, y, heading
    search.pieces[node, 0], search.pieces[node, 1] = curvature, length
    search.parents[node] = parent
    if goals.shape[0] == 1:
        alone = connected(
            search.poses[node], goals[0], limits.radius, price_of_changes(limits), free, math.inf, scratch
        )
        if math.isfinite(alone):
            rest = max(rest, alone)
    queue.length[node] = cost
    queue.cost[node] = cost + search.weight * rest
    counts[WAITING] = enter(queue, counts[WAITING], node)
    apart = math.sqrt((x - search.poses[0, 0]) ** 2 + (y - search.poses[0, 1]) ** 2)
    search.numbers[FARTHEST] = max(search.numbers[FARTHEST], apart)
    return True


@kernel
def _try_last(
    field: Field,
    limits: Limits,
    free: bool,
    search: Search,
    node: int,
    so_far: float,
    end: Floats,
    pieces: Floats,
) -> None:
    """Keep the curve over a node and from there straight to the goal if it is free and the best so far."""
    search.counts[TRIED] += 1
    pose = search.poses[node]
    most = search.numbers[BEST_COST] - so_far
    if not connected(pose, end, limits.radius, price_of_changes(limits), free, most, pieces) < most:
        return
    total = cost_of(field, limits, pose, pieces, search.pieces[node, 1], most)
    if total < most:
        search.numbers[BEST_COST] = so_far + total
        search.counts[BEST_NODE] = node
        if search.counts[FIRST_FOUND] < 0:
            search.counts[FIRST_FOUND] = search.counts[EXPANDED]
        for k in range(pieces.shape[0]):
            search.last[k, 0], search.last[k, 1] = pieces[k, 0], pieces[k, 1]


@kernel(borrows=True)
def cost_of(field: Field, limits: Limits, pose: Floats, pieces: Floats, before: float, most: float) -> float:
    """Return the cost of pieces, or infinity if they meet an obstacle or cost more than `most`.

    Args:
        field: obstacles and costs.
        limits: limits and costs.
        pose: pose at which they begin.
        pieces: curvature and length of each, (k, 2).
        before: length of the piece before them, whose sign is the direction; 0 if there is none.
        most: cost above which the result does not matter.
    """
    x, y, heading = pose[0], pose[1], pose[2]
    total = 0.0
    for k in range(pieces.shape[0]):
        curvature, length = pieces[k, 0], pieces[k, 1]
        if length == 0.0:
            continue
        if before * length < 0.0:
            total += limits.changing
        before = length
        total += piece_cost(field, limits, x, y, heading, curvature, length)
        if not total < most:
            return math.inf
        x, y, heading = advanced(x, y, heading, curvature, length)
    x, y, heading = pose[0], pose[1], pose[2]
    for k in range(pieces.shape[0]):
        if k > 0 and pieces[k, 1] == 0.0:
            continue  # its end is the one before it
        if not is_free(field, x, y, heading, pieces[k, 0], pieces[k, 1]):
            return math.inf
        x, y, heading = advanced(x, y, heading, pieces[k, 0], pieces[k, 1])
    return total


@kernel(inline="late")
def piece_cost(
    field: Field, limits: Limits, x: float, y: float, heading: float, curvature: float, length: float
) -> float:
    """Return the cost of a piece, free or not."""
    bend = curvature * limits.radius
    return cost_along(field, x, y, heading, curvature, length) + limits.bending * bend * bend * abs(length)


def found(search: Search) -> tuple[Floats, Floats]:
    """Return first pose and pieces, (k, 2), of the best curve that a search has found."""
    node, pieces = int(search.counts[BEST_NODE]), []
    while search.parents[node] >= 0:
        pieces.append(search.pieces[node])
        node = int(search.parents[node])
    return search.poses[node].copy(), np.vstack([*pieces[::-1], search.last])


@entry
def cost_between(field: Field, limits: Limits, begin: Floats, end: Floats, is_checked: bool) -> float:
    """Return the cost of the curve that `connected` makes between two poses; for planners to compare.

    Args:
        field: obstacles and costs.
        limits: limits and costs.
        begin: first pose, (3,).
        end: last pose, (3,).
        is_checked: whether the result is infinite where the curve meets an obstacle.
    """
    pieces = np.zeros((most_pieces(limits.reverses), 2))
    connected(begin, end, limits.radius, price_of_changes(limits), False, math.inf, pieces)
    if is_checked:
        return cost_of(field, limits, begin, pieces, 0.0, math.inf)
    x, y, heading = begin[0], begin[1], begin[2]
    total = 0.0
    for k in range(pieces.shape[0]):
        total += piece_cost(field, limits, x, y, heading, pieces[k, 0], pieces[k, 1])
        x, y, heading = advanced(x, y, heading, pieces[k, 0], pieces[k, 1])
    return total
