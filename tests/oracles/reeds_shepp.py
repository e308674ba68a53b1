"""The length of the shortest curve of Reeds and Shepp by a numeric search, without a formula for any word.

A word is a sequence of arcs and straight lines, whose lengths follow from three unknown numbers. Newton's
method solves the three equations of the goal pose from many starts. Any solution is a curve that a robot can
drive, so no length that is found is too short.
"""

import itertools

import numpy as np

QUARTER = np.pi / 2.0
OUTER, INNER = (-2.0, -0.7, 0.7, 2.0), (-1.8, -0.6, 0.6, 1.8)
STARTS = np.array(list(itertools.product(OUTER, INNER, OUTER)))
STEPS = 25  # of Newton's method
LONGEST = 1.5  # of a step, so that starts lead to solutions near them
NEAR = 1e-9  # of a solution to the goal


def words():
    """Yield each word: signs of its curvatures, lengths by unknown numbers (k, 3), and known lengths (k,)."""
    first, middle, last = np.eye(3)
    nothing = np.zeros(3)
    for side in (1.0, -1.0):
        for end in (1.0, -1.0):
            yield (side, 0.0, end), (first, middle, last), (0.0, 0.0, 0.0)
        yield (side, -side, side), (first, middle, last), (0.0, 0.0, 0.0)
        for sign in (1.0, -1.0):
            yield (side, -side, side, -side), (first, middle, sign * middle, last), (0.0, 0.0, 0.0, 0.0)
            quarter = sign * QUARTER
            for end in (1.0, -1.0):
                curvatures, rows, known = (
                    (side, -side, 0.0, end),
                    (first, nothing, middle, last),
                    (0.0, quarter, 0.0, 0.0),
                )
                yield curvatures, rows, known
                yield curvatures[::-1], rows[::-1], known[::-1]
            yield (
                (side, -side, 0.0, side, -side),
                (first, nothing, middle, nothing, last),
                (0.0, quarter, 0.0, quarter, 0.0),
            )


def least_length(goal):
    """Return the least length of a curve from (0, 0, 0) to a pose, with arcs of radius 1."""
    return min(_least_of_word(goal, *map(np.array, word)) for word in words())


def stepped(pose, pieces, step=1e-3):
    """Return the pose behind pieces of curvature and length, by small straight steps."""
    x, y, heading = pose
    for curvature, length in pieces:
        count = max(int(np.ceil(abs(length) / step)), 1)
        headings = heading + curvature * length * (np.arange(count) + 0.5) / count
        x, y = x + np.cos(headings).sum() * length / count, y + np.sin(headings).sum() * length / count
        heading += curvature * length
    return x, y, heading


def _least_of_word(goal, curvatures, rows, known):
    unknown = STARTS.copy()
    for _ in range(STEPS):
        off, slopes = _off(goal, curvatures, unknown @ rows.T + known)
        change = np.einsum("nij,nj->ni", np.linalg.pinv(slopes @ rows, rcond=1e-6), -off)
        size = np.linalg.norm(change, axis=1, keepdims=True)
        unknown += change * np.minimum(1.0, LONGEST / np.maximum(size, 1e-12))
    lengths = unknown @ rows.T + known
    off, _ = _off(goal, curvatures, lengths)
    solved = np.abs(off).max(axis=1) < NEAR
    arcs = curvatures != 0.0
    lengths[:, arcs] -= 2.0 * np.pi * np.round(lengths[:, arcs] / (2.0 * np.pi))  # whole circles are left out
    return np.abs(lengths[solved]).sum(axis=1).min(initial=np.inf)


def _off(goal, curvatures, lengths):
    """Return how far curves end from a goal, (n, 3), and the slopes of that by each length, (n, 3, k)."""
    place, heading = np.zeros(len(lengths), complex), np.zeros(len(lengths))
    ends = []
    for curvature, length in zip(curvatures, lengths.T, strict=True):
        before = np.exp(1j * heading)
        heading = heading + curvature * length
        place = place + (
            length * before if curvature == 0.0 else (np.exp(1j * heading) - before) / (1j * curvature)
        )
        ends.append((place, np.exp(1j * heading)))
    turned = (heading - goal[2] + np.pi) % (2.0 * np.pi) - np.pi
    off = np.column_stack([place.real - goal[0], place.imag - goal[1], turned])
    slopes = np.empty((len(lengths), 3, len(curvatures)))
    for k, (curvature, (end, ahead)) in enumerate(zip(curvatures, ends, strict=True)):
        # A longer piece moves what is behind it along, and turns it around the end of the piece.
        moved = ahead + 1j * curvature * (place - end)
        slopes[:, 0, k], slopes[:, 1, k], slopes[:, 2, k] = moved.real, moved.imag, curvature
    return off, slopes
