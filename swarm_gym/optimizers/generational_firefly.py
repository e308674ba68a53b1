"""Firefly algorithm with synchronous moves: one evaluation per firefly and iteration.

Sources: X.-S. Yang, "Firefly algorithms for multimodal optimization", SAGA 2009; in the form and with the
parameters that the MOA paper compares with (Li et al., Acta Electronica Sinica 44(9), 2016). Every firefly
moves towards each firefly that was brighter at the beginning of the iteration, and to its position at that
time. Distances are in map units and noise in units of the range of each component, a reading
(docs/readings.md): with the printed gamma = 1 per squared cell there is almost no attraction, and that
reproduces the results of the MOA paper.
"""

import math
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


class GenerationalFireflyParameters(NamedTuple):
    """Parameters of the generational firefly algorithm."""

    noise: Annotated[
        float,
        Parameter(0.2, 0.0, 10.0, "alpha", "width of the uniform noise of a move, in ranges", (0.001, 1.0)),
    ]
    attractiveness: Annotated[
        float,
        Parameter(1.0, 0.0, 1.0, "beta0", "share of the distance to a neighbour at distance 0", (0.01, 1.0)),
    ]
    absorption: Annotated[
        float, Parameter(1.0, 0.0, 1e9, "gamma", "decay of the attraction, per squared map unit")
    ]
    least_attractiveness: Annotated[
        float,
        Parameter(
            0.0,
            0.0,
            1.0,
            "beta_min",
            "share of the distance to a neighbour far away; 0.2 in Yang's own code",
        ),
    ]


@kernel
def iterate(
    parameters: GenerationalFireflyParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration; a firefly without a brighter one does not move."""
    size, columns, path = swarms.size[b], swarms.positions.shape[2], work.path
    before, fitness = swarms.positions[b, :size].copy(), swarms.fitness[b, :size].copy()
    brightest = fitness.min()
    for i in range(size):
        if is_spent(swarms, b):
            break
        for k in range(columns):
            path[k + 1] = before[i, k]
        for j in range(size):
            if fitness[j] < fitness[i]:
                fill_uniform(swarms.stream[b], work.noise)
                _approach(parameters, table, work, before[j])
        for k in range(columns):
            path[k + 1] = min(max(path[k + 1], table.lower[k]), table.upper[k])
        if repair_degree > 0.0 and fitness[i] > brightest:
            repair(table, path, repair_degree)
        evaluate_member(swarms, b, i, table, work)


@kernel
def _approach(
    parameters: GenerationalFireflyParameters, table: Table, work: Workspace, brighter: Floats
) -> None:
    """Move `work.path` towards a brighter position, (C,), with the noise in `work.noise`."""
    path, square = work.path, 0.0
    for k in range(brighter.shape[0]):
        difference = brighter[k] - path[k + 1]
        square += difference * difference
    least = parameters.least_attractiveness
    attraction = least + (parameters.attractiveness - least) * math.exp(-parameters.absorption * square)
    for k in range(brighter.shape[0]):
        noise = parameters.noise * (table.upper[k] - table.lower[k]) * (work.noise[k] - 0.5)
        path[k + 1] += attraction * (brighter[k] - path[k + 1]) + noise


class GenerationalFirefly(Optimizer):
    """The firefly algorithm of the MOA paper, with the parameters printed there."""

    name = "generational-firefly"
    parameter_class = GenerationalFireflyParameters
    kernels = loop.Kernels(iterate)
