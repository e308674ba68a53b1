"""Firefly algorithm with sequential pair moves.

Sources: X.-S. Yang, "Firefly algorithms for multimodal optimization", SAGA 2009; in the form of the SPSFA
paper, Algorithm 1 and eq. 13-15. Every firefly looks at every other in turn and moves at once towards each
that is brighter *now*; it is repaired and evaluated after each move. One iteration of m fireflies makes up to
m (m - 1) moves, about half of that in practice.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, maximum, minimum, store, total
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import (
    Swarms,
    Workspace,
    evaluate_path,
    is_spent,
)
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


@kernel(inline="late")
def squared_distance(path: Floats, position: Floats) -> float:
    """Squared distance of a path with its start, shape (C + 1,), from a position, shape (C,)."""
    squares = broadcast(0.0)
    for k in range(0, position.shape[0], NUM_LANES):
        difference = load(position, k) - load(path, k + 1)
        squares = squares + difference * difference
    return total(squares)


@kernel(inline="late")
def move_towards(
    table: Table,
    work: Workspace,
    brighter: Floats,
    alpha: float,
    beta0: float,
    gamma: float,
) -> None:
    """Move `work.path` towards a brighter position, shape (C,), with the noise in `work.noise`."""
    path = work.path
    attraction = beta0 * math.exp(-gamma * squared_distance(path, brighter))  # eq. 13, 14
    for k in range(0, brighter.shape[0], NUM_LANES):
        here = load(path, k + 1)
        noise = alpha * (load(work.noise, k) - 0.5)
        moved = here + attraction * (load(brighter, k) - here) + noise  # eq. 15
        store(path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


class FireflyRules(NamedTuple):
    """Chooses the kernels of this optimizer; see `driver`."""


@kernel
def iterate(
    rules: FireflyRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b` (Algorithm 1); ends early where the evaluation budget is spent."""
    alpha, beta0, gamma = knobs[0], knobs[1], knobs[2]
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
                move_towards(table, work, positions[j], alpha, beta0, gamma)
                if repair_degree > 0.0:
                    repair(table, work.path, repair_degree)
                fitness[i], collision[i] = evaluate_path(swarms, b, table, work)
        for k in range(columns):
            positions[i, k] = work.path[k + 1]


class Firefly(Optimizer):
    """The firefly algorithm of the SPSFA paper, with the parameters printed there."""

    name = "firefly"
    rules = FireflyRules
    kernels = loop.Kernels(iterate)
    knobs: ClassVar[dict[str, Knob]] = {
        "noise": Knob(
            2.0, 0.0, 1e4, "alpha", "width of the uniform noise of a move, in map units", (0.02, 100.0)
        ),
        "attractiveness": Knob(
            0.1, 0.0, 1.0, "beta0", "share of the way to a neighbour at distance 0", (0.01, 1.0)
        ),
        "absorption": Knob(5e-6, 0.0, 1e3, "gamma", "decay of the attraction, per squared map unit"),
    }

    @staticmethod
    def affordable_size(evaluations: Floats) -> Floats:
        """The m with m (m - 1) / 2 = evaluations: about half of the pairs move."""
        return (1.0 + np.sqrt(1.0 + 8.0 * evaluations)) / 2.0
