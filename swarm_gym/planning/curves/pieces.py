"""Pieces of curves: arcs and straight lines, and the shortest curves of two or three of them between poses.

A pose is (x, y, heading), with headings in radians from the x axis towards the y axis. A piece is (curvature,
length); the curvature is positive where the heading grows with the length, and the length is negative where
the robot reverses. Lengths have the unit of the coordinates.

Forward only, the curves come from L. E. Dubins, "On curves of minimal length with a constraint on average
curvature, and with prescribed initial and terminal positions and tangents", American Journal of Mathematics
79(3), 1957. With reversing, they are the words CSC and CCC of J. A. Reeds and L. A. Shepp, "Optimal paths for
a car that goes both forwards and backwards", Pacific Journal of Mathematics 145(2), 1990. Their words of four
and five pieces are missing, so these curves can be longer than the shortest.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel

Floats = NDArray[np.float64]

FULL_TURN = 1e-10  # an angle so little below a full turn is none, by rounding


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


@entry
def connect(
    begin: Floats, end: Floats, radius: float, reverses: bool, is_free: bool, pieces: Floats
) -> float:
    """Write the shortest curve between two poses into three pieces, (3, 2); return its length.

    Args:
        begin: first pose, (3,).
        end: last pose, (3,).
        radius: radius of its arcs.
        reverses: whether the robot may drive backwards.
        is_free: whether the heading at the end is free; then the curve has an arc and a straight line.
        pieces: array that is written; not meaningful if the result is infinite: there is no curve.
    """
    return connected(begin, end, radius, reverses, is_free, pieces)


@kernel(borrows=True)
def connected(
    begin: Floats, end: Floats, radius: float, reverses: bool, is_free: bool, pieces: Floats
) -> float:
    """Do the same as `connect`, for kernels."""
    best = math.inf
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    for side in (1.0, -1.0):
        # The words that begin with a left turn, in the plane as it is and mirrored at the first heading.
        cos, sin = math.cos(begin[2]), math.sin(begin[2])
        x, y = (dx * cos + dy * sin) / radius, side * (dy * cos - dx * sin) / radius
        turn = side * (end[2] - begin[2])
        for direction in (1.0, -1.0):
            if direction < 0.0 and not reverses:
                continue
            if is_free:
                best = _to_point(x, y, side, direction, reverses, radius, best, pieces)
            else:
                best = _left_left(x, y, turn, side, direction, reverses, radius, best, pieces)
                best = _left_right(x, y, turn, side, direction, reverses, radius, best, pieces)
                best = _three_arcs(x, y, turn, side, direction, reverses, radius, best, pieces)
    return best


@kernel(inline="late")
def _angle(value: float, reverses: bool) -> float:
    """Return an angle in [0, 2 pi) for the way forwards, or in [-pi, pi] for the shorter one."""
    angle = value % math.tau
    if math.tau - angle < FULL_TURN:
        return 0.0
    return angle - math.tau if reverses and angle > math.pi else angle


@kernel(inline="late")
def _kept(
    first: float, second: float, third: float, middle: float, last: float, radius: float, pieces: Floats
) -> None:
    """Write three pieces: lengths in radii, and curvatures of two of them relative to the first curvature."""
    pieces[0, 1], pieces[1, 1], pieces[2, 1] = radius * first, radius * second, radius * third
    pieces[0, 0] = pieces[0, 0] / radius
    pieces[1, 0], pieces[2, 0] = middle * pieces[0, 0], last * pieces[0, 0]


@kernel(inline="late")
def _left_left(
    x: float,
    y: float,
    turn: float,
    side: float,
    direction: float,
    reverses: bool,
    radius: float,
    best: float,
    pieces: Floats,
) -> float:
    """Keep a left turn, a straight line and a left turn if they are shorter; return the least length."""
    to_x, to_y = x - math.sin(turn), y - 1.0 + math.cos(turn)
    straight = direction * math.hypot(to_x, to_y)
    heading = math.atan2(direction * to_y, direction * to_x)
    first, last = _angle(heading, reverses), _angle(turn - heading, reverses)
    length = radius * (abs(first) + abs(straight) + abs(last))
    if length < best:
        pieces[0, 0] = side
        _kept(first, straight, last, 0.0, 1.0, radius, pieces)
        return length
    return best


@kernel(inline="late")
def _left_right(
    x: float,
    y: float,
    turn: float,
    side: float,
    direction: float,
    reverses: bool,
    radius: float,
    best: float,
    pieces: Floats,
) -> float:
    """Keep a left turn, a straight line and a right turn if they are shorter; return the least length."""
    to_x, to_y = x + math.sin(turn), y - 1.0 - math.cos(turn)
    square = to_x * to_x + to_y * to_y - 4.0
    if square < 0.0:
        return best
    straight = direction * math.sqrt(square)
    # Seen along the straight line, the second centre is at (straight, -2) from the first.
    heading = math.atan2(to_y, to_x) - math.atan2(-2.0, straight)
    first, last = _angle(heading, reverses), _angle(heading - turn, reverses)
    length = radius * (abs(first) + abs(straight) + abs(last))
    if length < best:
        pieces[0, 0] = side
        _kept(first, straight, last, 0.0, -1.0, radius, pieces)
        return length
    return best


@kernel(inline="late")
def _three_arcs(
    x: float,
    y: float,
    turn: float,
    side: float,
    direction: float,
    reverses: bool,
    radius: float,
    best: float,
    pieces: Floats,
) -> float:
    """Keep left, right and left turns if they are shorter; return the least length."""
    to_x, to_y = x - math.sin(turn), y - 1.0 + math.cos(turn)
    apart = math.hypot(to_x, to_y)
    if apart > 4.0:
        return best
    towards = math.atan2(to_y, to_x)
    # The middle circle touches both others; it lies on either side of the line between their centres.
    for bend in (1.0, -1.0):
        if reverses and bend != direction:  # both directions come here
            continue
        out = towards + bend * math.acos(apart / 4.0)
        back = math.atan2(to_y - 2.0 * math.sin(out), to_x - 2.0 * math.cos(out))
        first = _angle(out + math.pi / 2.0, reverses)
        middle = _angle(out + math.pi - back, reverses)
        last = _angle(turn - back + math.pi / 2.0, reverses)
        length = radius * (abs(first) + abs(middle) + abs(last))
        if length < best:
            pieces[0, 0] = side
            _kept(first, middle, last, -1.0, 1.0, radius, pieces)
            best = length
    return best


@kernel(inline="late")
def _to_point(
    x: float,
    y: float,
    side: float,
    direction: float,
    reverses: bool,
    radius: float,
    best: float,
    pieces: Floats,
) -> float:
    """Keep a left turn and a straight line to a point if they are shorter; return the least length."""
    to_x, to_y = x, y - 1.0
    square = to_x * to_x + to_y * to_y - 1.0
    if square < 0.0:
        return best
    straight = direction * math.sqrt(square)
    first = _angle(math.atan2(to_y, to_x) - math.atan2(-1.0, straight), reverses)
    length = radius * (abs(first) + abs(straight))
    if length < best:
        pieces[0, 0] = side
        _kept(first, straight, 0.0, 0.0, 0.0, radius, pieces)
        return length
    return best
