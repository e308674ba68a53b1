"""Expected runtimes of controls with a memory of one number: they climb a ladder, and fall by gains.

The state of such a control is its rung. An iteration that gains nothing leads to the next rung; one that
gains leads down by some rungs, at most to the first. The one-fifth rule is of this kind: its lambda on rung r
is F^(r / 4), and a gain, which divides lambda by F, leads down by four rungs.

With T(f, r) for the expected evaluations from f ones and rung r on, and R(f) for the last rung at f ones,

    T(f, r) = E[cost] + sum over k > 0 of P(gain = k) T(f + k, max(r - 4, 0)) + P(gain = 0) T(f, r'),

where r' is the smaller of r + 1 and R(f). Nothing on the right is unknown if f falls from n and r from R(f);
on the last rung T(f, R) is on both sides. R(f) may be the end of the ladder for every f. To spare rungs that
few runs reach, and that cost most time, it may be lower. It must not fall with f.
"""

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
from swarm_gym.reference.onemax.runtimes import LambdaDecisions

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Ladder:
    """A control whose memory is a rung.

    Attributes:
        rungs: decisions on each rung; runs begin on the first.
        last: (n,) last rung for each number of ones f = 0, ..., n - 1; it never falls with f.
        fall: rungs that a gain leads down.
    """

    rungs: LambdaDecisions
    last: Integers
    fall: int

    def __post_init__(self) -> None:
        count = len(self.rungs.mutants)
        if (np.diff(self.last) < 0).any() or self.last.min() < 0 or self.last.max() >= count:
            raise ValueError(
                f"last: expected rungs from 0 to {count - 1} that never fall with the number of ones, got "
                f"{self.last.tolist()}"
            )


def ladder_runtimes(ladder: Ladder, start: int = 0, copies_free: bool = True) -> Floats:
    """Return (rungs, n + 1) expected evaluations that remain, by rung and ones.

    They are NaN below the start, and on rungs above the last one. A run from f ones costs one evaluation
    more, for its first string.

    Args:
        ladder: the control.
        start: least number of ones that matters.
        copies_free: whether children that equal the parent or the best mutant cost nothing, as published.
    """
    rungs = ladder.rungs
    return _evaluate(
        start,
        rungs.mutants,
        rungs.children,
        rungs.strength,
        rungs.bias,
        ladder.last,
        ladder.fall,
        copies_free,
    )


@entry
def _evaluate(
    start: int,
    mutants: Integers,
    children: Integers,
    strength: Floats,
    bias: Floats,
    highest: Integers,
    fall: int,
    copies_free: bool,
) -> Floats:
    size = highest.shape[0]
    tables, later = make_tables(size), np.full((mutants.shape[0], size + 1), np.nan)
    most = 64 * (size + 2)
    strengths, good, weights = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most)
    later[:, size] = 0.0
    for ones in range(size - 1, start - 1, -1):
        last = highest[ones]
        for rung in range(last, -1, -1):
            mutation = Mutation(mutants[rung], min(strength[rung] * mutants[rung] / size, 1.0))
            crossover = Crossover(children[rung], min(bias[rung] / children[rung], 1.0), copies_free)
            count = mutation_outcomes(tables, size, ones, mutation, strengths, good, weights)
            cost, gain, remaining = float(mutants[rung]), 0.0, 0.0
            after_gain = later[max(rung - fall, 0)]
            for i in range(count):
                one = crossover_outcome(tables, ones, strengths[i], good[i], crossover, after_gain)
                cost += weights[i] * one[0]
                gain += weights[i] * one[1]
                remaining += weights[i] * one[2]
            if rung < last:
                later[rung, ones] = cost + remaining + (1.0 - gain) * later[rung + 1, ones]
            else:
                later[rung, ones] = (cost + remaining) / gain if gain > 0.0 else np.inf
    return later
