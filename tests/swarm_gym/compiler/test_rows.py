"""Arithmetic on rows, compiled, against the same in NumPy."""

import numpy as np

from helpers.loops import looped
from swarm_gym.compiler.rows import gaps_above, plain_decisions, rows_within


@looped("dtype", [np.float32, np.float64])
def test_rows_lie_within_bounds_as_numpy_says(dtype):
    numbers = np.random.default_rng(0).uniform(-2.0, 2.0, (200, 3))
    numbers[::7, 1] = np.nan
    numbers[3] = low = np.array([-1.5, -1.0, -1.9], dtype=dtype)
    numbers[4] = high = np.array([1.5, 1.8, 1.0], dtype=dtype)
    expected = ((numbers >= low) & (numbers <= high)).all(axis=1)
    assert expected[[3, 4]].all()
    assert expected.any()
    assert not expected.all()
    np.testing.assert_array_equal(rows_within(numbers, low, high), expected)


def test_sizes_are_rounded_to_the_nearest_number_and_rows_that_are_not_chosen_are_not_read():
    numbers = np.array([[2.5, 0.0], [7.49, 0.25], [np.nan, np.nan], [64.0, 1.0]])
    sizes, degrees = plain_decisions(numbers, np.array([True, True, False, True]), 1, 64)
    assert sizes.dtype == np.int64
    np.testing.assert_array_equal(sizes, [3, 7, 1, 64])
    np.testing.assert_array_equal(degrees, [0.0, 0.25, 0.0, 1.0])


def test_gaps_are_at_least_a_billionth_of_their_unit_and_nan_stays():
    fitness, problem = np.array([3.0, 2.0, 1.0, np.nan, np.inf]), np.array([0, 0, 1, 1, 0])
    gaps = gaps_above(fitness, problem, np.array([2.0, 5.0]), np.array([10.0, 20.0]))
    np.testing.assert_array_equal(gaps, [1.0, 1e-8, 2e-8, np.nan, np.inf])
