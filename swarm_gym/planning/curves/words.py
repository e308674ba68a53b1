"""Curves of two and three pieces between poses: words of arcs C and straight lines S.

Forward only, CSC and CCC hold the shortest curve, by L. E. Dubins, "On curves of minimal length with a
constraint on average curvature, and with prescribed initial and terminal positions and tangents", American
Journal of Mathematics 79(3), 1957. With reversing, they are the words of three pieces of J. A. Reeds and
L. A. Shepp, "Optimal paths for a car that goes both forwards and backwards", Pacific Journal of Mathematics
145(2), 1990. Their other words are in `longer_words`.

Lengths are in turning radii here. A curve begins at the origin along the x axis, and its first arc turns left
around (0, 1); where the first arc turns right, the plane is mirrored. A word is kept if its length and its
changes of direction cost less than the best curve so far.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel

Floats = NDArray[np.float64]

FULL_TURN = 1e-10  # an angle so little below a full turn is none, by rounding
ROUNDING = 1e-7  # radians by which an angle may be wrong that is compared before it is calculated


class Goal(NamedTuple):
    """The end of a curve, seen from its begin, and what a curve costs."""

    x: float
    "Way along the first heading, in turning radii."
    y: float
    "Way to the side of the first arc, in turning radii."
    turn: float
    "Heading at the end, positive to the side of the first arc."
    side: float
    "1 if the first arc turns left in the plane, -1 if it turns right."
    radius: float
    "Turning radius; lengths times this one are costs."
    changing: float
    "Cost of a change of direction; infinite if the robot only drives forwards."


@kernel(inline="late")
def arc(angle: float, direction: float, changing: float) -> float:
    """Return the angle that is driven on an arc, negative backwards: the cheaper one of both ways.

    Args:
        angle: angle of the arc, up to full turns.
        direction: direction of the piece next to the arc, 1 or -1.
        changing: cost of a change of direction between both, in turning radii.
    """
    angle = direction * angle
    if math.isinf(changing):
        angle %= math.tau
    else:
        angle -= math.tau * math.floor(angle * (1.0 / math.tau))  # faster; the last bit may differ
    rest = math.tau - angle
    if rest < FULL_TURN or angle < 0.0:
        return 0.0
    return -direction * rest if rest + changing < angle else direction * angle


@kernel(inline="late")
def cost_of_arcs(goal: Goal, first: float, middle: float, direction: float, last: float) -> float:
    """Return the cost of an arc, pieces of one direction between, and an arc.

    Args:
        goal: has the costs.
        first: angle of the first arc.
        middle: length of what lies between, in turning radii, not negative.
        direction: direction of what lies between, 1 or -1.
        last: angle of the last arc.
    """
    cost = goal.radius * (abs(first) + middle + abs(last))
    if first * direction < 0.0:
        cost += goal.changing
    if last * direction < 0.0:
        cost += goal.changing
    return cost


@kernel(inline="late")
def _keep(
    goal: Goal, first: float, second: float, third: float, middle: float, last: float, pieces: Floats
) -> None:
    """Write three pieces: lengths in radii, and curvatures of two of them relative to the first curvature."""
    pieces[0, 1], pieces[1, 1], pieces[2, 1] = goal.radius * first, goal.radius * second, goal.radius * third
    pieces[0, 0] = goal.side / goal.radius
    pieces[1, 0], pieces[2, 0] = middle * pieces[0, 0], last * pieces[0, 0]


@kernel(inline="late")
def left_left(goal: Goal, best: float, pieces: Floats) -> float:
    """Keep a left turn, a straight line and a left turn if they cost less; return the least cost."""
    to_x, to_y = goal.x - math.sin(goal.turn), goal.y - 1.0 + math.cos(goal.turn)
    straight = math.hypot(to_x, to_y)
    if goal.radius * straight >= best:
        return best
    towards = math.atan2(to_y, to_x)
    changing = goal.changing / goal.radius
    for direction in (1.0, -1.0):
        if direction < 0.0 and math.isinf(changing):
            continue
        heading = towards if direction > 0.0 else towards + math.pi
        first, last = arc(heading, direction, changing), arc(goal.turn - heading, direction, changing)
        cost = cost_of_arcs(goal, first, straight, direction, last)
        if cost < best:
            _keep(goal, first, direction * straight, last, 0.0, 1.0, pieces)
            best = cost
    return best


@kernel(inline="late")
def left_right(goal: Goal, best: float, pieces: Floats) -> float:
    """Keep a left turn, a straight line and a right turn if they cost less; return the least cost."""
    to_x, to_y = goal.x + math.sin(goal.turn), goal.y - 1.0 - math.cos(goal.turn)
    square = to_x * to_x + to_y * to_y - 4.0
    if square < 0.0:
        return best
    straight = math.sqrt(square)
    if goal.radius * straight >= best:
        return best
    # Seen along the straight line, the second centre is at (straight, -2) from the first.
    towards, beside = math.atan2(to_y, to_x), math.atan2(-2.0, straight)
    changing = goal.changing / goal.radius
    for direction in (1.0, -1.0):
        if direction < 0.0 and math.isinf(changing):
            continue
        heading = towards - (beside if direction > 0.0 else -math.pi - beside)
        first, last = arc(heading, direction, changing), arc(heading - goal.turn, direction, changing)
        cost = cost_of_arcs(goal, first, straight, direction, last)
        if cost < best:
            _keep(goal, first, direction * straight, last, 0.0, -1.0, pieces)
            best = cost
    return best


@kernel(inline="late")
def three_arcs(goal: Goal, best: float, pieces: Floats) -> float:
    """Keep left, right and left turns if they cost less; return the least cost."""
    to_x, to_y = goal.x - math.sin(goal.turn), goal.y - 1.0 + math.cos(goal.turn)
    apart = math.hypot(to_x, to_y)
    if apart > 4.0:
        return best
    towards, aside = math.atan2(to_y, to_x), math.acos(apart / 4.0)
    changing = goal.changing / goal.radius
    # The middle circle touches both others; it lies on either side of the line between their centres.
    for bend in (1.0, -1.0):
        out = back = 0.0
        is_known = False
        for direction in (1.0, -1.0):
            if direction < 0.0 and math.isinf(changing):
                continue
            # Forwards, the middle arc has this angle; backwards it has the rest of the circle.
            angle = math.pi + 2.0 * aside * bend * direction
            if angle < math.tau - ROUNDING and goal.radius * (angle - ROUNDING) >= best:
                continue
            if not is_known:
                out = towards + bend * aside
                back = math.atan2(to_y - 2.0 * math.sin(out), to_x - 2.0 * math.cos(out))
                is_known = True
            first = arc(out + math.pi / 2.0, direction, changing)
            middle = arc(out + math.pi - back, direction, math.inf)
            last = arc(goal.turn - back + math.pi / 2.0, direction, changing)
            cost = cost_of_arcs(goal, first, abs(middle), direction, last)
            if cost < best:
                _keep(goal, first, middle, last, -1.0, 1.0, pieces)
                best = cost
    return best


@kernel(inline="late")
def left_to_point(goal: Goal, best: float, pieces: Floats) -> float:
    """Keep a left turn and a straight line to a point if they cost less; return the least cost."""
    to_x, to_y = goal.x, goal.y - 1.0
    square = to_x * to_x + to_y * to_y - 1.0
    if square < 0.0:
        return best
    straight = math.sqrt(square)
    towards = math.atan2(to_y, to_x)
    changing = goal.changing / goal.radius
    for direction in (1.0, -1.0):
        if direction < 0.0 and math.isinf(changing):
            continue
        first = arc(towards - math.atan2(-1.0, direction * straight), direction, changing)
        cost = cost_of_arcs(goal, first, straight, direction, 0.0)
        if cost < best:
            _keep(goal, first, direction * straight, 0.0, 0.0, 0.0, pieces)
            best = cost
    return best
