"""Performance profiles: how large a share of runs is within a bound."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.statistics.bootstrap import CONFIDENCE, Draws, shares_within

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """A profile over thresholds, (thresholds,) each.

    Attributes:
        thresholds: bounds, increasing.
        shares: of the runs that are at most the bound.
        low: lower end of the pointwise 95 % band.
        high: upper end.
    """

    thresholds: Floats
    shares: Floats
    low: Floats
    high: Floats


def performance_profile(values: Floats, thresholds: Floats, draws: Draws) -> Profile:
    """The share of runs (training seeds, scenarios, seeds) within each threshold, with its band.

    E. D. Dolan and J. J. More ("Benchmarking optimization software with performance profiles", Math. Program.
    91 (2002)) have the cost relative to the best solver for the value; with a value that has a scale of its
    own it is the run-score distribution of Agarwal et al. (2021).
    """
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(shares_within(values, thresholds, draws), [tail, 1.0 - tail], axis=0)
    shares = np.searchsorted(np.sort(values, axis=None), thresholds, side="right") / values.size
    return Profile(thresholds, shares, low, high)
