"""Particle swarm optimization with a linearly decreasing inertia weight.

Source: Y. Shi, R. Eberhart, "A modified particle swarm optimizer", IEEE ICEC 1998; with the parameters that
the MOA paper prints (Li et al., Acta Electronica Sinica 44(9), 2016). The limit of the velocity, its first
values and what happens at the bounds are not printed: readings, see docs/readings.md.
"""

from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, evaluate_member, is_spent, re_evaluate_members, recall
from swarm_gym.problem.layout import columns
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]


class ParticleSwarmRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`.

    The memory of a member is its velocity, (C,), its best position, (C,), and the fitness of that.
    """


@kernel
def settle(swarms: Swarms, b: int, first: int) -> None:
    """Let the members from `first` on begin where they are, at rest."""
    width = swarms.positions.shape[2]
    for i in range(first, swarms.size[b]):
        for k in range(width):
            swarms.memory[b, i, k] = 0.0
            swarms.memory[b, i, width + k] = swarms.positions[b, i, k]
        swarms.memory[b, i, 2 * width] = swarms.fitness[b, i]


@kernel
def begin(
    rules: ParticleSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
    knobs: Floats,
) -> None:
    """Draw positions in the initial bounds, then velocities up to their limit."""
    loop.draw_population(rules, swarms, b, table, work, size, knobs)
    settle(swarms, b, 0)
    for i in range(swarms.size[b]):
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(swarms.positions.shape[2]):
            extent = table.upper[k] - table.lower[k]
            swarms.memory[b, i, k] = knobs[4] * extent * (2.0 * work.noise[k] - 1.0)


@kernel
def adopt(
    rules: ParticleSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Begin with given positions, at rest."""
    loop.adopt_population(rules, swarms, b, table, work, size)
    settle(swarms, b, 0)


@kernel
def change_size(
    rules: ParticleSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Grow or shrink swarm `b`; new members begin at rest."""
    kept = min(size, swarms.size[b])
    loop.resize_population(rules, swarms, b, table, work, size)
    settle(swarms, b, kept)


@kernel
def iterate(
    rules: ParticleSwarmRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`: all move by what was known when it began."""
    cognitive, social, limit = knobs[2], knobs[3], knobs[4]
    progress = swarms.iteration[b] / max(swarms.iterations[b] - 1, 1)
    inertia = knobs[0] + (knobs[1] - knobs[0]) * progress
    width, path = swarms.positions.shape[2], work.path
    swarm_best, own_share = swarms.best_position[b].copy(), np.empty(width)
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        position, memory = swarms.positions[b, i], swarms.memory[b, i]
        fill_uniform(swarms.stream[b], own_share)
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(width):
            fastest = limit * (table.upper[k] - table.lower[k])
            velocity = (
                inertia * memory[k]
                + cognitive * own_share[k] * (memory[width + k] - position[k])
                + social * work.noise[k] * (swarm_best[k] - position[k])
            )
            velocity = min(max(velocity, -fastest), fastest)
            wanted = position[k] + velocity
            reached = min(max(wanted, table.lower[k]), table.upper[k])
            memory[k] = velocity if reached == wanted else 0.0
            path[k + 1] = reached
        if repair_degree > 0.0:
            repair(table, path, repair_degree)
        evaluate_member(swarms, b, i, table, work)
        if swarms.fitness[b, i] < memory[2 * width]:
            for k in range(width):
                memory[width + k] = path[k + 1]
            memory[2 * width] = swarms.fitness[b, i]


@kernel
def re_evaluate(
    rules: ParticleSwarmRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
) -> None:
    """Evaluate anew where the particles are, then where each was best; the better one is its best now."""
    width, best = swarms.positions.shape[2], swarms.best_position[b].copy()
    re_evaluate_members(swarms, b, table, work)
    for i in range(swarms.size[b]):
        memory = swarms.memory[b, i]
        memory[2 * width] = recall(swarms, b, table, work, memory[width : 2 * width])
        if swarms.fitness[b, i] < memory[2 * width]:
            for k in range(width):
                memory[width + k] = swarms.positions[b, i, k]
            memory[2 * width] = swarms.fitness[b, i]
    recall(swarms, b, table, work, best)


class ParticleSwarm(Optimizer):
    """PSO-w of the MOA paper, with the parameters printed there."""

    name = "particle-swarm"
    knobs: ClassVar[dict[str, Knob]] = {
        "first_inertia": Knob(1.4, 0.0, 2.0, "w", "weight of the velocity in the first iteration"),
        "last_inertia": Knob(0.5, 0.0, 2.0, "w", "the same in the last one; linear between them"),
        "cognitive": Knob(1.49445, 0.0, 4.0, "c1", "pull of a particle's own best position", (0.01, 4.0)),
        "social": Knob(1.49445, 0.0, 4.0, "c2", "pull of the swarm's best position", (0.01, 4.0)),
        "velocity_limit": Knob(
            0.2, 0.0, 1.0, "vmax", "largest change of a component, in ranges", (0.001, 1.0)
        ),
    }
    rules = ParticleSwarmRules
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[Floats]:
        """Where the particles are, the best so far, and where each was best."""
        width, size = columns(dimension), swarms.size[row]
        own_bests = swarms.memory[row, :size, width : width + dimension]
        return [*Optimizer.decision_vectors(swarms, row, dimension), own_bests]

    @staticmethod
    def memory_columns(dimension: int) -> int:
        """Velocity, best position, and its fitness."""
        return 2 * columns(dimension) + 1
