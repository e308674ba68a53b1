"""One sample of runs, described."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from experiments.statistics.bootstrap import (
    CONFIDENCE,
    TRIMMED,
    Draws,
    Interval,
    interval,
    means,
    trimmed_means,
)

Floats = NDArray[np.float64]

MEAN_RESAMPLES = 10_000


@dataclass(frozen=True)
class Summary:
    """One sample: the paper's four numbers, and a 95 % bootstrap interval of the mean."""

    maximum: float
    minimum: float
    mean: float
    deviation: float
    median: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class GroupSummary:
    """Runs of all training seeds of a group together, with 95 % intervals by `bootstrap`.

    Attributes:
        inter_quartile_mean: mean of the middle half (Agarwal et al. 2021): neither moved by a few bad runs,
            as the mean is, nor blind to all but one value, as the median is.
        deviation: over all runs, with the denominator n - 1.
    """

    mean: float
    interval: Interval
    inter_quartile_mean: float
    inter_quartile_interval: Interval
    median: float
    minimum: float
    maximum: float
    deviation: float


def summarise(values: Floats) -> Summary:
    """Describe a sample of at least two values; the deviation has the denominator n - 1."""
    return Summary(
        float(values.max()),
        float(values.min()),
        float(values.mean()),
        float(values.std(ddof=1)),
        float(np.median(values)),
        mean_interval(values),
    )


def mean_interval(values: Floats) -> tuple[float, float]:
    """95 % bootstrap interval (bias-corrected and accelerated) of the mean; seeded."""
    if np.ptp(values) <= 1e-12 * np.abs(values).max():
        return float(values[0]), float(values[0])
    found = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=MEAN_RESAMPLES,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(0),
        batch=1000,
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)


def summarise_group(values: Floats, draws: Draws) -> GroupSummary:
    """Describe runs (training seeds, scenarios, seeds); there must be two at least."""
    return GroupSummary(
        float(values.mean()),
        interval(means(values, draws)),
        float(stats.trim_mean(values, TRIMMED, axis=None)),
        interval(trimmed_means(values, draws)),
        float(np.median(values)),
        float(values.min()),
        float(values.max()),
        float(values.std(ddof=1)),
    )
