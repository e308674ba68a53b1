"""Local search for drivable curves: parts are replaced by others that cost less and obey the same limits.

A trial draws a part of the curve and a radius of arcs. It tries the curve between both ends of the part whose
length and changes of direction cost least. Or it tries two such curves over a pose that is drawn near the
part. So the limits hold before and after each trial, and the cost never grows.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.planning.curves.field import Field
from swarm_gym.planning.curves.pieces import advanced, connected, most_pieces
from swarm_gym.planning.curves.search import Limits, cost_of, piece_cost, price_of_changes

Floats = NDArray[np.float64]

MOST_PIECES = 4096
DRAWS = 8  # uniform numbers of a trial
NOTHING = 1e-9  # length of a piece that counts as none
GAIN = 1e-7  # share by which a part must cost less to count
RADII = np.array([1.0, 1.0, 1.0, 1.4, 2.0, 3.0, 5.0, 9.0])  # of arcs, over the least radius
SHORTEST = 0.3  # shortest part that is replaced, in turning radii
ASIDE, TURNED = 0.3, 1.0  # how far poses are drawn from a part: over its length, and in radians, at most
SMALLEST = 0.003  # smallest share of these

# Places among the numbers of a chain.
PIECES, COST, LENGTH = range(3)


class Chain(NamedTuple):
    """A curve as a chain of pieces."""

    pieces: Floats
    "Curvature and length of each piece, (MOST_PIECES, 2)."
    poses: Floats
    "Pose at the begin of each piece, and behind the last, (MOST_PIECES + 1, 3)."
    costs: Floats
    "Cost of each piece, without changes of direction, (MOST_PIECES,)."
    along: Floats
    "Length of the curve up to each piece, and behind the last, (MOST_PIECES + 1,)."
    numbers: Floats
    "Number of pieces, cost of all, length of all, (3,)."


@entry
def chain_of(field: Field, limits: Limits, pose: Floats, pieces: Floats) -> Chain:
    """Return the chain of at most `MOST_PIECES` pieces, (k, 2), from a pose."""
    chain = Chain(
        np.zeros((MOST_PIECES, 2)),
        np.zeros((MOST_PIECES + 1, 3)),
        np.zeros(MOST_PIECES),
        np.zeros(MOST_PIECES + 1),
        np.zeros(3),
    )
    chain.poses[0] = pose
    costed = np.full((pieces.shape[0], 3), -1.0)
    costed[:, :2] = pieces
    _follow(field, limits, chain, costed, pieces.shape[0], 0)
    return chain


@kernel
def _follow(field: Field, limits: Limits, chain: Chain, pieces: Floats, count: int, first: int) -> None:
    """Write pieces from piece `first` on, each with its cost if that is known, else negative, (count, 3).

    Neighbours of one curvature and direction become one piece. There must be room for all.
    """
    number = first
    for k in range(count):
        curvature, length, cost = pieces[k, 0], pieces[k, 1], pieces[k, 2]
        if abs(length) < NOTHING * 1e-3:
            continue
        last = number - 1
        x, y, heading = chain.poses[number, 0], chain.poses[number, 1], chain.poses[number, 2]
        if cost < 0.0:
            cost = piece_cost(field, limits, x, y, heading, curvature, length)
        if number > first and chain.pieces[last, 0] == curvature and chain.pieces[last, 1] * length > 0.0:
            chain.pieces[last, 1] += length
            chain.costs[last] += cost
        else:
            chain.pieces[number, 0], chain.pieces[number, 1] = curvature, length
            chain.costs[number] = cost
            last = number
            number += 1
        x, y, heading = advanced(x, y, heading, curvature, length)
        chain.poses[number, 0], chain.poses[number, 1], chain.poses[number, 2] = x, y, heading
        chain.along[number] = chain.along[last] + abs(chain.pieces[last, 1])
    total, before = 0.0, 0.0
    for k in range(number):
        total += chain.costs[k] + (limits.changing if before * chain.pieces[k, 1] < 0.0 else 0.0)
        before = chain.pieces[k, 1]
    chain.numbers[PIECES], chain.numbers[COST], chain.numbers[LENGTH] = number, total, chain.along[number]


@kernel(inline="late")
def _piece_at(chain: Chain, along: float) -> int:
    """Return the number of the piece at a length of the curve."""
    low, high = 0, int(chain.numbers[PIECES]) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if chain.along[middle] <= along:
            low = middle
        else:
            high = middle - 1
    return low


@kernel(inline="late")
def _write_pose(chain: Chain, k: int, along: float, pose: Floats) -> float:
    """Write the pose at a length of the curve on piece k; return the signed length of k before it."""
    sign = 1.0 if chain.pieces[k, 1] >= 0.0 else -1.0
    part = sign * (along - chain.along[k])
    x, y, heading = advanced(
        chain.poses[k, 0], chain.poses[k, 1], chain.poses[k, 2], chain.pieces[k, 0], part
    )
    pose[0], pose[1], pose[2] = x, y, heading
    return part


class _Part(NamedTuple):
    """A part of a chain, between two poses."""

    first: float
    "Length of the curve at which it begins."
    last: float
    "Length of the curve at which it ends."
    k: int
    "Piece in which it begins."
    n: int
    "Piece in which it ends."
    into: float
    "Signed length of piece k before the part."
    out: float
    "Signed length of piece n behind the part."
    before: float
    "Number with the sign of the direction before the part; 0 at the start."
    behind: float
    "Number with the sign of the direction behind the part; 0 at the goal."
    left: float
    "Cost of piece k before the part."
    right: float
    "Cost of piece n behind the part."
    cost: float
    "Cost of the part, with changes of direction at its ends."


@entry
def shorten(
    field: Field,
    limits: Limits,
    chain: Chain,
    starts_free: bool,
    ends_free: bool,
    stream: NDArray[np.uint64],
    trials: int,
) -> int:
    """Try to replace parts of a chain so many times; return how often one was replaced.

    Args:
        field: obstacles and costs.
        limits: limits and costs.
        chain: the curve, which is changed.
        starts_free: whether the heading at the start may change.
        ends_free: whether the heading at the goal may change.
        stream: random numbers.
        trials: number of trials.
    """
    most_of_one, changing = most_pieces(limits.reverses), price_of_changes(limits)
    draws, tried = np.zeros(DRAWS), np.zeros((2 * most_of_one, 2))
    begin, middle, end = np.zeros(3), np.zeros(3), np.zeros(3)
    spliced = np.zeros((MOST_PIECES + 8, 3))
    replaced = 0
    for _ in range(trials):
        fill_uniform(stream, draws)
        whole = chain.numbers[LENGTH]
        least = min(SHORTEST * limits.radius, whole)
        span = least * (whole / least) ** draws[0]
        first, last = max(draws[1] * whole - 0.5 * span, 0.0), min(draws[1] * whole + 0.5 * span, whole)
        part = _part_of(field, limits, chain, first, last, begin, end)
        reach = SMALLEST ** draws[2]
        if starts_free and first == 0.0 and draws[3] < 0.6:
            begin[2] += TURNED * 2.0 * reach * (2.0 * draws[7] - 1.0)
        is_free = ends_free and last == whole and draws[3] > 0.4
        radius = limits.radius * RADII[int(draws[4] * RADII.shape[0])]
        most = part.cost * (1.0 - GAIN)
        if draws[3] < 0.5:
            count = most_of_one
            least = connected(begin, end, radius, changing, is_free, most, tried[:most_of_one])
        else:
            count = 2 * most_of_one
            _draw_beside(chain, part, draws, reach, middle)
            least = connected(begin, middle, radius, changing, False, most, tried[:most_of_one])
            rest = most - least + NOTHING
            least += connected(middle, end, radius, changing, is_free, rest, tried[most_of_one:])
        if not least < most:
            continue
        cost = cost_of(field, limits, begin, tried[:count], part.before, most)
        if cost < most and _direction_at_end(tried, count) * part.behind < 0.0:
            cost += limits.changing
        number = int(chain.numbers[PIECES])
        if not cost < most or part.k + count + number - part.n + 2 >= MOST_PIECES:
            continue
        if part.first == 0.0:
            chain.poses[0, 2] = begin[2]
        total = _spliced(chain, part, tried, count, spliced)
        _follow(field, limits, chain, spliced, total, part.k)
        replaced += 1
    return replaced


@kernel
def _part_of(
    field: Field, limits: Limits, chain: Chain, first: float, last: float, begin: Floats, end: Floats
) -> _Part:
    """Return the part of a chain between two lengths, and write the poses there."""
    k, n = _piece_at(chain, first), _piece_at(chain, last)
    into = _write_pose(chain, k, first, begin)
    out = chain.pieces[n, 1] - _write_pose(chain, n, last, end)
    before, behind = into, out
    cost, direction = 0.0, 0.0
    if abs(into) < NOTHING:
        before = chain.pieces[k - 1, 1] if k > 0 else 0.0
        direction = before
    for piece in range(k, n + 1):
        cost += chain.costs[piece]
        if direction * chain.pieces[piece, 1] < 0.0:
            cost += limits.changing
        direction = chain.pieces[piece, 1]
    if abs(out) < NOTHING:
        behind = chain.pieces[n + 1, 1] if n + 1 < int(chain.numbers[PIECES]) else 0.0
        if behind * direction < 0.0:
            cost += limits.changing
    x, y, heading = chain.poses[k, 0], chain.poses[k, 1], chain.poses[k, 2]
    left = piece_cost(field, limits, x, y, heading, chain.pieces[k, 0], into)
    right = piece_cost(field, limits, end[0], end[1], end[2], chain.pieces[n, 0], out)
    return _Part(first, last, k, n, into, out, before, behind, left, right, cost - left - right)


@kernel
def _draw_beside(chain: Chain, part: _Part, draws: Floats, reach: float, pose: Floats) -> None:
    """Write a pose that is drawn near the middle of a part; `reach` is a share of the largest distance."""
    halfway = part.first + (0.2 + 0.6 * draws[7]) * (part.last - part.first)
    _write_pose(chain, _piece_at(chain, halfway), halfway, pose)
    aside = reach * ASIDE * (part.last - part.first)
    pose[0] += aside * (2.0 * draws[5] - 1.0)
    pose[1] += aside * (2.0 * draws[6] - 1.0)
    pose[2] += reach * TURNED * (4.0 * draws[3] - 3.0)


@kernel(inline="late")
def _direction_at_end(pieces: Floats, count: int) -> float:
    """Return a number with the sign of the last direction of pieces, (count, 2)."""
    for k in range(count - 1, -1, -1):
        if pieces[k, 1] != 0.0:
            return pieces[k, 1]
    return 0.0


@kernel
def _spliced(chain: Chain, part: _Part, tried: Floats, count: int, pieces: Floats) -> int:
    """Write the pieces of a chain from piece k on, with another part; return their number."""
    total = 0
    if abs(part.into) >= NOTHING:
        total = _put(pieces, total, chain.pieces[part.k, 0], part.into, part.left)
    for k in range(count):
        total = _put(pieces, total, tried[k, 0], tried[k, 1], -1.0)
    if abs(part.out) >= NOTHING:
        total = _put(pieces, total, chain.pieces[part.n, 0], part.out, part.right)
    for k in range(part.n + 1, int(chain.numbers[PIECES])):
        total = _put(pieces, total, chain.pieces[k, 0], chain.pieces[k, 1], chain.costs[k])
    return total


@kernel(inline="late")
def _put(pieces: Floats, k: int, curvature: float, length: float, cost: float) -> int:
    """Write piece k with its cost; return k + 1."""
    pieces[k, 0], pieces[k, 1], pieces[k, 2] = curvature, length, cost
    return k + 1
