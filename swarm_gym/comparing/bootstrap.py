"""Bootstrap of runs at three levels: training seeds, scenarios and seeds.

Runs are arrays (training seeds, scenarios, seeds). All training seeds meet the same (scenario, seed) pairs,
so the two are crossed. A resample draws training seeds, and independently of them pairs, which all of its
training seeds have in common (the pigeonhole bootstrap, A. B. Owen, Ann. Appl. Stat. 1 (2007)). Drawing pairs
again for each training seed would average their common effect away, and make intervals too narrow.

To draw pairs, scenarios are drawn within their set, and seeds within their scenario. Sets are strata, which
every resample has in full (the stratified bootstrap of R. Agarwal et al., "Deep reinforcement learning at the
edge of the statistical precipice", NeurIPS 2021). A scenario that is a set of its own is thus a stratum.

A resample is stored as the number of times that it has each run. Statistics are then weighted sums.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Interval = tuple[float, float]

RESAMPLES = 5000
CONFIDENCE = 0.95
TRIMMED = 0.25  # from either end, for the inter-quartile mean
MOST_COUNTS = 4_000_000  # counts in memory at a time, 32 MB


class Draws(NamedTuple):
    """Resamples, as the number of times that each part of a sample is in each of them.

    Attributes:
        training: (resamples, training seeds) counts, whose sum is the number of training seeds.
        pairs: (resamples, scenarios * seeds) counts, whose sum is the number of pairs.
    """

    training: Floats
    pairs: Floats


@lru_cache(maxsize=64)
def draw(num_training_seeds: int, set_sizes: tuple[int, ...], num_seeds: int, stream: int = 0) -> Draws:
    """Draw resamples; equal arguments give equal resamples.

    Args:
        num_training_seeds: number of training seeds, 1 for a controller that is not trained.
        set_sizes: number of scenarios in each set.
        num_seeds: number of seeds of each scenario.
        stream: number of a stream. Two streams draw equal pairs, and training seeds independently.
    """
    chosen = np.random.default_rng([0, stream]).multinomial(
        num_training_seeds, _equal(num_training_seeds), size=RESAMPLES
    )
    rng = np.random.default_rng([1])
    pairs = []
    for size in set_sizes:
        scenarios = rng.multinomial(size, _equal(size), size=RESAMPLES)
        # A scenario that is drawn twice draws twice as many seeds.
        pairs.append(rng.multinomial(scenarios * num_seeds, _equal(num_seeds)).reshape(RESAMPLES, -1))
    return Draws(chosen.astype(np.float64), np.concatenate(pairs, axis=1).astype(np.float64))


def means(values: Floats, draws: Draws) -> Floats:
    """Return the mean (resamples,) of values (training seeds, scenarios, seeds) in each resample.

    Values that are nan count as absent; a resample without any other has the mean nan.
    """
    absent = np.isnan(values)
    if not absent.any():
        return _sums(values, draws) / values.size
    present = _sums((~absent).astype(np.float64), draws)
    total = _sums(np.where(absent, 0.0, values), draws)
    return np.divide(total, present, out=np.full_like(total, np.nan), where=present > 0.0)


def mean_of_present(values: Floats) -> float:
    """Return the mean of the values that are not nan, or nan if there is none."""
    present = values[~np.isnan(values)]
    return float(present.mean()) if present.size else np.nan


def trimmed_means(values: Floats, draws: Draws) -> Floats:
    """Return the inter-quartile mean (resamples,) as `scipy.stats.trim_mean` has it, in each resample."""
    cut = int(TRIMMED * values.size)
    ordered = np.sort(values, axis=None)
    found = []
    for upto in _cumulated(values, draws):
        kept = np.diff(np.clip(upto, cut, values.size - cut), axis=1)
        found.append(kept @ ordered / (values.size - 2 * cut))
    return np.concatenate(found)


def shares_within(values: Floats, thresholds: Floats, draws: Draws) -> Floats:
    """Return the share (resamples, thresholds) of values up to the threshold, in each resample."""
    places = np.searchsorted(np.sort(values, axis=None), thresholds, side="right")
    return np.concatenate([upto[:, places] for upto in _cumulated(values, draws)]) / values.size


def interval(resampled: Floats) -> Interval:
    """Return the 95 % percentile interval of a statistic (resamples,), over those where it is not nan."""
    tail = (1.0 - CONFIDENCE) / 2.0
    if np.isnan(resampled).all():
        return np.nan, np.nan
    low, high = np.nanquantile(resampled, [tail, 1.0 - tail])
    return float(low), float(high)


def _sums(values: Floats, draws: Draws) -> Floats:
    by_pair = draws.training @ values.reshape(len(values), -1)
    return np.einsum("bp,bp->b", by_pair, draws.pairs)


def _cumulated(values: Floats, draws: Draws) -> Iterator[Floats]:
    """Yield counts (some resamples, values.size + 1) of the values below each rank, until all are counted."""
    order = np.argsort(values, axis=None, kind="stable")
    step = max(1, MOST_COUNTS // values.size)
    for begin in range(0, len(draws.pairs), step):
        part = slice(begin, begin + step)
        counts = draws.training[part, :, None] * draws.pairs[part, None, :]
        upto = np.zeros((len(counts), values.size + 1))
        np.cumsum(counts.reshape(len(counts), -1)[:, order], axis=1, out=upto[:, 1:])
        yield upto


def _equal(number: int) -> Floats:
    return np.full(number, 1.0 / number)
