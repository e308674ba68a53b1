"""Summaries of one sample of runs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from swarm_gym.comparing.bootstrap import (
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
    """A summary of one sample: the four numbers of the SPSFA paper, and a 95 % interval of the mean."""

    maximum: float
    minimum: float
    mean: float
    deviation: float
    median: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class GroupSummary:
    """A summary of the runs of all training seeds of a group, with 95 % bootstrap intervals.

    Attributes:
        inter_quartile_mean: mean of the middle half (Agarwal et al. 2021). A few bad runs do not change it,
            unlike the mean, and it takes account of more than one value, unlike the median.
        deviation: standard deviation over all runs, with the denominator n - 1.
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
    """Return the summary of at least two values; the deviation has the denominator n - 1."""
    return Summary(
        float(values.max()),
        float(values.min()),
        float(values.mean()),
        float(values.std(ddof=1)),
        float(np.median(values)),
        mean_interval(values),
    )


def mean_interval(values: Floats) -> tuple[float, float]:
    """Return the 95 % bootstrap interval (bias-corrected and accelerated) of the mean; it is seeded."""
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
    """Return the summary of at least two runs (training seeds, scenarios, seeds)."""
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
