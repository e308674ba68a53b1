"""Expected runtimes of any control that sees n and f alone, and the control whose expected runtime is least.

With the expectations of `iteration`, the expected evaluations T(f) from f ones on follow from those above f:

    T(f) = (E[cost] + sum over k > 0 of P(gain = k) T(f + k)) / P(gain > 0),  T(n) = 0.

The optimal decisions minimise T(f) for each f. They are found among given choices, each by itself for each f,
since nothing but f carries over. Source of the recursion: N. Buskulic, C. Doerr, "Maximizing drift is not
optimal for solving OneMax", Evolutionary Computation 29(4), 2021, for one phase instead of two.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry
from swarm_gym.reference.onemax.iteration import (
    Crossover,
    Mutation,
    crossover_outcome,
    make_tables,
    mutation_outcomes,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class LambdaDecisions:
    """The decisions of a control for every number of ones f = 0, ..., n - 1; all arrays have shape (n,).

    Attributes:
        mutants: lambda_m, whole numbers from 1 on.
        children: lambda_c, whole numbers from 1 on.
        strength: alpha; a mutant flips each bit with probability alpha lambda_m / n, at most 1.
        bias: beta; a child takes each bit from the mutant with probability beta / lambda_c, at most 1.
    """

    mutants: Integers
    children: Integers
    strength: Floats
    bias: Floats

    @classmethod
    def of_size(cls, sizes: NDArray) -> "LambdaDecisions":
        """Return the decisions of a control of lambda alone, (n,): as many children, alpha = beta = 1."""
        sizes = np.asarray(sizes, dtype=np.int64)
        return cls(sizes, sizes, np.ones(len(sizes)), np.ones(len(sizes)))


@dataclass(frozen=True)
class Choices:
    """The values that each decision may take.

    Attributes:
        mutants: choices of lambda_m.
        children: choices of lambda_c; empty for lambda_c = lambda_m, alpha = beta = 1.
        strength: choices of alpha.
        bias: choices of beta.
    """

    mutants: tuple[int, ...]
    children: tuple[int, ...] = ()
    strength: tuple[float, ...] = (1.0,)
    bias: tuple[float, ...] = (1.0,)


def expected_runtimes(decisions: LambdaDecisions, start: int = 0, copies_free: bool = True) -> Floats:
    """Return (n + 1,) expected evaluations that remain, by the number of ones; NaN below the start.

    A run from f ones costs one evaluation more, for its first string.

    Args:
        decisions: decisions for each number of ones.
        start: least number of ones that matters.
        copies_free: whether children that equal the parent or the best mutant cost nothing, as published.
    """
    return _evaluate(
        start, decisions.mutants, decisions.children, decisions.strength, decisions.bias, copies_free
    )


def optimal_control(
    size: int, choices: Choices, start: int = 0, copies_free: bool = True, most_flips: float = math.inf
) -> tuple[Floats, LambdaDecisions]:
    """Return the least expected evaluations that remain, (n + 1,), and the decisions that reach them.

    Both are NaN, or 1, below the start.

    Args:
        size: n, the length of the string.
        choices: values that the decisions may take.
        start: least number of ones that matters.
        copies_free: see `expected_runtimes`.
        most_flips: bits that a mutant may flip, expected, at most; other pairs of lambda_m and alpha are left
            out, where there are four parameters.
    """
    if not choices.children:
        mutants = children = np.array(choices.mutants)
        strength = bias = np.ones(len(mutants))
        later, chosen, _ = _optimise(size, start, mutants, strength, children, bias, True, copies_free)
        return later, LambdaDecisions.of_size(mutants[chosen])
    mutants, strength = map(np.ravel, np.meshgrid(choices.mutants, choices.strength, indexing="ij"))
    few = mutants * strength <= most_flips
    mutants, strength = mutants[few], strength[few]
    children, bias = map(np.ravel, np.meshgrid(choices.children, choices.bias, indexing="ij"))
    later, first, second = _optimise(
        size, start, mutants, strength.astype(float), children, bias.astype(float), False, copies_free
    )
    return later, LambdaDecisions(mutants[first], children[second], strength[first], bias[second])


@entry
def _evaluate(
    start: int, mutants: Integers, children: Integers, strength: Floats, bias: Floats, copies_free: bool
) -> Floats:
    size = mutants.shape[0]
    tables, later = make_tables(size), np.full(size + 1, np.nan)
    most = 64 * (size + 2)
    strengths, good, weights = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most)
    later[size] = 0.0
    for ones in range(size - 1, start - 1, -1):
        mutation = Mutation(mutants[ones], min(strength[ones] * mutants[ones] / size, 1.0))
        crossover = Crossover(children[ones], min(bias[ones] / children[ones], 1.0), copies_free)
        count = mutation_outcomes(tables, size, ones, mutation, strengths, good, weights)
        cost, gain, remaining = float(mutants[ones]), 0.0, 0.0
        for i in range(count):
            one = crossover_outcome(tables, ones, strengths[i], good[i], crossover, later)
            cost += weights[i] * one[0]
            gain += weights[i] * one[1]
            remaining += weights[i] * one[2]
        later[ones] = (cost + remaining) / gain if gain > 0.0 else np.inf
    return later


@entry
def _optimise(
    size: int,
    start: int,
    mutants: Integers,
    strength: Floats,
    children: Integers,
    bias: Floats,
    is_paired: bool,
    copies_free: bool,
) -> tuple[Floats, Integers, Integers]:
    """Return the least expected evaluations, and the numbers of the best mutation and crossover for each f.

    A mutation goes with the crossover of the same number if they are paired, else with any.
    """
    tables, later = make_tables(size), np.full(size + 1, np.nan)
    best_mutation, best_crossover = np.zeros(size, np.int64), np.zeros(size, np.int64)
    num_mutations, num_crossovers = mutants.shape[0], children.shape[0]
    most = 64 * (size + 2)
    strengths, good = np.empty((num_mutations, most), np.int64), np.empty((num_mutations, most), np.int64)
    weights, counts = np.empty((num_mutations, most)), np.zeros(num_mutations, np.int64)
    expected = min((strength * mutants).max(), float(size))
    flips_at_most = min(size, int(expected + 12.0 * math.sqrt(expected) + 60.0))  # but for less than `LEAST`
    known = np.full((flips_at_most + 1, flips_at_most + 1), -1, np.int64)
    brought = np.empty((most * 4, 3))
    later[size] = 0.0
    for ones in range(size - 1, start - 1, -1):
        for i in range(num_mutations):
            mutation = Mutation(mutants[i], min(strength[i] * mutants[i] / size, 1.0))
            counts[i] = mutation_outcomes(tables, size, ones, mutation, strengths[i], good[i], weights[i])
        least = np.inf
        for j in range(num_crossovers):
            crossover = Crossover(children[j], min(bias[j] / children[j], 1.0), copies_free)
            num_known = 0
            for i in range(j if is_paired else 0, j + 1 if is_paired else num_mutations):
                cost, gain, remaining = float(mutants[i]), 0.0, 0.0
                for k in range(counts[i]):
                    flips, zeros = strengths[i, k], good[i, k]
                    at = known[flips, zeros]
                    if at < 0:
                        at = num_known
                        known[flips, zeros] = at
                        num_known += 1
                        one = crossover_outcome(tables, ones, flips, zeros, crossover, later)
                        brought[at, 0], brought[at, 1], brought[at, 2] = one
                    cost += weights[i, k] * brought[at, 0]
                    gain += weights[i, k] * brought[at, 1]
                    remaining += weights[i, k] * brought[at, 2]
                if gain > 0.0 and (cost + remaining) / gain < least:
                    least = (cost + remaining) / gain
                    best_mutation[ones], best_crossover[ones] = i, j
            for i in range(j if is_paired else 0, j + 1 if is_paired else num_mutations):
                for k in range(counts[i]):
                    known[strengths[i, k], good[i, k]] = -1
        later[ones] = least
    return later, best_mutation, best_crossover
