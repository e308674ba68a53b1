"""Performance profiles: the share of runs within a bound, by the bound."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.comparing.bootstrap import CONFIDENCE, Draws, shares_within

Floats = NDArray[np.float64]


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
