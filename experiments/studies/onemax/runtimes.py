"""Expected and simulated runtimes of controllers on OneMax: what the tables and pictures show."""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.studies.controllers import packaged_seeds
from swarm_gym.comparing.onemax import expected_runtime
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.onemax_rules import OPTIMIZER
from swarm_gym.reference.onemax.optima import CHOICES, is_packaged, packaged
from swarm_gym.reference.onemax.runtimes import LambdaDecisions, expected_runtimes
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import TEST

Floats = NDArray[np.float64]

SIZES = (100, 200, 500, 1000, 2000)
LARGE = (5000, 10_000, 20_000, 40_000)
SIMULATED = TEST[90_000:91_000]
MANY = TEST[80_000:90_000]  # of the table of simulations, so that its own noise is small
SIDE_BY_SIDE = 500


class MeanOfRuns(NamedTuple):
    """A mean of runs, with its standard error."""

    mean: float
    error: float


@cache
def expected(name: str, size: int, copies_free: bool = True) -> float:
    """Return the expected evaluations of a controller from half of the ones, the first string included."""
    return expected_runtime(make_controller(name), size, copies_free=copies_free)


def expected_of_seeds(recipe: str, size: int, copies_free: bool = True) -> Floats:
    """Return the expected evaluations of the policies of all training seeds of a recipe."""
    return np.array([expected(name, size, copies_free) for name in packaged_seeds(recipe)])


def expected_of_sizes(sizes: NDArray) -> float:
    """Return the expected evaluations from half of the ones, the first string included, by lambdas (n,)."""
    start = len(sizes) // 2
    return float(expected_runtimes(LambdaDecisions.of_size(sizes), start)[start]) + 1.0


def optimum(choices: str, size: int, counting: str = "copies-free") -> float:
    """Return the least expected evaluations among these choices; NaN where it does not ship."""
    if not is_packaged(size, choices, counting):
        return float("nan")
    return packaged(size, choices, counting).evaluations


@cache
def best_constant(size: int) -> tuple[int, float]:
    """Return the constant lambda of the least expected evaluations, and these."""
    runtimes = {number: expected_of_sizes(np.full(size, number)) for number in CHOICES["onemax"].mutants}
    best = min(runtimes, key=runtimes.__getitem__)
    return best, runtimes[best]


def simulated(controller: Controller, size: int, seeds: range = SIMULATED) -> MeanOfRuns:
    """Return the mean evaluations of simulated runs, one for each seed."""
    found: list[Floats] = []
    for first in range(seeds.start, seeds.stop, SIDE_BY_SIDE):
        part = range(first, min(first + SIDE_BY_SIDE, seeds.stop))
        runs = run_episodes(controller, f"onemax:{size}", part, OPTIMIZER, iterations=12 * size)
        if (runs.final_fitness > 0.0).any():
            raise ValueError(f"n = {size}: a run did not end within {12 * size} iterations; raise the limit")
        found.append(runs.evaluations)
    evaluations = np.concatenate(found)
    return MeanOfRuns(float(evaluations.mean()), float(evaluations.std(ddof=1) / np.sqrt(len(evaluations))))


def one_step(size: int, zeros: int, sizes: Sequence[int]) -> Floats:
    """Return expected evaluations if lambda has this value at this number of zeros, and is optimal after.

    Args:
        size: n.
        zeros: n - f of the state.
        sizes: values of lambda.
    """
    best = packaged(size, "onemax").decisions.mutants
    runtimes = []
    for number in sizes:
        changed = best.copy()
        changed[size - zeros] = number
        runtimes.append(expected_runtimes(LambdaDecisions.of_size(changed), size - zeros)[size - zeros])
    return np.array(runtimes)
