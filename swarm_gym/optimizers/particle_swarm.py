"""Particle swarm optimization with a linearly decreasing inertia weight.

Source: Y. Shi, R. Eberhart, "A modified particle swarm optimizer", IEEE ICEC 1998; with the parameters that
the MOA paper prints (Li et al., Acta Electronica Sinica 44(9), 2016). The limit of the velocity, its first
values and the behaviour at the bounds are not printed: they are readings, see docs/readings.md.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, evaluate_member, is_spent, re_evaluate_members, recall
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, repair

Floats = NDArray[np.float64]


class ParticleSwarmParameters(NamedTuple):
    """Parameters of the particle swarm."""

    first_inertia: Annotated[
        float, Parameter(1.4, 0.0, 2.0, "w", "weight of the velocity in the first iteration")
    ]
    last_inertia: Annotated[
        float,
        Parameter(0.5, 0.0, 2.0, "w", "weight of the velocity in the last iteration; linear in between"),
    ]
    inertia_factor: Annotated[
        float, Parameter(1.0, 0.0, 4.0, "–", "factor of the weight of the velocity", (0.1, 2.0))
    ]
    cognitive: Annotated[
        float, Parameter(1.49445, 0.0, 4.0, "c1", "pull of a particle's own best position", (0.01, 4.0))
    ]
    social: Annotated[
        float, Parameter(1.49445, 0.0, 4.0, "c2", "pull of the swarm's best position", (0.01, 4.0))
    ]
    velocity_limit: Annotated[
        float, Parameter(0.2, 0.0, 1.0, "vmax", "largest change of a component, in ranges", (0.001, 1.0))
    ]


class Particle(NamedTuple):
    """The first columns of what `Swarms.memory` holds of a particle."""

    velocity: int  # C columns
    best_position: int  # C columns: best position of this particle so far
    best_fitness: int  # fitness of that position


@kernel(inline="late")
def particle_columns(width: int) -> Particle:
    """Return the columns for positions of C = `width` columns."""
    return Particle(0, width, 2 * width)


@kernel
def settle(swarms: Swarms, b: int, first: int) -> None:
    """Let the members from `first` on begin at rest; their best positions are the present ones."""
    width = swarms.positions.shape[2]
    at = particle_columns(width)
    for i in range(first, swarms.size[b]):
        for k in range(width):
            swarms.memory[b, i, at.velocity + k] = 0.0
        remember(swarms, b, i)


@kernel(inline="late")
def remember(swarms: Swarms, b: int, i: int) -> None:
    """Let the present position of member i be its best one."""
    width = swarms.positions.shape[2]
    at = particle_columns(width)
    for k in range(width):
        swarms.memory[b, i, at.best_position + k] = swarms.positions[b, i, k]
    swarms.memory[b, i, at.best_fitness] = swarms.fitness[b, i]


@kernel
def begin(
    parameters: ParticleSwarmParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Draw positions in the initial bounds, then velocities up to their limit."""
    loop.draw_population(parameters, swarms, b, table, work, size)
    settle(swarms, b, 0)
    width = swarms.positions.shape[2]
    at = particle_columns(width)
    for i in range(swarms.size[b]):
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(width):
            fastest = parameters.velocity_limit * (table.upper[k] - table.lower[k])
            swarms.memory[b, i, at.velocity + k] = fastest * (2.0 * work.noise[k] - 1.0)


@kernel
def adopt(
    parameters: ParticleSwarmParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Begin with given positions, at rest."""
    loop.adopt_population(parameters, swarms, b, table, work, size)
    settle(swarms, b, 0)


@kernel
def change_size(
    parameters: ParticleSwarmParameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Grow or shrink swarm `b`; new members begin at rest."""
    kept = min(size, swarms.size[b])
    loop.resize_population(parameters, swarms, b, table, work, size)
    settle(swarms, b, kept)


@kernel
def iterate(
    parameters: ParticleSwarmParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration, with the best position of the swarm from the iteration before."""
    progress = swarms.iteration[b] / max(swarms.iterations[b] - 1, 1)
    inertia = parameters.first_inertia + (parameters.last_inertia - parameters.first_inertia) * progress
    inertia *= parameters.inertia_factor
    width, path = swarms.positions.shape[2], work.path
    at = particle_columns(width)
    swarm_best, own_share = swarms.best_position[b].copy(), np.empty(width)
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        position, memory = swarms.positions[b, i], swarms.memory[b, i]
        fill_uniform(swarms.stream[b], own_share)
        fill_uniform(swarms.stream[b], work.noise)
        for k in range(width):
            fastest = parameters.velocity_limit * (table.upper[k] - table.lower[k])
            velocity = (
                inertia * memory[at.velocity + k]
                + parameters.cognitive * own_share[k] * (memory[at.best_position + k] - position[k])
                + parameters.social * work.noise[k] * (swarm_best[k] - position[k])
            )
            velocity = min(max(velocity, -fastest), fastest)
            wanted = position[k] + velocity
            reached = min(max(wanted, table.lower[k]), table.upper[k])
            memory[at.velocity + k] = velocity if reached == wanted else 0.0
            path[k + 1] = reached
        if repair_degree > 0.0:
            repair(table, path, repair_degree)
        evaluate_member(swarms, b, i, table, work)
        if swarms.fitness[b, i] < memory[at.best_fitness]:
            remember(swarms, b, i)


@kernel
def re_evaluate(
    _parameters: ParticleSwarmParameters, swarms: Swarms, b: int, table: Table, work: Workspace
) -> None:
    """Evaluate the positions again, then the best position of each particle; the better one is kept."""
    width, best = swarms.positions.shape[2], swarms.best_position[b].copy()
    at = particle_columns(width)
    re_evaluate_members(swarms, b, table, work)
    for i in range(swarms.size[b]):
        memory = swarms.memory[b, i]
        own_best = memory[at.best_position : at.best_position + width]
        memory[at.best_fitness] = recall(swarms, b, table, work, own_best)
        if swarms.fitness[b, i] < memory[at.best_fitness]:
            remember(swarms, b, i)
    recall(swarms, b, table, work, best)


class ParticleSwarm(Optimizer):
    """PSO-w of the MOA paper, with the parameters printed there."""

    name = "particle-swarm"
    parameter_class = ParticleSwarmParameters
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[Floats]:
        """Return the positions, the best so far, and the best position of each particle."""
        first = particle_columns(columns(dimension)).best_position
        own_bests = swarms.memory[row, : swarms.size[row], first : first + dimension]
        return [*Optimizer.decision_vectors(swarms, row, dimension), own_bests]

    @staticmethod
    def memory_columns(dimension: int) -> int:
        """Return the number of columns of a velocity, a best position and its fitness; see `Particle`."""
        return particle_columns(columns(dimension)).best_fitness + 1
