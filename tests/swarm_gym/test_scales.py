"""Scales map their ends to -1 and 1, and decode what they encode."""

from types import SimpleNamespace

import numpy as np
import pytest

from swarm_gym.scales import AsItIs, Linear, Logarithmic

NUMPY = SimpleNamespace(xp=np)


@pytest.mark.parametrize(
    ("scale", "middle"), [(Linear(2.0, 10.0), 6.0), (Linear(-5.0, 5.0), 0.0), (Logarithmic(2.0, 8.0), 4.0)]
)
def test_ends_and_middle_are_minus_one_zero_and_one(scale, middle):
    values = np.array([scale.smallest, middle, scale.largest])
    np.testing.assert_allclose(scale.encode(values, None), [-1.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(
        scale.decode(np.array([-1.0, 0.0, 1.0]), NUMPY), values, rtol=1e-12, atol=1e-12
    )


def test_a_number_in_its_own_unit_stays_as_it_is():
    numbers = np.array([0.0, 0.3, 1.0])
    assert AsItIs(0.0, 1.0).encode(numbers, None) is AsItIs(0.0, 1.0).decode(numbers, NUMPY) is numbers


def test_a_logarithm_of_zero_counts_as_the_smallest_value():
    assert Logarithmic(0.5, 2.0).encode(np.zeros(1), None).tolist() == [-1.0]
