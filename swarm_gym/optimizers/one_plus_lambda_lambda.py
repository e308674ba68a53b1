"""The (1 + (lambda, lambda)) genetic algorithm on OneMax, by counts of ones instead of bit strings.

Sources: B. Doerr, C. Doerr, F. Ebel, "From black-box complexity to designing new genetic algorithms",
Theoretical Computer Science 567, 2015; with the four parameters, and the way in which evaluations are
counted, of T. Nguyen, P. Le, C. Doerr, N. Dang, "Multi-parameter control for the (1+(lambda,lambda))-GA on
OneMax via deep reinforcement learning", FOGA 2025.

An iteration has two phases. *Mutation*: a strength l is drawn from Bin(n, alpha lambda_m / n), again while it
is 0; lambda_m mutants flip l bits each, and the best is kept. *Crossover*: lambda_c children take each bit
from it with probability beta / lambda_c, else from the parent. The best of the children and the best mutant
replaces the parent unless it is worse. lambda_m is the population size.

On OneMax only counts matter: of l flipped bits, g were zero, which is hypergeometric, and a child takes
Bin(g, c) of these and Bin(l - g, c) of the others. So strings need not be kept. The best of lambda_m mutants
is drawn at once, from the power of the distribution function, and an iteration takes O(lambda_m + lambda_c).
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, choice
from swarm_gym.population import Swarms, Workspace, evaluate_member
from swarm_gym.problem.onemax.table import OneMaxTable

Floats = NDArray[np.float64]

# Half the width of a window around a mode, in standard deviations, beyond which there is less than 1e-17; and
# a density, relative to the density of the mode, at which a window ends.
REACH, LEAST_REACH, TINY = 9.0, 40, 1e-18


class OnePlusLambdaLambdaParameters(NamedTuple):
    """Parameters of the (1 + (lambda, lambda)) genetic algorithm."""

    children: Annotated[
        float,
        Parameter(
            0.0,
            0.0,
            100_000.0,
            "lambda_c",
            "children in the crossover phase, rounded; 0 is as many as mutants",
            (1.0, 256.0),
        ),
    ]
    strength: Annotated[
        float,
        Parameter(
            1.0, 0.0, 100_000.0, "alpha", "bits that a mutant flips, expected, per mutant", (0.001, 32.0)
        ),
    ]
    bias: Annotated[
        float,
        Parameter(
            1.0,
            0.0,
            100_000.0,
            "beta",
            "expected number of children that take a given bit from the mutant",
            (0.1, 4.0),
        ),
    ]
    counting: Annotated[
        float,
        choice(
            "whether a child that equals the parent or the best mutant counts as an evaluation",
            "copies-free",
            "all",
        ),
    ]


@kernel
def iterate(
    parameters: OnePlusLambdaLambdaParameters,
    swarms: Swarms,
    b: int,
    table: OneMaxTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
) -> None:
    """Advance swarm `b` by one mutation phase and one crossover phase, as far as the budget lasts."""
    ones, size = int(swarms.positions[b, 0, 0]), table.size
    left = swarms.budget[b] - swarms.evaluations[b]
    if ones >= size or left <= 0:
        return
    mutants = swarms.size[b]
    children = math.floor(parameters.children + 0.5)
    if children == 0:
        children = mutants
    mutation = min(parameters.strength * mutants / size, 1.0)
    crossover = min(parameters.bias / children, 1.0)
    mutants = min(mutants, left)
    fill_uniform(swarms.stream[b], work.noise)
    flips = _draw_strength(size, mutation, work.noise[0])
    good = _draw_best(size, size - ones, flips, mutants, work.noise[1])
    gain, counted = _cross(
        swarms, b, work, good, flips - good, crossover, children, left - mutants, parameters.counting == 0.0
    )
    swarms.evaluations[b] += mutants + counted - 1  # `evaluate_member` counts the last one
    work.path[1] = ones + max(gain, 0)
    evaluate_member(swarms, b, 0, table, work)
    _copy_first(swarms, b)


@kernel
def _draw_strength(size: int, rate: float, share: float) -> int:
    """Return how many bits a mutant flips: Bin(n, rate), given that it is not 0, at this share in [0, 1)."""
    weights = np.empty(_width(size * rate * (1.0 - rate), size))
    first, count = _binomial(size, rate, weights)
    if first == 0:
        weights[0] = 0.0
    if count == 1:  # a rate so low that nothing but 0 is left in the window, or one of 1
        return max(first, 1)
    return max(first + _find(weights, count, share * weights[:count].sum()), 1)


@kernel
def _draw_best(size: int, zeros: int, flips: int, mutants: int, share: float) -> int:
    """Return the most zeros that one of the mutants flips, at this share in [0, 1) of its distribution."""
    lowest, highest = max(0, flips - (size - zeros)), min(flips, zeros)
    rest = size - zeros - flips
    variance = flips * (zeros / size) * (1.0 - zeros / size)
    weights = np.empty(_width(variance, highest - lowest))
    mode = int((flips + 1.0) * (zeros + 1.0) / (size + 2.0))
    mode = min(max(mode, lowest), highest)
    reach, first, weight = (weights.shape[0] - 1) // 2, mode, 1.0
    while first > max(lowest, mode - reach) and weight > TINY:
        weight *= (first * (rest + float(first))) / ((zeros - first + 1.0) * (flips - first + 1.0))
        first -= 1
    last, weight = first, max(weight, TINY * TINY)
    weights[0] = weight
    while last < highest and last - first < weights.shape[0] - 1 and (last < mode or weight > TINY):
        weight *= ((zeros - last) * float(flips - last)) / ((last + 1.0) * (rest + last + 1.0))
        last += 1
        weights[last - first] = weight
    total, below = weights[: last - first + 1].sum(), 0.0
    for k in range(first, last):
        below += weights[k - first]
        if share < _power(below / total, mutants):
            return k
    return last


@kernel
def _cross(
    swarms: Swarms,
    b: int,
    work: Workspace,
    good: int,
    bad: int,
    rate: float,
    children: int,
    left: int,
    copies_free: bool,
) -> tuple[int, int]:
    """Return the gain of the best of the children and the best mutant, and the evaluations of the children.

    Args:
        swarms: all swarms.
        b: number of the swarm.
        work: scratch arrays.
        good: zeros that the best mutant flips.
        bad: ones that it flips.
        rate: probability that a child takes a bit from the mutant.
        children: number of children.
        left: evaluations that may be counted.
        copies_free: whether children that equal parent or mutant are not counted.
    """
    of_good = np.empty(_width(good * rate * (1.0 - rate), good))
    of_bad = np.empty(_width(bad * rate * (1.0 - rate), bad))
    first_good, num_good = _binomial(good, rate, of_good)
    first_bad, num_bad = _binomial(bad, rate, of_bad)
    total_good, total_bad = of_good[:num_good].sum(), of_bad[:num_bad].sum()
    gain, counted, at = good - bad, 0, work.noise.shape[0]
    for _ in range(children):
        if at >= work.noise.shape[0]:
            fill_uniform(swarms.stream[b], work.noise)
            at = 0
        taken = first_good + _find(of_good, num_good, work.noise[at] * total_good)
        spoilt = first_bad + _find(of_bad, num_bad, work.noise[at + 1] * total_bad)
        at += 2
        is_copy = taken + spoilt == 0 or (taken == good and spoilt == bad)
        if not (copies_free and is_copy):
            if counted == left:
                break
            counted += 1
        gain = max(gain, taken - spoilt)
    return gain, counted


@kernel
def _width(variance: float, most: int) -> int:
    """Return the length of an array for the window around a mode; `most` + 1 numbers are possible."""
    return min(2 * (int(REACH * math.sqrt(variance)) + LEAST_REACH) + 1, 2 * most + 1)


@kernel
def _binomial(trials: int, rate: float, weights: Floats) -> tuple[int, int]:
    """Write weights that are proportional to Bin(trials, rate) around the mode.

    Returns:
        The number that the first weight is for, and how many weights there are.
    """
    if rate >= 1.0 or rate <= 0.0 or trials == 0:
        weights[0] = 1.0
        return (trials if rate >= 1.0 else 0), 1
    odds = rate / (1.0 - rate)
    mode = min(int((trials + 1.0) * rate), trials)
    reach, first, weight = (weights.shape[0] - 1) // 2, mode, 1.0
    while first > max(0, mode - reach) and weight > TINY:
        weight *= first / ((trials - first + 1.0) * odds)
        first -= 1
    # Neighbours have a fixed ratio, so that the sum does not depend on where it begins.
    last, weight = first, max(weight, TINY * TINY)
    weights[0] = weight
    while last < trials and last - first < weights.shape[0] - 1 and (last < mode or weight > TINY):
        weight *= (trials - last) / (last + 1.0) * odds
        last += 1
        weights[last - first] = weight
    return first, last - first + 1


@kernel
def _find(weights: Floats, count: int, share: float) -> int:
    """Return the first index at which the sum of the first weights exceeds a share of their total."""
    below = 0.0
    for k in range(count - 1):
        below += weights[k]
        if share < below:
            return k
    return count - 1


@kernel
def _power(base: float, exponent: int) -> float:
    """Return a power by squaring, which has the same bits on every processor."""
    result = 1.0
    while exponent > 0:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result


@kernel
def _copy_first(swarms: Swarms, b: int) -> None:
    """Let all members of swarm `b` be the parent, which is the only string that is kept."""
    for i in range(1, swarms.size[b]):
        swarms.positions[b, i, 0] = swarms.positions[b, 0, 0]
        swarms.fitness[b, i] = swarms.fitness[b, 0]
        swarms.collision[b, i] = 0.0


@kernel
def begin(
    _parameters: OnePlusLambdaLambdaParameters,
    swarms: Swarms,
    b: int,
    table: OneMaxTable,
    work: Workspace,
    size: int,
) -> None:
    """Begin swarm `b` with a string of the scenario's number of ones, for one evaluation."""
    swarms.size[b] = size
    work.path[1] = table.start
    evaluate_member(swarms, b, 0, table, work)
    _copy_first(swarms, b)


@kernel
def change_size(
    _parameters: OnePlusLambdaLambdaParameters,
    swarms: Swarms,
    b: int,
    _table: OneMaxTable,
    _work: Workspace,
    size: int,
) -> None:
    """Let the next iteration have this many mutants."""
    swarms.size[b] = size
    _copy_first(swarms, b)


class OnePlusLambdaLambda(Optimizer):
    """The (1 + (lambda, lambda)) genetic algorithm on OneMax, whose population size is lambda."""

    name = "one-plus-lambda-lambda"
    parameter_class = OnePlusLambdaLambdaParameters
    encodings = ("ones",)
    adopts = False
    repairs = False
    evaluations_per_member = 2.0
    default_options: ClassVar[Mapping[str, object]] = {
        "scenario": "onemax:100",
        "iterations": 20_000,
        "initial_population_size": 1,
        "min_population_size": 1,
        "max_population_size": 512,
        "observation": "theory",
        "reward": "runtime",
    }
    kernels = loop.Kernels(iterate, begin=begin, change_size=change_size)
