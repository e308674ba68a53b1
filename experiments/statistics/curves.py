"""Fronts of two costs, both of which shall be small, and performance profiles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.comparing.bootstrap import CONFIDENCE, Draws, shares_within

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def non_dominated(points: Floats) -> Flags:
    """Return whether each of the points (n, 2) is on the front, (n,).

    A point is on the front if no other point is as small in both coordinates and smaller in one.
    """
    ahead = (points[:, None] <= points).all(axis=2) & (points[:, None] < points).any(axis=2)
    return np.logical_not(ahead.any(axis=0))


def hypervolume(points: Floats, reference: tuple[float, float]) -> Floats:
    """Return the area that points dominate, up to the reference point.

    Source: E. Zitzler, L. Thiele, "Multiobjective evolutionary algorithms: a comparative case study and the
    strength Pareto approach", IEEE Trans. Evol. Comput. 3 (1999).

    Args:
        points: (..., n, 2), one front per leading index; n may be 0.
        reference: worst value of both coordinates; a point beyond it contributes nothing.

    Returns:
        The area of each front, shape (...).
    """
    inside = np.minimum(points, reference)
    order = np.argsort(inside[..., 0], axis=-1)
    x, y = (np.take_along_axis(inside[..., k], order, axis=-1) for k in (0, 1))
    # The area consists of strips from one point to the next, bounded by the least y so far.
    widths = np.diff(x, axis=-1, append=np.full((*x.shape[:-1], 1), reference[0]))
    heights = reference[1] - np.minimum.accumulate(y, axis=-1)
    return (widths * heights).sum(axis=-1)


@dataclass(frozen=True)
class Profile:
    """A profile over thresholds, (thresholds,) each.

    Attributes:
        thresholds: bounds, increasing.
        shares: share of the runs whose value is at most the bound.
        low: lower end of the pointwise 95 % band.
        high: upper end of the band.
    """

    thresholds: Floats
    shares: Floats
    low: Floats
    high: Floats


def performance_profile(values: Floats, thresholds: Floats, draws: Draws) -> Profile:
    """Return the share of runs (training seeds, scenarios, seeds) within each threshold, with its band.

    The value of E. D. Dolan and J. J. More ("Benchmarking optimization software with performance profiles",
    Math. Program. 91 (2002)) is the cost relative to the best solver. With a value that has a scale of its
    own, the profile is the run-score distribution of Agarwal et al. (2021).
    """
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(shares_within(values, thresholds, draws), [tail, 1.0 - tail], axis=0)
    shares = np.searchsorted(np.sort(values, axis=None), thresholds, side="right") / values.size
    return Profile(thresholds, shares, low, high)
