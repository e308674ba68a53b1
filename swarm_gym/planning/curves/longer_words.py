"""Curves of four and five pieces between poses, for a robot that drives forwards and backwards.

J. A. Reeds and L. A. Shepp, "Optimal paths for a car that goes both forwards and backwards", Pacific Journal
of Mathematics 145(2), 1990, list the words that a shortest curve can be. An arc is C, a straight line is S,
and a bar is a change of direction. This module has their words CC|CC, C|CC|C, C|CSC, CSC|C and C|CSC|C. The
module `words` has those of three pieces, and describes the coordinates.

The paper gets all variants of a word by symmetries. Here the inner pieces are tried in both directions, and
outer arcs take the cheaper one. Equations follow from the distance and the direction of the goal's circle,
seen from the first circle.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.planning.curves.words import Goal, arc, cost_of_arcs

Floats = NDArray[np.float64]

MOST = 5  # pieces of a word
QUARTER = math.pi / 2.0
TIE = 1e-10  # turning radii by which a word has to cost less than one of fewer pieces


@kernel(borrows=True)
def longer_word(goal: Goal, best: float, pieces: Floats) -> float:
    """Keep a word of four or five pieces if it costs less than the best curve; return the least cost.

    Args:
        goal: end of the curve.
        best: cost of the best curve so far.
        pieces: curvature and length of each piece, (5, 2), which are written if a word costs less.
    """
    sin, cos = math.sin(goal.turn), math.cos(goal.turn)
    to_x, to_y = goal.x + sin, goal.y - 1.0 - cos
    apart, towards = math.hypot(to_x, to_y), math.atan2(to_y, to_x)
    best = _four_arcs(goal, apart, towards, best, pieces)
    best = _quarters_at_both_ends(goal, apart, towards, best, pieces)
    best = _quarter_before_right(goal, apart, towards, False, best, pieces)
    best = _quarter_before_left(goal, goal.x - sin, goal.y - 1.0 + cos, False, best, pieces)
    # A curve whose pieces are driven in reverse order leads to this point.
    back_x, back_y = goal.x * cos + goal.y * sin, goal.x * sin - goal.y * cos
    to_x, to_y = back_x + sin, back_y - 1.0 - cos
    apart, towards = math.hypot(to_x, to_y), math.atan2(to_y, to_x)
    best = _quarter_before_right(goal, apart, towards, True, best, pieces)
    return _quarter_before_left(goal, back_x - sin, back_y - 1.0 + cos, True, best, pieces)


@kernel(inline="late")
def _put(pieces: Floats, k: int, curvature: float, length: float) -> None:
    """Write piece k."""
    pieces[k, 0], pieces[k, 1] = curvature, length


@kernel(inline="late")
def _four_arcs(goal: Goal, apart: float, towards: float, best: float, pieces: Floats) -> float:
    """Keep the best of left, right, left, right: CC|CC and C|CC|C, whose inner arcs are equally long.

    `apart` and `towards` are the distance and the direction of the goal's right circle.
    """
    bend, changing = goal.side / goal.radius, goal.changing / goal.radius
    for turns_back in (True, False):  # between the inner arcs
        # Their angle has the cosine (2 + d) / 4 in CC|CC, and (20 - d^2) / 16 in C|CC|C.
        cos = 0.25 * (2.0 + apart) if turns_back else (20.0 - apart * apart) / 16.0
        if not 0.0 <= cos <= 1.0:
            continue
        angle = math.acos(cos)
        price = goal.changing if turns_back else 0.0
        if 2.0 * goal.radius * angle + price >= best:
            continue
        for direction in (1.0, -1.0):
            inner = direction * angle
            if turns_back:
                start = towards + QUARTER + inner
                last = arc(start - 2.0 * inner - goal.turn, -direction, changing)
            else:
                start = towards + QUARTER - math.atan2(math.sin(inner), 2.0 - cos)
                last = arc(start - goal.turn, direction, changing)
            first = arc(start, direction, changing)
            # The last arc is compared with the direction of the second one.
            before = -last if turns_back else last
            cost = cost_of_arcs(goal, first, 2.0 * angle, direction, before) + price
            if cost < best - TIE * goal.radius:
                _put(pieces, 0, bend, goal.radius * first)
                _put(pieces, 1, -bend, goal.radius * inner)
                _put(pieces, 2, bend, goal.radius * (-inner if turns_back else inner))
                _put(pieces, 3, -bend, goal.radius * last)
                _put(pieces, 4, 0.0, 0.0)
                best = cost
    return best


@kernel(inline="late")
def _quarter_before_left(
    goal: Goal, to_x: float, to_y: float, is_back: bool, best: float, pieces: Floats
) -> float:
    """Keep the best of left, a quarter circle right, straight, left: C|CSC; in reverse order CSC|C.

    (`to_x`, `to_y`) is the centre of the last circle, from that of the first one.
    """
    square = to_x * to_x + to_y * to_y - 4.0
    # The line has the direction of the quarter circle, so shorter distances have no solution.
    straight = math.sqrt(square) - 2.0 if square >= 4.0 else -1.0
    if straight < 0.0 or goal.radius * (QUARTER + straight) >= best:
        return best
    changing, towards = goal.changing / goal.radius, math.atan2(to_y, to_x)
    for direction in (1.0, -1.0):  # of the quarter circle and the line
        heading = towards - math.atan2(2.0, direction * (straight + 2.0))  # on the line
        first = arc(heading + direction * QUARTER, direction, changing)
        last = arc(goal.turn - heading, direction, changing)
        best = _kept(goal, first, direction, straight, last, 1.0, is_back, best, pieces)
    return best


@kernel(inline="late")
def _quarter_before_right(
    goal: Goal, apart: float, towards: float, is_back: bool, best: float, pieces: Floats
) -> float:
    """Keep the best of left, a quarter circle right, straight, right: C|CSC; in reverse order CSC|C.

    `apart` and `towards` are the distance and the direction of the last circle.
    """
    straight = apart - 2.0
    if straight < 0.0 or goal.radius * (QUARTER + straight) >= best:
        return best
    changing = goal.changing / goal.radius
    for direction in (1.0, -1.0):
        heading = towards + (0.0 if direction > 0.0 else math.pi)
        first = arc(heading + direction * QUARTER, direction, changing)
        last = arc(heading - goal.turn, direction, changing)
        best = _kept(goal, first, direction, straight, last, -1.0, is_back, best, pieces)
    return best


@kernel(inline="late")
def _kept(
    goal: Goal,
    first: float,
    direction: float,
    straight: float,
    last: float,
    last_side: float,
    is_back: bool,
    best: float,
    pieces: Floats,
) -> float:
    """Keep an arc, a quarter circle, a line and an arc if they cost less, perhaps in reverse order."""
    cost = cost_of_arcs(goal, first, QUARTER + straight, direction, last)
    if not cost < best - TIE * goal.radius:
        return best
    bend = goal.side / goal.radius
    begin, step = (3, -1) if is_back else (0, 1)
    _put(pieces, begin, bend, goal.radius * first)
    _put(pieces, begin + step, -bend, goal.radius * direction * QUARTER)
    _put(pieces, begin + 2 * step, 0.0, goal.radius * direction * straight)
    _put(pieces, begin + 3 * step, last_side * bend, goal.radius * last)
    _put(pieces, 4, 0.0, 0.0)
    return cost


@kernel(inline="late")
def _quarters_at_both_ends(goal: Goal, apart: float, towards: float, best: float, pieces: Floats) -> float:
    """Keep the best of left, a quarter circle right, straight, a quarter circle left, right: C|CSC|C."""
    square = apart * apart - 4.0
    straight = math.sqrt(square) - 4.0 if square >= 16.0 else -1.0
    if straight < 0.0 or goal.radius * (math.pi + straight) >= best:
        return best
    bend, changing = goal.side / goal.radius, goal.changing / goal.radius
    for direction in (1.0, -1.0):  # of all but the outer arcs
        start = towards - math.atan2(2.0, direction * (straight + 4.0)) + direction * QUARTER
        first, last = arc(start, direction, changing), arc(start - goal.turn, direction, changing)
        cost = cost_of_arcs(goal, first, math.pi + straight, direction, last)
        if cost < best - TIE * goal.radius:
            _put(pieces, 0, bend, goal.radius * first)
            _put(pieces, 1, -bend, goal.radius * direction * QUARTER)
            _put(pieces, 2, 0.0, goal.radius * direction * straight)
            _put(pieces, 3, bend, goal.radius * direction * QUARTER)
            _put(pieces, 4, -bend, goal.radius * last)
            best = cost
    return best
