"""Statistics over training seeds, scenarios and seeds: against loops in plain Python, and known values."""

import statistics
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from experiments.statistics import (
    difference,
    draw,
    hypervolume,
    interval,
    mean_of_present,
    means,
    non_dominated,
    paired,
    performance_profile,
    probability_of_improvement,
    summarise_group,
    superiority,
    trimmed_means,
)
from swarm_gym.comparing.bootstrap import RESAMPLES, shares_within

# Training seeds, sizes of the sets, seeds.
DESIGNS = [(1, (1,), 9), (4, (1,), 7), (1, (6,), 1), (3, (4, 2), 2), (2, (1, 1, 1), 5)]


def sample(design, seed=0):
    """Values with ties, (training seeds, scenarios, seeds)."""
    num_training_seeds, set_sizes, num_seeds = design
    rng = np.random.default_rng(seed)
    return rng.exponential(size=(num_training_seeds, sum(set_sizes), num_seeds)).round(1)


def resample(values, draws, b):
    """The values of a resample, one by one."""
    found = []
    by_pair = values.reshape(len(values), -1)
    for t, p in product(*map(range, by_pair.shape)):
        found += [by_pair[t, p]] * int(draws.training[b, t] * draws.pairs[b, p])
    return found


def naive_trimmed_mean(values):
    values, cut = sorted(values), len(values) // 4
    return statistics.fmean(values[cut : len(values) - cut])


@pytest.mark.parametrize("design", DESIGNS)
def test_resampled_statistics_are_those_of_the_resamples(design):
    values, draws = sample(design), draw(*design)
    thresholds = np.array([-1.0, 0.1, 0.55, 0.7, 99.0])
    mean, trimmed = means(values, draws), trimmed_means(values, draws)
    shares = shares_within(values, thresholds, draws)
    assert len(mean) == len(trimmed) == len(shares) == RESAMPLES
    for b in (*range(40), RESAMPLES - 1):
        drawn = resample(values, draws, b)
        assert len(drawn) == values.size
        assert mean[b] == pytest.approx(statistics.fmean(drawn))
        assert trimmed[b] == pytest.approx(naive_trimmed_mean(drawn))
        assert shares[b] == pytest.approx([sum(v <= tau for v in drawn) / len(drawn) for tau in thresholds])


def test_large_samples_are_resampled_in_parts(monkeypatch):
    values, draws = sample(DESIGNS[3]), draw(*DESIGNS[3])
    whole = trimmed_means(values, draws)
    monkeypatch.setattr("swarm_gym.comparing.bootstrap.MOST_COUNTS", 1000)
    np.testing.assert_allclose(trimmed_means(values, draws), whole, rtol=1e-12)


@pytest.mark.parametrize("design", DESIGNS)
def test_sets_are_strata_and_seeds_are_drawn_within_scenarios(design):
    _, set_sizes, num_seeds = design
    draws = draw(*design)
    assert (draws.training.sum(axis=1) == design[0]).all()
    by_scenario = draws.pairs.reshape(RESAMPLES, sum(set_sizes), num_seeds).sum(axis=2)
    assert (by_scenario % num_seeds == 0).all()
    begin = 0
    for size in set_sizes:
        assert (by_scenario[:, begin : begin + size].sum(axis=1) == size * num_seeds).all()
        begin += size
    assert draws.pairs.mean(axis=0) == pytest.approx(1.0, abs=0.12)


def test_streams_draw_the_same_pairs_and_other_training_seeds():
    one, two = draw(5, (3,), 2, stream=0), draw(5, (3,), 2, stream=1)
    np.testing.assert_array_equal(one.pairs, two.pairs)
    assert abs(np.corrcoef(one.training[:, 0], two.training[:, 0])[0, 1]) < 0.1
    np.testing.assert_array_equal(draw(8, (3,), 2).pairs, one.pairs)


def test_sets_of_equal_size_are_drawn_independently():
    pairs = draw(1, (1, 1), 6).pairs
    first, second = pairs[:, :6], pairs[:, 6:]
    assert abs(np.corrcoef(first[:, 0], second[:, 0])[0, 1]) < 0.1


def test_values_that_are_absent_do_not_count():
    values, draws = sample((2, (3,), 4)), draw(2, (3,), 4)
    values[0, 1], values[1, 2, 3] = np.nan, np.nan
    found = means(values, draws)
    for b in range(40):
        drawn = [value for value in resample(values, draws, b) if not np.isnan(value)]
        assert found[b] == pytest.approx(statistics.fmean(drawn))
    assert mean_of_present(values) == pytest.approx(np.nanmean(values))
    assert np.isnan(means(np.full((1, 1, 3), np.nan), draw(1, (1,), 3))).all()
    assert np.isnan(mean_of_present(np.full(3, np.nan)))


def test_every_scenario_of_paired_differences_is_a_stratum():
    mean, (low, high) = paired(np.array([[1.0, 1.0, 1.0], [5.0, 5.0, 5.0]]))
    assert mean == 3.0
    assert (low, high) == pytest.approx((3.0, 3.0))


def test_effects_of_training_seeds_and_pairs_both_stay():
    """The variance of the mean of a sum of both effects is the sum of the variances of their means."""
    rng = np.random.default_rng(1)
    training, pairs = rng.normal(size=(6, 1, 1)), 2.0 * rng.normal(size=(1, 1, 40))
    resampled = means(training + pairs, draw(6, (1,), 40))
    assert resampled.var() == pytest.approx(training.var() / 6 + pairs.var() / 40, rel=0.1)
    alone = means(np.broadcast_to(pairs, (6, 1, 40)), draw(6, (1,), 40))
    assert alone.var() == pytest.approx(pairs.var() / 40, rel=0.1)


