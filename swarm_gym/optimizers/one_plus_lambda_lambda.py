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

A swarm keeps the distribution of the strength for as long as its rate stays. Its field has that distribution.
Other weights lie in scratch arrays, so that an iteration allocates no array and touches little memory of a
swarm: with thousands of swarms, most time would be spent on waiting for memory.
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
from swarm_gym.population import FEASIBLE_SHARE, NUM_SUMMARIES, Swarms, Workspace, evaluate_member
from swarm_gym.problem.onemax.table import OneMaxTable
from swarm_gym.problem.onemax.weights import (
    LEAST_REACH,
    TINY,
    add_up,
    fill_binomial,
    find_sum,
    power,
    sum_of,
    window_length,
)
from swarm_gym.problem.tables import Tables

Floats = NDArray[np.float64]

# Columns of a swarm's field: length and rate that the distribution of the strength is kept for, its first
# number and how many there are; then the sums of its weights, and room for as many again. The scratch array
# of an iteration, as long, has two parts of equal length for other weights.
_SIZE, _RATE, _FIRST, _COUNT, _SUMS = range(5)


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


@kernel(borrows=True)
def iterate(
    parameters: OnePlusLambdaLambdaParameters,
    swarms: Swarms,
    b: int,
    table: OneMaxTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
) -> None:
    """Advance swarm `b` by one mutation phase and one crossover phase, as far as the budget lasts."""
    size = table.size
    ones = size - int(swarms.best_fitness[b])  # of the parent, which is the best so far
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
    field = swarms.field[b]
    flips = _draw_strength(field, size, mutation, work.noise[0])
    good = _draw_best(work.numbers, size, size - ones, flips, mutants, work.noise[1])
    gain, counted = _cross(
        swarms, b, work, good, flips - good, crossover, children, left - mutants, parameters.counting == 0.0
    )
    swarms.evaluations[b] += mutants + counted
    if gain > 0:  # else the parent stays, or a string of as many ones replaces it
        swarms.evaluations[b] -= 1  # which `evaluate_member` counts
        work.path[1] = ones + gain
        evaluate_member(swarms, b, 0, table, work)
        _copy_first(swarms, b, 1)


@kernel(borrows=True)
def _draw_strength(field: Floats, size: int, rate: float, share: float) -> int:
    """Return how many bits a mutant flips: Bin(n, rate), given that it is not 0, at this share in [0, 1)."""
    if field[_SIZE] != size or field[_RATE] != rate:
        sums = field[_SUMS : _SUMS + window_length(size * rate * (1.0 - rate), size)]
        first, count = fill_binomial(size, rate, sums)
        if first == 0:
            sums[0] = 0.0
        add_up(sums, count)
        field[_SIZE], field[_RATE], field[_FIRST], field[_COUNT] = size, rate, first, count
    else:
        first, count = int(field[_FIRST]), int(field[_COUNT])
        sums = field[_SUMS : _SUMS + count]
    if count == 1:  # a rate so low that nothing but 0 is left in the window, or one of 1
        return max(first, 1)
    return max(first + find_sum(sums, count, share * sums[count - 1]), 1)


@kernel(borrows=True)
def _draw_best(scratch: Floats, size: int, zeros: int, flips: int, mutants: int, share: float) -> int:
    """Return the most zeros that one of the mutants flips, at this share in [0, 1) of its distribution."""
    lowest, highest = max(0, flips - (size - zeros)), min(flips, zeros)
    rest = size - zeros - flips
    length = 2 * (highest - lowest) + 1
    if highest - lowest > LEAST_REACH:
        length = window_length(flips * (zeros / size) * (1.0 - zeros / size), highest - lowest)
    weights = scratch[:length]
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
    total, below = sum_of(weights, last - first + 1), 0.0
    for k in range(first, last):
        below += weights[k - first]
        if share < power(below / total, mutants):
            return k
    return last


@kernel(borrows=True)
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
    room = work.numbers.shape[0] // 2
    of_good = work.numbers[: window_length(good * rate * (1.0 - rate), good)]
    of_bad = work.numbers[room : room + window_length(bad * rate * (1.0 - rate), bad)]
    first_good, num_good = fill_binomial(good, rate, of_good)
    first_bad, num_bad = fill_binomial(bad, rate, of_bad)
    total_good, total_bad = add_up(of_good, num_good), add_up(of_bad, num_bad)
    gain, counted, at = good - bad, 0, work.noise.shape[0]
    for _ in range(children):
        if at >= work.noise.shape[0]:
            fill_uniform(swarms.stream[b], work.noise)
            at = 0
        taken = first_good + find_sum(of_good, num_good, float(work.noise[at]) * total_good)
        spoilt = first_bad + find_sum(of_bad, num_bad, float(work.noise[at + 1]) * total_bad)
        at += 2
        is_copy = (taken + spoilt == 0) | ((taken == good) & (spoilt == bad))
        counts = 1 - int(copies_free & is_copy)  # without a branch, which would be guessed wrong
        if counted + counts > left:
            break
        counted += counts
        gain = max(gain, taken - spoilt)
    return gain, counted


@kernel(borrows=True)
def _copy_first(swarms: Swarms, b: int, first: int) -> None:
    """Let the members of swarm `b`, from the `first` on, be the parent: the only string that is kept."""
    for i in range(first, swarms.size[b]):
        swarms.positions[b, i, 0] = swarms.positions[b, 0, 0]
        swarms.fitness[b, i] = swarms.fitness[b, 0]
        swarms.collision[b, i] = 0.0


@kernel(borrows=True)
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
    _copy_first(swarms, b, 1)


@kernel(borrows=True)
def change_size(
    _parameters: OnePlusLambdaLambdaParameters,
    swarms: Swarms,
    b: int,
    _table: OneMaxTable,
    _work: Workspace,
    size: int,
) -> None:
    """Let the next iteration have this many mutants."""
    before = swarms.size[b]
    swarms.size[b] = size
    _copy_first(swarms, b, before)


@kernel(borrows=True)
def summarise(
    _parameters: OnePlusLambdaLambdaParameters, swarms: Swarms, b: int, _mean_weight: float
) -> None:
    """Write the statistics of members that are all the same and feasible."""
    for k in range(NUM_SUMMARIES):
        swarms.summary[b, k] = 0.0
    swarms.summary[b, FEASIBLE_SHARE] = 1.0


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
    kernels = loop.Kernels(iterate, begin=begin, change_size=change_size, summarise=summarise)

    @staticmethod
    def field_size(tables: Tables) -> int:
        """Return how many numbers a swarm keeps and how long scratch arrays are, for the longest string."""
        assert isinstance(tables, OneMaxTable)
        return _SUMS + 2 * max(window_length(size / 4.0, size) for size in np.ravel(tables.size).tolist())
