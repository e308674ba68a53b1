"""Lengths and turns of trajectories."""

import math

import numpy as np
import pytest

from experiments.runs.run import turning_of
from swarm_gym.problem.geometry.polylines import length_of


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.0, -2.5])
def test_turns_to_both_sides_add_up(angle):
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]])
    turned = path @ np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    assert turning_of(turned) == pytest.approx(180.0)
    assert length_of(turned) == pytest.approx(3.0)


ANGLES = np.linspace(0.0, 2.0 * np.pi, 13)


@pytest.mark.parametrize(
    ("path", "degrees"),
    [
        pytest.param([[0, 0], [1, 1], [3, 3]], 0.0, id="a straight line"),
        pytest.param([[0, 0], [1, 0], [1, 0], [1, 1]], 90.0, id="standing still is no turn"),
        pytest.param(np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1), 360.0 - 30.0, id="a polygon"),
    ],
)
def test_a_trajectory_turns_between_its_pieces(path, degrees):
    assert turning_of(np.array(path, dtype=float)) == pytest.approx(degrees)


def test_a_trajectory_without_steps_has_no_length():
    assert length_of(np.zeros((1, 2))) == turning_of(np.zeros((1, 2))) == 0.0
