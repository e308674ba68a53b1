"""Comparisons of two samples of runs on the same scenarios and seeds; smaller values are better."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from experiments.statistics.samples import mean_interval
from swarm_gym.comparing.bootstrap import Draws, Interval, draw, interval, mean_of_present, means

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """A comparison of the runs of one controller with those of a baseline, paired by seed.

    Attributes:
        difference: mean of value - baseline.
        interval: 95 % bootstrap interval of that mean.
        superiority: Vargha-Delaney A12, probability that a run is better (smaller) than one of the
            baseline; ties count half.
        p_value: p of the Wilcoxon signed-rank test, two-sided, not yet corrected.
        direction: sign of the test's rank sum: -1 if the values are rather below the baseline's, +1 if above.
    """

    difference: float
    interval: Interval
    superiority: float
    p_value: float
    direction: int


@dataclass(frozen=True)
class Difference:
    """A comparison of the runs of a group with those of a baseline group, over all their training seeds.

    Attributes:
        difference: mean of value - baseline.
        interval: 95 % interval of the difference, over training seeds of both, scenarios and seeds.
        relative_change: mean of the values over the mean of the baseline's, minus 1.
        superiority: Vargha-Delaney A12 over all runs, paired or not.
        improvement: probability of being better than the baseline on the same scenario and seed.
        p_value: p of the Wilcoxon signed-rank test of the means over training seeds, two-sided, not yet
            corrected.
        direction: sign of the test's rank sum: -1 if the values are rather below the baseline's, +1 if above.
    """

    difference: float
    interval: Interval
    relative_change: float
    superiority: float
    improvement: float
    p_value: float
    direction: int


def compare(values: Floats, baseline: Floats) -> Comparison:
    """Return the comparison of two samples (seeds,) of the same seeds."""
    differences = values - baseline
    return Comparison(
        float(differences.mean()),
        mean_interval(differences),
        superiority(values, baseline),
        *_signed_rank(differences),
    )


def mean_difference(
    values: Floats, baseline: Floats, draws: Draws, baseline_draws: Draws
) -> tuple[float, Interval]:
    """Return the difference of two means and its 95 % interval; values that are nan count as absent.

    Args:
        values: values of a group, (training seeds, scenarios, seeds).
        baseline: values of another group on the same scenarios and seeds.
        draws: resamples of the group.
        baseline_draws: resamples of the other: of another stream, unless training seeds are paired, too.
    """
    resampled = means(values, draws) - means(baseline, baseline_draws)
    return mean_of_present(values) - mean_of_present(baseline), interval(resampled)


def difference(values: Floats, baseline: Floats, draws: Draws, baseline_draws: Draws) -> Difference:
    """Return the comparison of two samples (training seeds, scenarios, seeds), paired by scenario and seed.

    Args:
        values: values of the group.
        baseline: values of the baseline, which may have another number of training seeds.
        draws: resamples of the group.
        baseline_draws: resamples of the baseline, of another stream.
    """
    return Difference(
        *mean_difference(values, baseline, draws, baseline_draws),
        float(values.mean() / baseline.mean() - 1.0),
        superiority(values, baseline),
        probability_of_improvement(values, baseline),
        # One value per pair: runs of several training seeds on it are not independent of each other.
        *_signed_rank((values.mean(axis=0) - baseline.mean(axis=0)).ravel()),
    )


def ratio_interval(values: Floats, baseline: Floats) -> Interval:
    """Return the 95 % interval of the ratio of the means of two samples (seeds,) of the same seeds."""
    draws = draw(1, (1,), len(values))
    return interval(means(values[None, None], draws) / means(baseline[None, None], draws))


def paired(differences: Floats) -> tuple[float, Interval]:
    """Return the mean of differences (scenarios, seeds) and its 95 % interval; each scenario is a stratum."""
    num_scenarios, num_seeds = differences.shape
    resampled = means(differences[None], draw(1, (1,) * num_scenarios, num_seeds))
    return float(differences.mean()), interval(resampled)


def superiority(values: Floats, baseline: Floats) -> float:
    """Return A12, the probability that a value is smaller than one of the baseline; ties count half.

    Source: A. Vargha, H. D. Delaney, "A critique and improvement of the CL common language effect size
    statistics of McGraw and Wong", J. Educ. Behav. Stat. 25 (2000), from the sum of ranks.
    """
    m, n = values.size, baseline.size
    ranks = stats.rankdata(np.concatenate([baseline.ravel(), values.ravel()]))
    return float((ranks[:n].sum() - n * (n + 1) / 2.0) / (m * n))


def probability_of_improvement(values: Floats, baseline: Floats) -> float:
    """Return the share of runs that are better than one of the baseline on the same scenario and seed.

    Ties count half. Agarwal et al. (2021) compare all runs on a task with each other; here they are paired.

    Args:
        values: (training seeds, scenarios, seeds) of the group.
        baseline: (training seeds, scenarios, seeds) of the baseline, with any number of training seeds.
    """
    mine, theirs = values[:, None], baseline[None]
    return float((mine < theirs).mean() + 0.5 * (mine == theirs).mean())


def rank_sum(values: Floats, others: Floats) -> float:
    """Return p of the Mann-Whitney U test, two-sided, of two samples that are not paired; not corrected."""
    if np.ptp(np.concatenate([values, others])) == 0.0:
        return 1.0
    return float(stats.mannwhitneyu(values, others).pvalue)


def holm(p_values: list[float]) -> list[float]:
    """Return p-values after Holm's step-down correction, in the order given.

    Source: S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Stat. 6 (1979).
    """
    order = np.argsort(p_values)
    adjusted, running = np.empty(len(p_values)), 0.0
    for rank, index in enumerate(order):
        running = max(running, (len(p_values) - rank) * p_values[index])
        adjusted[index] = min(running, 1.0)
    return adjusted.tolist()


def _signed_rank(differences: Floats) -> tuple[float, int]:
    """Return p of the Wilcoxon signed-rank test, two-sided, and the sign of its rank sum."""
    unequal = differences[differences != 0.0]
    if not len(unequal):
        return 1.0, 0
    rank_sum = (np.sign(unequal) * stats.rankdata(np.abs(unequal))).sum()
    return float(stats.wilcoxon(differences).pvalue), int(np.sign(rank_sum))
