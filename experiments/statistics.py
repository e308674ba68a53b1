"""Statistics of paired, heavy-tailed runs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]

RESAMPLES = 10_000
CONFIDENCE = 0.95


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
class Comparison:
    """Paired runs against a baseline.

    Attributes:
        difference: mean of value - baseline.
        interval: 95 % bootstrap interval of that mean.
        superiority: Vargha-Delaney A12, probability that a run is better (smaller) than one of the
            baseline's, ties counted half.
        p_value: Wilcoxon signed-rank test, two-sided, not yet corrected.
    """

    difference: float
    interval: tuple[float, float]
    superiority: float
    p_value: float


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
    if np.ptp(values) == 0.0:
        return float(values[0]), float(values[0])
    found = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        rng=np.random.default_rng(0),
        batch=1000,
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)


def compare(values: Floats, baseline: Floats) -> Comparison:
    """Compare two samples of the same seeds, smaller being better."""
    differences = values - baseline
    below = (values[:, None] < baseline).mean() + 0.5 * (values[:, None] == baseline).mean()
    p_value = 1.0 if not differences.any() else stats.wilcoxon(differences).pvalue
    return Comparison(float(differences.mean()), mean_interval(differences), float(below), float(p_value))


def holm(p_values: list[float]) -> list[float]:
    """Holm's step-down correction: adjusted p-values in the order given.

    Source: S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Stat. 6 (1979).
    """
    order = np.argsort(p_values)
    adjusted, running = np.empty(len(p_values)), 0.0
    for rank, index in enumerate(order):
        running = max(running, (len(p_values) - rank) * p_values[index])
        adjusted[index] = min(running, 1.0)
    return adjusted.tolist()
