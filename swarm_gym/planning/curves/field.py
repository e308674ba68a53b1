"""Fields: obstacles and costs of ground as kernels for curves read them, on a lattice of nodes.

Coordinates are columns and rows of the lattice: node (column, row) is at (column, row). An obstacle is a set
of capsules, segments with a radius: edges of polygons and blocked cells have the radius 0, and a disc is a
segment of length 0. A robot that begins outside cannot get inside without meeting an edge.

A piece of a curve is driven in steps. At each step the exact distance from obstacles, or a lower bound, says
how far the curve surely keeps the margin on both sides. These parts overlap, so a piece that is driven keeps
the margin everywhere. The price is the `SLACK`: a curve that comes closer to the margin than that is refused.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.planning.curves.pieces import advanced

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SLACK = 0.005  # distance besides the margin that a curve keeps, in steps of the lattice
REACH = 2.0  # beyond the margin, within which distances are exact
HALF = 0.7072  # largest distance of a point from its nearest node
STEP = 0.5  # longest step of an integral of costs


class Field(NamedTuple):
    """Obstacles, distances and costs."""

    capsules: Floats
    "Ends and radius of each obstacle, (m, 5)."
    first: Integers
    "Index of the first entry of each node, and the number of entries, (rows * columns + 1,)."
    entries: NDArray[np.int32]
    "Capsules that can be closer than `reach` to a point at a node."
    apart: Floats
    "Distance of each node from obstacles, (rows, columns): exact below `reach`, else a lower bound."
    cost: Floats
    "Cost of a unit of length at each node, at least 1, (rows, columns)."
    region: Floats
    "Least x and y and largest x and y of the robot's centre, (4,)."
    margin: float
    "Distance that the centre keeps from obstacles."
    reach: float
    "Distance up to which distances are exact."
    is_even: bool
    "True if all costs are 1."


@kernel(inline="late")
def _to_capsule(x: float, y: float, capsules: Floats, k: int) -> float:
    x0, y0 = capsules[k, 0], capsules[k, 1]
    dx, dy = capsules[k, 2] - x0, capsules[k, 3] - y0
    squared = dx * dx + dy * dy
    share = 0.0
    if squared > 0.0:
        share = min(max(((x - x0) * dx + (y - y0) * dy) / squared, 0.0), 1.0)
    x, y = x - x0 - share * dx, y - y0 - share * dy
    return math.sqrt(x * x + y * y) - capsules[k, 4]


@entry
def entries_of(
    capsules: Floats, rows: int, columns: int, reach: float
) -> tuple[Integers, NDArray[np.int32], Floats]:
    """Return first entries and entries of a field, and the distances of nodes as far as these give them.

    Args:
        capsules: obstacles, (m, 5).
        rows: number of rows of the lattice.
        columns: number of columns.
        reach: distance up to which distances are exact.
    """
    apart = np.full((rows, columns), np.inf)
    first = np.zeros(rows * columns + 1, np.int64)
    entries = np.zeros(0, np.int32)
    for is_writing in (False, True):
        if is_writing:
            for node in range(rows * columns):
                first[node + 1] += first[node]
            entries = np.zeros(first[rows * columns], np.int32)
            first[1:] = first[:-1].copy()  # each is moved to the end of its node while entries are written
            first[0] = 0
        for k in range(capsules.shape[0]):
            around = reach + HALF + capsules[k, 4]
            left = max(math.ceil(min(capsules[k, 0], capsules[k, 2]) - around), 0)
            right = min(math.floor(max(capsules[k, 0], capsules[k, 2]) + around), columns - 1)
            low = max(math.ceil(min(capsules[k, 1], capsules[k, 3]) - around), 0)
            high = min(math.floor(max(capsules[k, 1], capsules[k, 3]) + around), rows - 1)
            for row in range(low, high + 1):
                for column in range(left, right + 1):
                    distance = _to_capsule(column, row, capsules, k)
                    if distance > reach + HALF:
                        continue
                    node = row * columns + column
                    if is_writing:
                        entries[first[node + 1]] = k
                        first[node + 1] += 1
                    else:
                        first[node + 1] += 1
                        apart[row, column] = min(apart[row, column], distance)
    return first, entries, apart


@kernel(borrows=True)
def distance(field: Field, x: float, y: float) -> float:
    """Return the distance of a point from obstacles; a lower bound beyond the margin and 1."""
    rows, columns = field.apart.shape
    column = min(max(math.floor(x + 0.5), 0), columns - 1)
    row = min(max(math.floor(y + 0.5), 0), rows - 1)
    to_x, to_y = x - column, y - row
    least = field.apart[row, column] - math.sqrt(to_x * to_x + to_y * to_y)
    if least > field.margin + 1.0:
        return least
    least = field.reach
    node = row * columns + column
    for k in range(field.first[node], field.first[node + 1]):
        least = min(least, _to_capsule(x, y, field.capsules, field.entries[k]))
    return least


@kernel(borrows=True)
def room(field: Field, x: float, y: float) -> float:
    """Return a distance by which a robot surely can move from a point; negative where it cannot be."""
    region = field.region
    border = min(x - region[0], region[2] - x, y - region[1], region[3] - y)
    if border < 0.0:
        return border
    # The border is no obstacle: the centre may lie on it.
    return min(distance(field, x, y) - field.margin, border + SLACK)


@kernel(inline="late")
def cost_at(field: Field, x: float, y: float) -> float:
    """Return the cost of a unit of length at a point."""
    rows, columns = field.cost.shape
    column = min(max(math.floor(x + 0.5), 0), columns - 1)
    row = min(max(math.floor(y + 0.5), 0), rows - 1)
    return field.cost[row, column]


@kernel(borrows=True)
def is_free(field: Field, x: float, y: float, heading: float, curvature: float, length: float) -> bool:
    """Return whether a piece that begins at a pose keeps the margin and the slack."""
    whole, along = abs(length), 0.0
    sign = 1.0 if length >= 0.0 else -1.0
    while along < whole:
        here_x, here_y, _ = advanced(x, y, heading, curvature, sign * along)
        free = room(field, here_x, here_y)
        if free < SLACK:
            return False
        along += free + 0.5 * SLACK  # the next step keeps the margin for at least the slack before it
    here_x, here_y, _ = advanced(x, y, heading, curvature, length)
    return room(field, here_x, here_y) >= SLACK


@kernel(borrows=True)
def cost_along(field: Field, x: float, y: float, heading: float, curvature: float, length: float) -> float:
    """Return the integral of costs along a piece that begins at a pose."""
    whole = abs(length)
    if field.is_even:
        return whole
    steps = math.ceil(whole / STEP)
    total, step = 0.0, length / max(steps, 1)
    for k in range(steps):
        here_x, here_y, _ = advanced(x, y, heading, curvature, (k + 0.5) * step)
        total += cost_at(field, here_x, here_y)
    return total * abs(step)


@kernel(borrows=True)
def driven(field: Field, x: float, y: float, heading: float, curvature: float, length: float) -> float:
    """Return the integral of costs along a piece, or infinity if it does not keep the margin."""
    if not is_free(field, x, y, heading, curvature, length):
        return math.inf
    return cost_along(field, x, y, heading, curvature, length)


@entry
def room_at(field: Field, x: float, y: float) -> float:
    """Return how much farther from obstacles a point is than the margin and the slack, in lattice steps."""
    return room(field, x, y) - SLACK


@entry
def nearest(capsules: Floats, points: Floats) -> Floats:
    """Return the exact distance of each point, (n, 2), from the nearest capsule; infinite without any."""
    found = np.full(points.shape[0], np.inf)
    for n in range(points.shape[0]):
        for k in range(capsules.shape[0]):
            found[n] = min(found[n], _to_capsule(points[n, 0], points[n, 1], capsules, k))
    return found
