"""Genetic algorithm that keeps its best member.

Source: A. B. Djurisic, "Elite genetic algorithms with adaptive mutations for solving continuous optimization
problems", Optics Communications 151, 1998; with the parameters that the MOA paper prints (Li et al., Acta
Electronica Sinica 44(9), 2016). Coding and operators are not printed: real numbers, a windowed roulette
wheel, one-point crossover and uniform mutation of single genes are readings, see docs/readings.md.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, evaluate_member, is_spent
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]

# Weight of the worst member on the wheel: a share of the spread of the fitness, and nearly 0.
LEAST_SHARE, LEAST_WEIGHT = 0.01, 1e-12


class EliteGeneticParameters(NamedTuple):
    """Parameters of the elite genetic algorithm."""

    crossover: Annotated[
        float, Parameter(0.2, 0.0, 1.0, "pc", "share of children in a generation", (0.01, 1.0))
    ]
    mutation: Annotated[
        float, Parameter(0.01, 0.0, 1.0, "pm", "probability that a gene is drawn anew", (0.001, 1.0))
    ]


@kernel
def iterate(
    parameters: EliteGeneticParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one generation.

    It consists of the best member, then copies drawn by the wheel, then children of pairs drawn by the wheel.
    All are evaluated, as the budget of the MOA paper implies. When the budget is spent, the remaining members
    stay as they are.
    """
    size, width, path = swarms.size[b], swarms.positions.shape[2], work.path
    parents, fitness = swarms.positions[b, :size].copy(), swarms.fitness[b, :size].copy()
    wheel, best = _wheel(fitness), int(np.argmin(fitness))
    num_children = int(np.floor(parameters.crossover * (size - 1) + 0.5))
    for i in range(size):
        if is_spent(swarms, b):
            break
        first = second = best
        cut = width
        if i > 0:
            fill_uniform(swarms.stream[b], work.noise)
            first = second = _spin(wheel, work.noise[0])
            if i >= size - num_children:
                second = _spin(wheel, work.noise[1])
                # The cut is between two genes, so that each parent gives at least one.
                cut = 1 + int(work.noise[2] * (table.dimension - 1))
        for k in range(width):
            path[k + 1] = parents[first, k] if k < cut else parents[second, k]
        if i > 0:
            _mutate(swarms, b, table, work, parameters.mutation)
            if repair_degree > 0.0:
                repair(table, path, repair_degree)
        evaluate_member(swarms, b, i, table, work)


@kernel
def _wheel(fitness: Floats) -> Floats:
    """Return cumulative weights of the members, from 0 to 1: the smaller the fitness, the larger a weight."""
    worst = fitness.max()
    floor = LEAST_WEIGHT + LEAST_SHARE * (worst - fitness.min())
    sums, total = np.empty(fitness.shape[0]), 0.0
    for i in range(fitness.shape[0]):
        total += worst - fitness[i] + floor
        sums[i] = total
    return sums / total


@kernel
def _spin(wheel: Floats, share: float) -> int:
    """Return the member at this share of the wheel, in [0, 1)."""
    for i in range(wheel.shape[0] - 1):
        if share < wheel[i]:
            return i
    return wheel.shape[0] - 1


@kernel
def _mutate(swarms: Swarms, b: int, table: Table, work: Workspace, rate: float) -> None:
    """Draw some genes of `work.path` again, uniform inside the bounds."""
    fill_uniform(swarms.stream[b], work.noise)
    mutated = work.noise[: table.dimension] < rate
    if mutated.any():
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(table.dimension):
            if mutated[k]:
                work.path[k + 1] = table.lower[k] + (table.upper[k] - table.lower[k]) * work.noise[k]


class EliteGenetic(Optimizer):
    """EGA of the MOA paper, with the parameters printed there."""

    name = "elite-genetic"
    parameter_class = EliteGeneticParameters
    kernels = loop.Kernels(iterate)
