"""The (1 + (lambda, lambda)) genetic algorithm on bit strings, and by full enumeration of its random choices.

Both are written from the description: strings are arrays of bits, and nothing is known of binomial or
hypergeometric distributions.
"""

import itertools
from collections import defaultdict
from functools import cache
from typing import NamedTuple

import numpy as np


class Choice(NamedTuple):
    """The decisions on one iteration."""

    mutants: int
    children: int
    alpha: float = 1.0
    beta: float = 1.0

    def mutation_rate(self, n):
        return min(self.alpha * self.mutants / n, 1.0)

    @property
    def crossover_rate(self):
        return min(self.beta / self.children, 1.0)


def paired(size):
    """Return the decisions of the algorithm with one parameter."""
    return Choice(size, size)


def strength(rng, n, rate):
    """Count n coins, again while none shows a one."""
    flips = 0
    while flips == 0:
        flips = np.count_nonzero(rng.random(n) < rate)
    return flips


def flipped(rng, string, count, flips):
    """Return copies of a string, each with other `flips` bits changed, drawn without replacement."""
    places = rng.random((count, len(string))).argsort(axis=1)[:, :flips]
    copies = np.tile(string, (count, 1))
    for copy, place in zip(copies, places, strict=True):
        copy[place] = ~copy[place]
    return copies


def step(rng, string, choice, copies_free=True):
    """Return the parent after one iteration, and the evaluations that the iteration took."""
    n = len(string)
    flips = strength(rng, n, choice.mutation_rate(n))
    mutants = flipped(rng, string, choice.mutants, flips)
    best = mutants[mutants.sum(axis=1).argmax()]
    takes = rng.random((choice.children, n)) < choice.crossover_rate
    children = np.where(takes, best, string)
    is_copy = (children == string).all(axis=1) | (children == best).all(axis=1)
    counted = np.count_nonzero(~is_copy) if copies_free else choice.children
    rivals = np.vstack([children, best])
    winner = rivals[rivals.sum(axis=1).argmax()]
    return winner if winner.sum() >= string.sum() else string, choice.mutants + counted


def runtime(rng, n, decide, copies_free=True, start=None):
    """Return the evaluations until all bits are set; `decide` returns the choice at a number of ones."""
    string = rng.permutation(np.arange(n) < (n // 2 if start is None else start))
    evaluations = 1
    while not string.all():
        string, cost = step(rng, string, decide(int(string.sum())), copies_free)
        evaluations += cost
    return evaluations


def runtimes(seed, count, *arguments, **options):
    """Return many runtimes, each with its own random numbers."""
    generators = np.random.default_rng(seed).spawn(count)
    return np.array([runtime(rng, *arguments, **options) for rng in generators])


# Enumeration, for short strings.


@cache
def _subsets(n, flips):
    """Return all sets of `flips` places out of n."""
    return list(itertools.combinations(range(n), flips))


@cache
def _strengths(n, rate):
    """Return the probability of each number of flipped bits from 1 on, by all outcomes of n coins."""
    found = np.zeros(n + 1)
    for coins in range(2**n):
        flips = coins.bit_count()
        found[flips] += rate**flips * (1.0 - rate) ** (n - flips)
    return found[1:] / found[1:].sum()


@cache
def _best_mutant(n, ones, flips, mutants):
    """Return the probability of each number of zeros that the best mutant flips; the first bits are ones."""
    zeros = [sum(place >= ones for place in places) for places in _subsets(n, flips)]
    one = {good: zeros.count(good) / len(zeros) for good in set(zeros)}
    best = defaultdict(float)
    for drawn in itertools.product(one, repeat=mutants):
        best[max(drawn)] += np.prod([one[good] for good in drawn])
    return dict(best)


@cache
def _child(good, bad, rate):
    """Return the probability of each (gain, counted) of a child, by all sets of bits that it may take."""
    found = defaultdict(float)
    flips = good + bad
    for takes in itertools.product((True, False), repeat=flips):
        gain = sum(takes[:good]) - sum(takes[good:])
        taken = sum(takes)
        counted = int(0 < taken < flips)
        found[gain, counted] += rate**taken * (1.0 - rate) ** (flips - taken)
    return dict(found)


@cache
def _all_children(good, bad, rate, children):
    """Return the probability of each (gain, counted) after all children and with the mutant as a rival."""
    found = {(max(good - bad, 0), 0): 1.0}
    for _ in range(children):
        after = defaultdict(float)
        for ((best, cost), first), ((gain, counted), second) in itertools.product(
            found.items(), _child(good, bad, rate).items()
        ):
            after[max(best, gain), cost + counted] += first * second
        found = dict(after)
    return found


@cache
def outcomes(n, ones, choice, copies_free=True):
    """Return the probability of each (gain, evaluations) of one iteration; ones that are lost are no gain."""
    found = defaultdict(float)
    for flips, share in enumerate(_strengths(n, choice.mutation_rate(n)).tolist(), 1):
        for good, best in _best_mutant(n, ones, flips, choice.mutants).items():
            after = _all_children(good, flips - good, choice.crossover_rate, choice.children)
            for (gain, counted), last in after.items():
                cost = counted if copies_free else choice.children
                found[gain, choice.mutants + cost] += share * best * last
    return {key: share for key, share in found.items() if share > 0.0}


def remaining(n, ones, later, choice, copies_free=True):
    """Return the expected evaluations from here on if each later number of ones has this expectation."""
    cost = gains = after = 0.0
    for (gain, evaluations), share in outcomes(n, ones, choice, copies_free).items():
        cost += share * evaluations
        if gain > 0:
            gains += share
            after += share * later[ones + gain]
    return (cost + after) / gains if gains > 0.0 else np.inf


def expectations(n, decide, copies_free=True):
    """Return the expected evaluations that remain, by the number of ones."""
    later = np.zeros(n + 1)
    for ones in range(n - 1, -1, -1):
        later[ones] = remaining(n, ones, later, decide(ones), copies_free)
    return later


def least_expectations(n, choices, copies_free=True):
    """Return the least expected evaluations that remain, by the number of ones, and the best choices."""
    later, best = np.zeros(n + 1), [None] * n
    for ones in range(n - 1, -1, -1):
        tried = [remaining(n, ones, later, choice, copies_free) for choice in choices]
        later[ones], best[ones] = min(tried), choices[int(np.argmin(tried))]
    return later, best
