"""CMA-ES: evolution strategy with covariance matrix adaptation, whose population size may change.

Source: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv:1604.00772v2, 2023, with its default
weights, negative ones included, and its learning rates. They follow the population size lambda, which is free
from generation to generation. The initial mean, the treatment of bounds and of repaired members, and the
criteria of restarts are readings, see docs/readings.md.
"""

from collections.abc import Mapping
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.cma_es.learning import learn
from swarm_gym.optimizers.cma_es.rates import write_weights
from swarm_gym.optimizers.cma_es.sampling import (
    draw_generation,
    make_offspring,
    ranked,
    ranked_with_penalty,
)
from swarm_gym.optimizers.cma_es.stalling import judge
from swarm_gym.optimizers.cma_es.state import (
    DEGENERATE,
    NEXT_SIZE,
    NO_REASON,
    NUM_COUNTS,
    REASON,
    RECORDED,
    RESTARTS,
    SINCE_BEST,
    STALLED,
    STEP_SIZE,
    layout,
    spread_out,
)
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, choice
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, Tables
from swarm_gym.sources import draw_newcomer

Floats = NDArray[np.float64]

# From this value on, the parameter `restart` asks for a restart.
_ASKS = 0.5


class CmaEsParameters(NamedTuple):
    """Parameters of CMA-ES."""

    first_step: Annotated[
        float,
        Parameter(0.3, 1e-6, 1.0, "sigma", "step size at the beginning, in ranges of the initial bounds"),
    ]
    step_factor: Annotated[
        float,
        Parameter(1.0, 0.1, 10.0, "–", "factor of the step size before each generation", (0.5, 2.0)),
    ]
    restart: Annotated[
        float,
        Parameter(
            0.01,
            0.0,
            1.0,
            "–",
            "from 0.5 on, the swarm begins anew before this generation, with a mean from the source",
            (0.01, 1.0),
        ),
    ]
    restarts: Annotated[
        float,
        choice(
            "when the swarm begins anew by itself: if it has stalled or its covariance is degenerate, or "
            "only in the latter case",
            "stalled",
            "degenerate",
        ),
    ]


@kernel
def begin(
    parameters: CmaEsParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Draw a first population; the mean is the weighted mean of its better half."""
    loop.draw_population(parameters, swarms, b, table, work, size)
    _settle(parameters, swarms, b, table, size)


@kernel
def adopt(
    parameters: CmaEsParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Begin with given positions; the mean is the weighted mean of the better half."""
    loop.adopt_population(parameters, swarms, b, table, work, size)
    _settle(parameters, swarms, b, table, size)


@kernel
def _settle(parameters: CmaEsParameters, swarms: Swarms, b: int, table: Table, next_size: int) -> None:
    """Begin with a round distribution around the weighted mean of the better half of the members."""
    width, size, state = swarms.positions.shape[2], swarms.size[b], swarms.field[b]
    at, weights, order = layout(width), np.empty(size), ranked(swarms.fitness[b, :size])
    rates = write_weights(weights, table.dimension)
    spread_out(state, swarms.registers[b], width, table.dimension, parameters.first_step)
    for k in range(width):
        state[at.mean + k] = 0.0
        for r in range(rates.parents):
            state[at.mean + k] += weights[r] * swarms.positions[b, order[r], k]
    swarms.registers[b, NEXT_SIZE] = next_size
    swarms.registers[b, RESTARTS] = swarms.registers[b, SINCE_BEST] = 0


@kernel
def change_size(
    _parameters: CmaEsParameters,
    swarms: Swarms,
    b: int,
    table: Table,  # noqa: ARG001
    work: Workspace,  # noqa: ARG001
    size: int,
) -> None:
    """Set the size of the next generation; until then the members of the last one stay."""
    swarms.registers[b, NEXT_SIZE] = size


@kernel
def iterate(
    parameters: CmaEsParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one generation; nothing is learned from one that the budget cuts short."""
    if is_spent(swarms, b):
        return
    state, registers, n = swarms.field[b], swarms.registers[b], table.dimension
    if (
        parameters.restart >= _ASKS
        or registers[REASON] == DEGENERATE
        or (registers[REASON] == STALLED and parameters.restarts == 0.0)
    ):
        _begin_anew(parameters, swarms, b, table, work)
    state[STEP_SIZE] *= parameters.step_factor
    size, best = registers[NEXT_SIZE], swarms.best_fitness[b]
    offspring = make_offspring(size, table, swarms.positions.shape[2])
    drawn = draw_generation(swarms, b, table, work, offspring, repair_degree)
    swarms.size[b] = drawn
    registers[SINCE_BEST] = 0 if swarms.best_fitness[b] < best else registers[SINCE_BEST] + 1
    if drawn < size:
        return
    fitness, weights = swarms.fitness[b, :size], np.empty(size)
    order, rates = ranked(fitness), write_weights(weights, n)
    selected = ranked_with_penalty(fitness, order, offspring.excesses)
    learn(state, registers, n, offspring, selected, weights, rates)
    judge(state, registers, n, offspring.ranges, fitness, order, parameters.first_step)


@kernel
def _begin_anew(parameters: CmaEsParameters, swarms: Swarms, b: int, table: Table, work: Workspace) -> None:
    """Begin with a round distribution around a point from the source, which is not evaluated."""
    lower, upper, width = table.initial_lower, table.initial_upper, swarms.positions.shape[2]
    draw_newcomer(swarms.source[b], swarms.stream[b], table, work.noise, work.path, lower, upper)
    spread_out(swarms.field[b], swarms.registers[b], width, table.dimension, parameters.first_step)
    for k in range(width):
        swarms.field[b, layout(width).mean + k] = work.path[k + 1]
    swarms.registers[b, RESTARTS] += 1


@kernel
def re_evaluate(parameters: CmaEsParameters, swarms: Swarms, b: int, table: Table, work: Workspace) -> None:
    """Evaluate the members and the best so far again; forget the history of fitness."""
    loop.re_evaluate_population(parameters, swarms, b, table, work)
    swarms.registers[b, RECORDED] = swarms.registers[b, SINCE_BEST] = 0
    if swarms.registers[b, REASON] == STALLED:
        swarms.registers[b, REASON] = NO_REASON


class CmaEs(Optimizer):
    """CMA-ES with the tutorial's defaults; the population size is lambda, free in every generation."""

    name = "cma-es"
    parameter_class = CmaEsParameters
    smallest_population = 2
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[Floats]:
        """Return the positions, the best so far and the mean of the distribution."""
        first = layout(columns(dimension)).mean
        mean = swarms.field[row : row + 1, first : first + dimension]
        return [*Optimizer.decision_vectors(swarms, row, dimension), mean]

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """Return the number of counts; see `state`."""
        return NUM_COUNTS

    @staticmethod
    def field_size(tables: Tables) -> int:
        """Return the size of the state; see `state.Layout`."""
        return layout(tables.lower.shape[-1]).end

    @staticmethod
    def counts(swarms: Swarms) -> Mapping[str, NDArray[np.int64]]:
        """Return the number of restarts in this episode."""
        return {"restarts": swarms.registers[:, RESTARTS]}
