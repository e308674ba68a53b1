"""One iteration of the (1 + (lambda, lambda)) genetic algorithm on OneMax, in expectation.

With f ones of n, an iteration costs evaluations and gains k >= 0 ones; f never falls. Both follow from three
distributions: the strength l is binomial, given that it is not 0; the best mutant's g flipped zeros are the
largest of lambda_m hypergeometric numbers; and a child keeps a of these g and takes d of the other l - g
flips, both binomial, so that it gains a - d. Densities come from logarithms of factorials, and probabilities
below `LEAST` are left out. `swarm_gym.optimizers.one_plus_lambda_lambda` draws from the same distributions by
other formulas; tests compare both.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import exponential, logarithm, logarithm_of_one_and
from swarm_gym.compiler.jit import entry, kernel

Floats = NDArray[np.float64]

LEAST = 1e-15
LOG_LEAST = -34.5


class Mutation(NamedTuple):
    """The mutation phase."""

    mutants: int  # lambda_m
    rate: float  # probability that a mutant flips a bit, before strengths of 0 are drawn again


class Crossover(NamedTuple):
    """The crossover phase."""

    children: int  # lambda_c
    rate: float  # probability that a child takes a bit from the best mutant
    copies_free: bool  # whether a child that equals parent or mutant costs nothing


class Tables(NamedTuple):
    """Logarithms of factorials, and room for the distributions of one iteration."""

    logs: Floats  # (n + 1,) log k!
    strengths: Floats  # (n + 2,) of l
    flipped: Floats  # of the zeros that a mutant flips
    kept: Floats  # of a
    spoilt: Floats  # of d
    at_least: Floats  # sums of `spoilt` from an index on


@entry
def make_tables(size: int) -> Tables:
    """Return the tables for strings of a length n."""
    logs = np.zeros(size + 1)
    for k in range(2, size + 1):
        logs[k] = logs[k - 1] + logarithm(float(k))
    room = np.zeros((5, size + 2))
    return Tables(logs, room[0], room[1], room[2], room[3], room[4])


@kernel
def binomial(logs: Floats, trials: int, rate: float, out: Floats) -> tuple[int, int]:
    """Write the probabilities of Bin(trials, rate) that are not tiny.

    Returns:
        The number that the first is for, and how many there are.
    """
    if rate <= 0.0 or rate >= 1.0 or trials == 0:
        out[0] = 1.0
        return (trials if rate >= 1.0 else 0), 1
    for_one, for_zero = logarithm(rate), logarithm_of_one_and(-rate)
    mode = min(int((trials + 1) * rate), trials)
    first = last = mode
    while first > 0 and _log_binomial(logs, trials, first - 1, for_one, for_zero) > LOG_LEAST:
        first -= 1
    while last < trials and _log_binomial(logs, trials, last + 1, for_one, for_zero) > LOG_LEAST:
        last += 1
    for k in range(first, last + 1):
        out[k - first] = exponential(_log_binomial(logs, trials, k, for_one, for_zero))
    return first, last - first + 1


@kernel(inline="late")
def _log_binomial(logs: Floats, trials: int, k: int, for_one: float, for_zero: float) -> float:
    return logs[trials] - logs[k] - logs[trials - k] + k * for_one + (trials - k) * for_zero


@kernel
def hypergeometric(logs: Floats, size: int, zeros: int, flips: int, out: Floats) -> tuple[int, int]:
    """Write the probabilities, not tiny, of the zeros among some flipped bits of a string; see `binomial`."""
    lowest, highest = max(0, flips - (size - zeros)), min(flips, zeros)
    mode = min(max(int((flips + 1) * (zeros + 1) / (size + 2)), lowest), highest)
    first = last = mode
    while first > lowest and _log_hypergeometric(logs, size, zeros, flips, first - 1) > LOG_LEAST:
        first -= 1
    while last < highest and _log_hypergeometric(logs, size, zeros, flips, last + 1) > LOG_LEAST:
        last += 1
    for k in range(first, last + 1):
        out[k - first] = exponential(_log_hypergeometric(logs, size, zeros, flips, k))
    return first, last - first + 1


@kernel(inline="late")
def _log_hypergeometric(logs: Floats, size: int, zeros: int, flips: int, k: int) -> float:
    ones = size - zeros
    chosen = logs[zeros] - logs[k] - logs[zeros - k]
    others = logs[ones] - logs[flips - k] - logs[ones - flips + k]
    return chosen + others - (logs[size] - logs[flips] - logs[size - flips])


@kernel
def power(base: float, exponent: int) -> float:
    """Return a power with a natural exponent."""
    result = 1.0
    while exponent > 0:
        if exponent % 2 == 1:
            result *= base
        base *= base
        exponent //= 2
    return result


@kernel
def mutation_outcomes(
    tables: Tables,
    size: int,
    ones: int,
    mutation: Mutation,
    strengths: NDArray[np.int64],
    good: NDArray[np.int64],
    weights: Floats,
) -> int:
    """Write the outcomes of the mutation phase: strength l, flipped zeros g of the best mutant, probability.

    Returns:
        Number of outcomes.
    """
    count = 0
    first, num_strengths = binomial(tables.logs, size, mutation.rate, tables.strengths)
    total = 0.0
    for i in range(num_strengths):
        if first + i > 0:
            total += tables.strengths[i]
    for i in range(num_strengths):
        flips = first + i
        if flips == 0 or tables.strengths[i] < LEAST * total:
            continue
        share = tables.strengths[i] / total
        lowest, num_good = hypergeometric(tables.logs, size, size - ones, flips, tables.flipped)
        below, before = 0.0, 0.0
        for j in range(num_good):
            below = 1.0 if j == num_good - 1 else min(below + tables.flipped[j], 1.0)
            now = power(below, mutation.mutants)
            if share * (now - before) > LEAST:
                strengths[count], good[count], weights[count] = flips, lowest + j, share * (now - before)
                count += 1
            before = now
    return count


@kernel
def crossover_outcome(
    tables: Tables, ones: int, flips: int, good: int, crossover: Crossover, later: Floats
) -> tuple[float, float, float]:
    """Return what the crossover phase costs and brings, in expectation, after a mutant of this kind.

    Args:
        tables: tables of the length.
        ones: ones of the parent, f.
        flips: bits that the best mutant flips, l.
        good: zeros among them, g.
        crossover: the phase.
        later: (n + 1,) expected evaluations that remain, by the number of ones; known above f.

    Returns:
        Evaluations of children, probability of a gain, and expected later evaluations if there is one, times
        that probability.
    """
    rate, children = crossover.rate, crossover.children
    cost = float(children)
    if crossover.copies_free:
        cost *= 1.0 - power(rate, flips) - power(1.0 - rate, flips)
    bad = flips - good
    own = good - bad  # gain of the mutant itself
    if good == 0:
        return cost, 0.0, 0.0
    low_kept, num_kept = binomial(tables.logs, good, rate, tables.kept)
    low_spoilt, num_spoilt = binomial(tables.logs, bad, rate, tables.spoilt)
    tail = 0.0
    for m in range(num_spoilt - 1, -1, -1):
        tail += tables.spoilt[m]
        tables.at_least[m] = min(tail, 1.0)
    most = low_kept + num_kept - 1 - low_spoilt  # gain of a child that no child exceeds
    gain, remaining, before = 0.0, 0.0, 0.0
    for k in range(max(own, 0), max(most, own) + 1):
        at_most = 0.0
        if k >= most:
            at_most = 1.0
        else:
            for m in range(num_kept):
                needed = (
                    low_kept + m - k - low_spoilt
                )  # other flips taken, above the lowest, so that a - d <= k
                if needed <= 0:
                    at_most += tables.kept[m]
                elif needed < num_spoilt:
                    at_most += tables.kept[m] * tables.at_least[needed]
        now = power(min(at_most, 1.0), children)
        if k > 0:
            gain += now - before
            remaining += (now - before) * later[ones + k]
        before = now
    return cost, gain, remaining
