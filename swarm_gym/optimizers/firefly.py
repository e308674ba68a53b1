"""Firefly algorithm with sequential pair moves.

Sources: X.-S. Yang, "Firefly algorithms for multimodal optimization", SAGA 2009; in the form of the SPSFA
paper, Algorithm 1 and eq. 13-15. Every firefly looks at every other firefly in turn and moves at once towards
each one that is brighter *now*; it is repaired and evaluated after each move. One iteration of m fireflies
makes up to m (m - 1) moves, about half of that in practice.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, maximum, minimum, store, total
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, evaluate_path, is_spent
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]


class FireflyParameters(NamedTuple):
    """Parameters of the firefly algorithm."""

    noise: Annotated[
        float,
        Parameter(
            2.0, 0.0, 1e4, "alpha", "width of the uniform noise of a move, in map units", (0.02, 100.0)
        ),
    ]
    attractiveness: Annotated[
        float,
        Parameter(0.1, 0.0, 1.0, "beta0", "share of the distance to a neighbour at distance 0", (0.01, 1.0)),
    ]
    absorption: Annotated[
        float, Parameter(5e-6, 0.0, 1e3, "gamma", "decay of the attraction, per squared map unit")
    ]


@kernel(inline="late")
def squared_distance(path: Floats, position: Floats) -> float:
    """Return the squared distance between a path with its start, (C + 1,), and a position, (C,)."""
    squares = broadcast(0.0)
    for k in range(0, position.shape[0], NUM_LANES):
        difference = load(position, k) - load(path, k + 1)
        squares = squares + difference * difference
    return total(squares)


@kernel(inline="late")
def move_towards(parameters: FireflyParameters, table: Table, work: Workspace, brighter: Floats) -> None:
    """Move `work.path` towards a brighter position, (C,), with the noise in `work.noise`."""
    path = work.path
    decay = math.exp(-parameters.absorption * squared_distance(path, brighter))
    attraction = parameters.attractiveness * decay  # eq. 13, 14
    for k in range(0, brighter.shape[0], NUM_LANES):
        here = load(path, k + 1)
        noise = parameters.noise * (load(work.noise, k) - 0.5)
        moved = here + attraction * (load(brighter, k) - here) + noise  # eq. 15
        store(path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


@kernel
def iterate(
    parameters: FireflyParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration (Algorithm 1); end early if the evaluation budget is spent."""
    positions, fitness, collision = swarms.positions[b], swarms.fitness[b], swarms.collision[b]
    stream, size, columns = swarms.stream[b], swarms.size[b], positions.shape[1]
    for i in range(size):
        for k in range(columns):
            work.path[k + 1] = positions[i, k]
        for j in range(size):
            if fitness[j] < fitness[i]:
                if is_spent(swarms, b):
                    break
                fill_uniform(stream, work.noise)
                move_towards(parameters, table, work, positions[j])
                if repair_degree > 0.0:
                    repair(table, work.path, repair_degree)
                fitness[i], collision[i] = evaluate_path(swarms, b, table, work)
        for k in range(columns):
            positions[i, k] = work.path[k + 1]


class Firefly(Optimizer):
    """The firefly algorithm of the SPSFA paper, with the parameters printed there."""

    name = "firefly"
    parameter_class = FireflyParameters
    kernels = loop.Kernels(iterate)

    @classmethod
    def affordable_size(cls, evaluations: Floats) -> Floats:
        """Return the m with m (m - 1) / 2 = evaluations: about half of the pairs move."""
        return (1.0 + np.sqrt(1.0 + 8.0 * evaluations)) / 2.0
