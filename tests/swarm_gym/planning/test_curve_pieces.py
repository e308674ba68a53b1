"""Curves between two poses without obstacles, beside OMPL's lengths and drawn curves."""

import math

import numpy as np
import pytest

from helpers.ompl import require_ompl
from swarm_gym.planning.curves.pieces import connect

RADIUS = 1.7


def driven(pose, pieces):
    """Return the pose behind pieces, by small steps of the midpoint rule."""
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
    pieces = np.zeros((3, 2))
    for begin, end in zip(poses[::2], poses[1::2], strict=True):
        length = connect(begin, end, RADIUS, reverses, False, pieces)
        assert_same(driven(begin, pieces), end)
        assert np.abs(pieces[:, 1]).sum() == pytest.approx(length)
        assert (np.abs(pieces[:, 0]) <= 1.0 / RADIUS + 1e-12).all()
        assert reverses or (pieces[:, 1] >= 0.0).all()


def test_no_drawn_curve_is_shorter():
    poses, rng = drawn_poses(3000, 1)
    pieces = np.zeros((3, 2))
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
    pieces, ratios = np.zeros((3, 2)), []
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
            least = space.distance(*states)
            length = connect(*pair, RADIUS, reverses, False, pieces)
            if reverses:  # some words are missing
                ratios.append(length / least)
            else:
                assert length == pytest.approx(least, abs=1e-9)
    assert min(ratios) > 1.0 - 1e-9
    assert np.mean(ratios) < 1.05


def test_straight_lines_and_full_turns():
    pieces = np.zeros((3, 2))
    begin = np.array([1.0, 2.0, math.radians(30.0)])
    ahead = np.array([1.0 + 5.0 * math.cos(begin[2]), 2.0 + 5.0 * math.sin(begin[2]), begin[2] + math.tau])
    assert connect(begin, ahead, RADIUS, False, False, pieces) == pytest.approx(5.0)
    assert connect(begin, begin, RADIUS, False, False, pieces) == pytest.approx(0.0, abs=1e-9)
    back = np.array([*(2.0 * begin[:2] - ahead[:2]), begin[2]])
    assert connect(begin, back, RADIUS, True, False, pieces) == pytest.approx(5.0)
    assert connect(begin, back, RADIUS, False, False, pieces) > 5.0 + RADIUS
