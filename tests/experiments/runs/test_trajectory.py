"""Lengths and turns of trajectories."""

import math

import numpy as np
import pytest

from experiments.runs.run import length_of, turning_of


def test_a_straight_trajectory_does_not_turn():
    assert turning_of(np.array([[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]])) == pytest.approx(0.0)


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.0, -2.5])
def test_turns_to_both_sides_add_up(angle):
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]])
    turned = path @ np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    assert turning_of(turned) == pytest.approx(180.0)
    assert length_of(turned) == pytest.approx(3.0)


def test_standing_still_is_no_turn():
    assert turning_of(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0]])) == pytest.approx(90.0)


def test_a_polygon_turns_by_what_is_missing_to_a_full_circle():
    angles = np.linspace(0.0, 2.0 * np.pi, 13)
    polygon = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert turning_of(polygon) == pytest.approx(360.0 - 30.0)


def test_a_trajectory_without_steps_has_no_length():
    assert length_of(np.zeros((1, 2))) == turning_of(np.zeros((1, 2))) == 0.0
