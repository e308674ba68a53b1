"""The problem table of OneMax, see `tables`: a string is a position whose one component counts its ones."""

from typing import Generic, NamedTuple

import numpy as np

from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.problem.padding import Floats, Integers, Whole, pad
from swarm_gym.scenarios import OneMaxScenario


class OneMaxTable(NamedTuple, Generic[Whole]):
    """The problem table of OneMax; in a stacked table every field has a leading problem axis."""

    dimension: Whole  # 1: the number of ones
    size: Whole  # n, the length of the string
    start: Whole  # number of ones at the beginning
    lower: Floats  # (C,) 0 and padding
    upper: Floats  # (C,) n and padding
    initial_lower: Floats  # (C,) number of ones at the beginning and padding
    initial_upper: Floats  # (C,)


OneMaxTables = OneMaxTable[Integers]  # of stacked problems


def tabulate(scenario: OneMaxScenario) -> OneMaxTable:
    """Return the problem table of a scenario."""
    lower, upper, start = (pad(np.array([float(k)])) for k in (0, scenario.size, scenario.start))
    return OneMaxTable(1, scenario.size, scenario.start, lower, upper, start, start)


@entry
def count_ones(sizes: Integers, problem: Integers, zeros: Floats) -> Floats:
    """Return (B,) numbers of ones of swarms on these problems, (B,), by their numbers of zeros, (B,).

    Args:
        sizes: (problems,) lengths of the strings.
        problem: (B,) numbers of the problems.
        zeros: (B,) numbers of zeros; infinite before the first reset, which counts as none.
    """
    ones = np.empty(problem.shape[0])
    for b in range(problem.shape[0]):
        ones[b] = sizes[problem[b]] - (zeros[b] if np.isfinite(zeros[b]) else 0.0)
    return ones


@kernel
def select(tables: OneMaxTables, index: int) -> OneMaxTable:
    """Return one problem table out of stacked ones, as views."""
    return OneMaxTable(
        tables.dimension[index],
        tables.size[index],
        tables.start[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
    )


@kernel(inline="late")
def evaluate(table: OneMaxTable, path: Floats) -> tuple[float, float]:
    """Return the number of bits that are not set, and 0 as degree of collision; see `tables`."""
    return table.size - path[1], 0.0


@kernel(inline="late")
def repair(table: OneMaxTable, path: Floats, repair_degree: float) -> None:
    """Do nothing, since there are no obstacles; see `tables`."""
