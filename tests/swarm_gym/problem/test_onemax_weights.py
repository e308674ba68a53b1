"""Searches among sums of weights."""

import numpy as np

from helpers.compiled import compiled
from helpers.loops import looped
from swarm_gym.problem.onemax.weights import add_up, find_sum

find = compiled(find_sum)


@looped("count", [1, 2, 7, 8, 9, 16, 17, 40])
def test_a_search_finds_the_first_sum_above_a_share_of_the_last(count):
    draws = np.random.default_rng(count)
    weights = draws.uniform(size=count) ** 6
    weights[1::3] = 0.0  # sums that do not rise
    sums = weights.copy()
    assert compiled(add_up)(sums, count) == sums[-1] == np.cumsum(weights)[-1]
    shares = np.concatenate([draws.uniform(size=200) * sums[-1], [0.0], sums])
    expected = np.minimum(np.searchsorted(sums, shares, side="right"), count - 1)
    assert [find(sums, count, share) for share in shares] == expected.tolist()
