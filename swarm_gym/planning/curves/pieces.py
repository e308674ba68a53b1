"""Pieces of curves: arcs and straight lines, and the shortest curves of them between two poses.

A pose is (x, y, heading), with headings in radians from the x axis towards the y axis. A piece is (curvature,
length); the curvature is positive where the heading grows with the length, and the length is negative where
the robot reverses. Lengths have the unit of the coordinates.

Forward only, the shortest curve is one of Dubins' words, see `words`. With reversing, it is one of the words
of Reeds and Shepp, see `longer_words`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.planning.curves.longer_words import MOST, longer_word
from swarm_gym.planning.curves.words import Goal, left_left, left_right, left_to_point, three_arcs

Floats = NDArray[np.float64]


@kernel(inline="late")
def advanced(
    x: float, y: float, heading: float, curvature: float, length: float
) -> tuple[float, float, float]:
    """Return the pose after a piece."""
    half = 0.5 * curvature * length
    # The chord has the middle heading; sin(a) / a tends to 1 on straight lines.
    chord = length * (math.sin(half) / half if abs(half) > 1e-6 else 1.0 - half * half / 6.0)
    middle = heading + half
    return x + chord * math.cos(middle), y + chord * math.sin(middle), heading + 2.0 * half


@kernel(inline="late")
def most_pieces(reverses: bool) -> int:
    """Return the number of pieces that the shortest curve between two poses can have."""
    return MOST if reverses else 3


@entry
def connect(
    begin: Floats, end: Floats, radius: float, reverses: bool, is_free: bool, pieces: Floats
) -> float:
    """Write the shortest curve between two poses as pieces; return its length.

    Args:
        begin: first pose, (3,).
        end: last pose, (3,).
        radius: radius of its arcs.
        reverses: whether the robot may drive backwards.
        is_free: whether the heading at the end is free; then the curve has an arc and a straight line.
        pieces: array that is written, (`most_pieces`, 2) or longer; pieces that are not needed have length 0.
            It is not meaningful if the result is infinite: there is no curve.

    Raises:
        ValueError: if the array is too short.
    """
    if pieces.shape[0] < most_pieces(reverses):
        raise ValueError("pieces: expected three rows, or five for a robot that reverses")
    return connected(begin, end, radius, 0.0 if reverses else math.inf, is_free, math.inf, pieces)


@kernel(borrows=True)
def connected(
    begin: Floats, end: Floats, radius: float, changing: float, is_free: bool, most: float, pieces: Floats
) -> float:
    """Write the cheapest of the words between two poses as pieces, and return its cost.

    The cost is the length, and `changing` for each change of direction inside the word. With 0, the result is
    the shortest curve of Reeds and Shepp; with infinity, it is the shortest curve that is driven forwards.

    Args:
        begin: first pose, (3,).
        end: last pose, (3,).
        radius: radius of its arcs.
        changing: cost of a change of direction.
        is_free: whether the heading at the end is free.
        most: result if no word costs less; then `pieces` is not meaningful.
        pieces: array that is written, with three rows for infinite `changing`, else five.
    """
    best = most
    for k in range(3, pieces.shape[0]):
        pieces[k, 0] = pieces[k, 1] = 0.0
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    cos, sin = math.cos(begin[2]), math.sin(begin[2])
    for side in (1.0, -1.0):
        # The words that begin with a left turn, in the plane as it is and mirrored at the first heading.
        x, y = (dx * cos + dy * sin) / radius, side * (dy * cos - dx * sin) / radius
        goal = Goal(x, y, side * (end[2] - begin[2]), side, radius, changing)
        if is_free:
            best = left_to_point(goal, best, pieces)
        else:
            best = left_left(goal, best, pieces)
            best = left_right(goal, best, pieces)
            best = three_arcs(goal, best, pieces)
    if is_free or math.isinf(changing):
        return best
    for side in (1.0, -1.0):
        x, y = (dx * cos + dy * sin) / radius, side * (dy * cos - dx * sin) / radius
        goal = Goal(x, y, side * (end[2] - begin[2]), side, radius, changing)
        best = longer_word(goal, best, pieces)
    return best
