"""Least stiff shapes are eigenvectors of A^T A, to the last digit whatever the guess."""

import numpy as np
import pytest

from swarm_gym.problem.geometry.stiffness import least_stiff


def squared_differences(count):
    differences = np.zeros((count + 2, count))
    for row, weight in enumerate((1.0, -2.0, 1.0)):
        differences[row : row + count] += weight * np.eye(count)
    return differences.T @ differences


@pytest.mark.parametrize(("count", "number"), [(1, 1), (2, 2), (5, 5), (30, 6), (31, 6), (100, 6)])
def test_values_and_vectors_solve_the_equation(count, number):
    values, vectors = least_stiff(count, number)
    np.testing.assert_allclose(vectors @ squared_differences(count), values[:, None] * vectors, atol=1e-14)
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(number), atol=1e-15)
    assert (np.diff(values) > 0.0).all()
    assert (vectors[:, 0] > 0.0).all()
    np.testing.assert_allclose(
        values, np.linalg.eigvalsh(squared_differences(count))[:number], rtol=1e-8, atol=1e-15
    )


@pytest.mark.parametrize("count", [7, 30])
def test_bits_do_not_depend_on_the_guess(count, monkeypatch):
    exact = np.linalg.eigh

    def rough(matrix):
        values, vectors = exact(matrix)
        return values, -(vectors + 1e-9 * np.random.default_rng(3).normal(size=vectors.shape))

    expected = least_stiff(count, 6)
    monkeypatch.setattr(np.linalg, "eigh", rough)
    for found, one in zip(least_stiff(count, 6), expected, strict=True):
        np.testing.assert_array_equal(found, one)
