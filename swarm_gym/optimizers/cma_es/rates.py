"""Weights and learning rates of CMA-ES, which follow from dimension and population size.

Source: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772v2, 2023, called the tutorial
here: table 1, eq. 49 to 58, with negative weights (active CMA-ES).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import logarithm
from swarm_gym.compiler.jit import kernel

Floats = NDArray[np.float64]


class Rates(NamedTuple):
    """Learning rates for one dimension and population size."""

    parents: int  # mu, number of positive weights that select
    effective: float  # mu_eff, variance effective selection mass
    step_rate: float  # c_sigma
    damping: float  # d_sigma
    path_rate: float  # c_c
    rank_one: float  # c_1
    rank_mu: float  # c_mu
    weight_sum: float  # sum of all weights
    expected_length: float  # of a standard normal vector


@kernel
def write_weights(weights: Floats, dimension: int) -> Rates:
    """Write the recombination weights, (lambda,), best member first, and return the rates."""
    size, n = weights.shape[0], float(dimension)
    parents = max(size // 2, 1)
    middle = logarithm(0.5 * (size + 1.0))
    positive = positive_squares = negative = negative_squares = 0.0
    for i in range(size):
        weights[i] = middle - logarithm(i + 1.0) if size > 1 else 1.0  # eq. 49
        if i < parents:
            positive += weights[i]
            positive_squares += weights[i] * weights[i]
        else:
            negative -= weights[i]
            negative_squares += weights[i] * weights[i]
    effective = positive * positive / positive_squares
    rank_one = 2.0 / ((n + 1.3) * (n + 1.3) + effective)  # eq. 57
    rank_mu = 2.0 * (0.25 + effective + 1.0 / effective - 2.0) / ((n + 2.0) * (n + 2.0) + effective)
    rank_mu = min(1.0 - rank_one, rank_mu)  # eq. 58
    total = 1.0
    if negative > 0.0:
        opposing = negative * negative / negative_squares
        share = min(1.0 + rank_one / rank_mu, 1.0 + 2.0 * opposing / (effective + 2.0))  # eq. 50, 51
        share = min(share, (1.0 - rank_one - rank_mu) / (n * rank_mu))  # eq. 52
        total -= share
        for i in range(parents, size):
            weights[i] *= share / negative  # eq. 53
    for i in range(parents):
        weights[i] /= positive
    step_rate = (effective + 2.0) / (n + effective + 5.0)  # eq. 55
    damping = 1.0 + 2.0 * max(0.0, math.sqrt((effective - 1.0) / (n + 1.0)) - 1.0) + step_rate
    path_rate = (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n)  # eq. 56
    expected = math.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
    return Rates(parents, effective, step_rate, damping, path_rate, rank_one, rank_mu, total, expected)
