"""Curves between two poses without obstacles, beside OMPL's lengths, a numeric search and drawn curves."""

import math

import numpy as np
import pytest

from helpers.ompl import require_ompl
from oracles.reeds_shepp import QUARTER, least_length, stepped
from swarm_gym.planning.curves.pieces import connect, connected, most_pieces

RADIUS = 1.7
# Curves of four and five pieces by the paper, with gears and sides of arcs: signs of curvatures, and signs of
# lengths. Equal letters are equal lengths; q is a quarter circle.
LONGER = {
    "CC|CC": ((1, -1, 1, -1), (1, 1, -1, -1), "tuuv"),
    "C|CC|C": ((1, -1, 1, -1), (1, -1, -1, 1), "tuuv"),
    "C|CSC, same side": ((1, -1, 0, -1), (1, -1, -1, -1), "tqsv"),
    "C|CSC, other side": ((1, -1, 0, 1), (1, -1, -1, -1), "tqsv"),
    "CSC|C, same side": ((1, 0, 1, -1), (1, 1, 1, -1), "tsqv"),
    "CSC|C, other side": ((1, 0, -1, 1), (1, 1, 1, -1), "tsqv"),
    "C|CSC|C": ((1, -1, 0, 1, -1), (1, -1, -1, -1, 1), "tqsqv"),
}


def driven(pose, pieces):
    """Return the pose behind pieces, around the centres of their circles."""
    x, y, heading = pose
    for curvature, length in pieces:
        if curvature == 0.0:
            x, y = x + length * math.cos(heading), y + length * math.sin(heading)
            continue
        # The centre of the circle is to the left by 1 / curvature.
        x -= math.sin(heading) / curvature
        y += math.cos(heading) / curvature
        heading += curvature * length
        x += math.sin(heading) / curvature
        y -= math.cos(heading) / curvature
    return x, y, heading


def drawn_poses(number, seed=0):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-6.0, 6.0, (number, 2)), rng.uniform(-4.0, 4.0, number)]), rng


def assert_same(pose, other, tolerance=1e-9):
    assert math.dist(pose[:2], other[:2]) < tolerance
    assert abs(math.remainder(pose[2] - other[2], math.tau)) < tolerance


@pytest.mark.parametrize("reverses", [False, True])
def test_curves_end_where_they_should(reverses):
    poses, _ = drawn_poses(800)
    pieces = np.zeros((most_pieces(reverses), 2))
    for begin, end in zip(poses[::2], poses[1::2], strict=True):
        length = connect(begin, end, RADIUS, reverses, False, pieces)
        assert_same(driven(begin, pieces), end)
        assert np.abs(pieces[:, 1]).sum() == pytest.approx(length)
        assert (np.abs(pieces[:, 0]) <= 1.0 / RADIUS + 1e-12).all()
        assert reverses or (pieces[:, 1] >= 0.0).all()


def test_no_drawn_curve_is_shorter():
    poses, rng = drawn_poses(3000, 1)
    pieces = np.zeros((5, 2))
    for begin in poses:
        drawn = np.column_stack([rng.choice([-1.0, 0.0, 1.0], 4) / RADIUS, rng.exponential(2.0, 4)])
        end = np.array(driven(begin, drawn))
        length = connect(begin, end, RADIUS, False, False, pieces)
        assert math.dist(begin[:2], end[:2]) - 1e-9 <= length <= drawn[:, 1].sum() + 1e-9
        assert connect(begin, end, RADIUS, True, False, pieces) <= length + 1e-9
        to_point = connect(begin, end, RADIUS, False, True, pieces)
        assert to_point >= math.dist(begin[:2], end[:2]) - 1e-9
        if math.isfinite(to_point):
            assert math.dist(driven(begin, pieces)[:2], end[:2]) < 1e-9


def test_lengths_are_those_of_ompl():
    require_ompl()
    from ompl import base

    poses, _ = drawn_poses(4000, 2)
    pieces = np.zeros((5, 2))
    for space, reverses in (
        (base.DubinsStateSpace(RADIUS), False),
        (base.ReedsSheppStateSpace(RADIUS), True),
    ):
        states = space.allocState(), space.allocState()
        for pair in zip(poses[::2], poses[1::2], strict=True):
            for state, (x, y, heading) in zip(states, pair, strict=True):
                state.setX(x)
                state.setY(y)
                state.setYaw(math.remainder(heading, math.tau))
            length = connect(*pair, RADIUS, reverses, False, pieces)
            assert length == pytest.approx(space.distance(*states), abs=1e-9)


def test_lengths_with_reversing_are_those_of_a_numeric_search():
    rng = np.random.default_rng(3)
    pieces, used = np.zeros((5, 2)), set()
    for scale in (0.5, 1.0, 2.0, 4.0):
        goal = np.array([*rng.normal(0.0, scale, 2), rng.uniform(-math.pi, math.pi)])
        length = connect(np.zeros(3), goal, 1.0, True, False, pieces)
        assert length == pytest.approx(least_length(goal), abs=1e-7)
        used.add((np.abs(pieces[:, 1]) > 1e-9).sum())
    assert used >= {3, 4}


