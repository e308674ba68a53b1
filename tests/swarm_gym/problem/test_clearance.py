"""Clearance: how close paths come to blocked cells, against shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.grids import area_of, frozen, grids
from swarm_gym.problem.geometry.clearance import clearance, keeps_distance

HALVES = st.integers(-6, 20).map(lambda number: number / 2)
COORDINATES = HALVES | st.floats(-3.0, 10.0)
PATHS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=6).map(np.array)


@settings(deadline=None, derandomize=True)
@given(grids(most=8), PATHS)
def test_clearance_is_the_distance_of_the_path_from_the_squares(blocked, path):
    found = clearance(blocked, path)
    if not blocked.any():
        assert found == math.inf
        return
    line = shapely.Point(path[0]) if len(path) == 1 else shapely.LineString(path)
    with np.errstate(invalid="ignore"):  # Shapely 2.0 says so of a line without length
        expected = line.distance(area_of(blocked))
    assert found == pytest.approx(expected, abs=1e-9)


@settings(deadline=None, derandomize=True)
@given(grids(most=8), PATHS, st.sampled_from([0.0, 0.5, 1.0, 1.5]) | st.floats(0.0, 5.0))
def test_a_path_keeps_a_distance_exactly_if_its_clearance_is_not_less(blocked, path, distance):
    assert keeps_distance(blocked, path, distance) == (clearance(blocked, path) >= distance)


def test_a_long_path_is_measured_where_it_is_closest():
    blocked = np.zeros((40, 60), dtype=np.bool_)
    blocked[20, 30] = blocked[3, 50] = True
    frozen(blocked)
    t = np.linspace(0.0, 1.0, 500)
    path = np.stack([59.0 * t, 10.0 + 12.0 * np.sin(6.0 * t)], axis=1)
    assert clearance(blocked, path) == pytest.approx(
        shapely.LineString(path).distance(area_of(blocked)), abs=1e-12
    )
    assert clearance(blocked, path) > 0.0


def test_a_path_that_touches_a_blocked_cell_has_no_clearance():
    blocked = frozen(np.array([[False, True, False]]))
    assert clearance(blocked, np.array([[0.5, -0.5], [0.5, 0.5]])) == 0.0
    assert clearance(blocked, np.array([[0.25, 0.0], [0.25, 0.4]])) == 0.25


def test_a_path_far_from_the_grid_is_measured_too():
    assert clearance(frozen(np.array([[True, False]])), np.array([[40.5, 0.0]])) == 40.0