def test_effects_of_scenarios_stay_and_those_of_strata_do_not():
    scenarios = np.random.default_rng(2).normal(size=(1, 30, 1)) + np.zeros((1, 30, 4))
    assert means(scenarios, draw(1, (30,), 4)).var() == pytest.approx(scenarios.var() / 30, rel=0.1)
    assert np.ptp(means(scenarios, draw(1, (1,) * 30, 4))) == pytest.approx(0.0, abs=1e-12)


def test_intervals_over_training_seeds_cover_the_mean_about_as_often_as_they_say():
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(200):
        values = rng.normal(size=(10, 1, 1)) + rng.normal(size=(1, 1, 50)) + rng.normal(size=(10, 1, 50))
        low, high = interval(means(values, draw(10, (1,), 50)))
        hits += low <= 0.0 <= high
    assert 0.85 <= hits / 200 <= 0.99  # ten training seeds are few, for which percentiles are a little narrow


def test_a_group_is_summarised_over_all_its_runs():
    values = np.arange(1.0, 9.0).reshape(2, 1, 4)
    found = summarise_group(values, draw(2, (1,), 4))
    assert (found.mean, found.inter_quartile_mean, found.median) == (4.5, 4.5, 4.5)
    assert (found.minimum, found.maximum) == (1.0, 8.0)
    assert found.deviation == pytest.approx(statistics.stdev(range(1, 9)))
    assert found.interval[0] < 4.5 < found.interval[1]
    values[1, 0, 3] = 1000.0
    moved = summarise_group(values, draw(2, (1,), 4))
    assert moved.inter_quartile_mean == 4.5
    assert moved.mean == 128.5


@given(*[st.lists(st.integers(0, 5), min_size=1, max_size=12)] * 2)
def test_a12_counts_pairs(mine, theirs):
    wins = sum((a < b) + 0.5 * (a == b) for a, b in product(mine, theirs))
    assert superiority(np.array(mine), np.array(theirs)) == pytest.approx(wins / (len(mine) * len(theirs)))


def test_improvement_counts_runs_on_the_same_scenario_and_seed():
    mine, theirs = sample((3, (4,), 5)), sample((2, (4,), 5), seed=1)
    wins = [
        (mine[t, s, k] < theirs[u, s, k]) + 0.5 * (mine[t, s, k] == theirs[u, s, k])
        for t, u, s, k in product(range(3), range(2), range(4), range(5))
    ]
    assert probability_of_improvement(mine, theirs) == pytest.approx(statistics.fmean(wins))


def test_a_difference_is_that_of_means_inside_its_interval():
    mine, theirs = sample((3, (1,), 20)), sample((1, (1,), 20), seed=1)
    draws, baseline_draws = draw(3, (1,), 20), draw(1, (1,), 20, stream=1)
    found = difference(mine, theirs, draws, baseline_draws)
    assert found.difference == pytest.approx(
        statistics.fmean(mine.ravel()) - statistics.fmean(theirs.ravel())
    )
    assert found.relative_change == pytest.approx(mine.mean() / theirs.mean() - 1.0)
    assert found.interval[0] < found.difference < found.interval[1]
    by_pair = [statistics.fmean(mine[:, 0, k]) - theirs[0, 0, k] for k in range(20)]
    assert found.p_value == pytest.approx(stats.wilcoxon(by_pair).pvalue)
    resampled = [
        statistics.fmean(resample(mine, draws, b)) - statistics.fmean(resample(theirs, baseline_draws, b))
        for b in range(RESAMPLES)
    ]
    assert found.interval == pytest.approx(tuple(np.quantile(resampled, [0.025, 0.975])))


def test_a_difference_that_is_the_same_on_every_pair_has_no_width():
    theirs = sample((1, (8,), 1))
    found = difference(theirs - 0.25, theirs, draw(1, (8,), 1), draw(1, (8,), 1, stream=1))
    assert found.interval == pytest.approx((-0.25, -0.25))
    assert difference(theirs, theirs, draw(1, (8,), 1), draw(1, (8,), 1)).p_value == 1.0


def test_a_profile_says_how_many_runs_are_within_each_bound():
    values, design = sample((3, (1,), 20)), (3, (1,), 20)
    thresholds = np.array([0.0, 0.3, 0.8, 2.0, 50.0])
    found = performance_profile(values, thresholds, draw(*design))
    assert list(found.shares) == [sum(v <= tau for v in values.ravel()) / 60 for tau in thresholds]
    assert (found.low <= found.shares).all()
    assert (found.shares <= found.high).all()
    assert found.low[2] < found.high[2]
    assert found.low[-1] == found.high[-1] == 1.0


POINTS = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=8)


@given(POINTS.filter(bool))
def test_a_point_is_dominated_by_one_as_good_in_both_and_better_in_one(points):
    expected = [not any(o[0] <= p[0] and o[1] <= p[1] and o != p for o in points) for p in points]
    assert list(non_dominated(np.array(points, float))) == expected


@given(POINTS)
def test_hypervolume_is_the_area_between_front_and_reference(points):
    cells = sum(any(p[0] <= x and p[1] <= y for p in points) for x, y in product(range(5), range(4)))
    assert hypervolume(np.array(points, float).reshape(-1, 2), (5.0, 4.0)) == cells


def test_hypervolumes_of_many_fronts_at_once_are_those_of_each():
    fronts = np.random.default_rng(0).uniform(size=(7, 5, 2))
    expected = [float(hypervolume(front, (0.9, 0.8))) for front in fronts]
    assert hypervolume(fronts, (0.9, 0.8)) == pytest.approx(expected)