def drawn_word(rng, name):
    """Return pieces of a longer word with arcs of radius 1 and lengths in the ranges of the paper, (k, 2)."""
    curvatures, gears, letters = LONGER[name]
    reach = 1.0 if name == "CC|CC" else QUARTER
    sizes = {"t": rng.uniform(0.1, QUARTER), "u": rng.uniform(0.1, reach), "v": rng.uniform(0.1, QUARTER)}
    sizes |= {"q": QUARTER, "s": rng.exponential(2.0)}
    lengths = np.array([sizes[letter] for letter in letters]) * gears * rng.choice([-1.0, 1.0])
    return np.column_stack([np.array(curvatures) * rng.choice([-1.0, 1.0]), lengths])


@pytest.mark.parametrize("name", LONGER)
def test_longer_words_are_found(name):
    """The curve to where a word leads is no longer than the word, and often it is the word."""
    rng = np.random.default_rng(len(name))
    found, pieces = 0, np.zeros((5, 2))
    for _ in range(300):
        begin, word = np.array([*rng.uniform(-3.0, 3.0, 2), rng.uniform(-4.0, 4.0)]), drawn_word(rng, name)
        end = np.array(driven(begin, word))
        length = connect(begin, end, 1.0, True, False, pieces)
        assert_same(driven(begin, pieces), end)
        assert length <= np.abs(word[:, 1]).sum() + 1e-9
        if np.allclose(pieces[: len(word)], word, atol=1e-6) and not pieces[len(word) :, 1].any():
            found += 1
            if found < 6:
                assert_same(stepped(begin, pieces), end, 1e-5)
    assert found > 10


def changes_of(pieces):
    signs = np.sign(pieces[np.abs(pieces[:, 1]) > 0.0, 1])
    return int((signs[1:] != signs[:-1]).sum())


def test_changes_of_direction_have_a_price():
    """A dearer change makes curves longer, with fewer changes; the cost is the length and the changes."""
    poses, _ = drawn_poses(160, 4)
    pieces, counts = np.zeros((5, 2)), []
    for begin, end in zip(poses[::2], poses[1::2], strict=True):
        before, fewer = 0.0, []
        for price in (0.0, 1.0, 100.0):
            cost = connected(begin, end, RADIUS, price, False, math.inf, pieces)
            length = np.abs(pieces[:, 1]).sum()
            assert_same(driven(begin, pieces), end)
            assert cost == pytest.approx(length + price * changes_of(pieces))
            assert before <= length + 1e-9
            before = length
            fewer.append(changes_of(pieces))
        assert fewer == sorted(fewer, reverse=True)
        assert fewer[-1] == 0
        forwards = connect(begin, end, RADIUS, False, False, pieces)
        backwards = connect(end, begin, RADIUS, False, False, pieces)  # driven from its end
        assert before == pytest.approx(min(forwards, backwards))
        counts.append(fewer)
    assert np.mean(counts, axis=0)[0] > np.mean(counts, axis=0)[1] > 0.3


def test_costs_above_the_most_do_not_matter():
    poses, _ = drawn_poses(60, 5)
    for begin, end in zip(poses[::2], poses[1::2], strict=True):
        for price in (0.0, 2.0, math.inf):
            first, other = np.zeros((5, 2)), np.zeros((5, 2))
            least = connected(begin, end, RADIUS, price, False, math.inf, first)
            assert connected(begin, end, RADIUS, price, False, least * (1.0 + 1e-6), other) == least
            np.testing.assert_array_equal(first, other)
            assert connected(begin, end, RADIUS, price, False, least, other) == least
            assert connected(begin, end, RADIUS, price, False, 0.5 * least, other) == 0.5 * least


def test_too_few_rows_are_refused():
    ends = np.zeros(3), np.ones(3)
    with pytest.raises(ValueError, match="expected three rows, or five"):
        connect(*ends, RADIUS, True, False, np.zeros((4, 2)))
    assert math.isfinite(connect(*ends, RADIUS, True, False, np.zeros((5, 2))))


def test_straight_lines_and_full_turns():
    pieces = np.zeros((5, 2))
    begin = np.array([1.0, 2.0, math.radians(30.0)])
    ahead = np.array([1.0 + 5.0 * math.cos(begin[2]), 2.0 + 5.0 * math.sin(begin[2]), begin[2] + math.tau])
    assert connect(begin, ahead, RADIUS, False, False, pieces) == pytest.approx(5.0)
    assert connect(begin, begin, RADIUS, False, False, pieces) == pytest.approx(0.0, abs=1e-9)
    back = np.array([*(2.0 * begin[:2] - ahead[:2]), begin[2]])
    assert connect(begin, back, RADIUS, True, False, pieces) == pytest.approx(5.0)
    assert connect(begin, back, RADIUS, False, False, pieces) > 5.0 + RADIUS
