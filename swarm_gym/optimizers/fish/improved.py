"""Improved artificial fish swarm algorithm: sight and steps shrink, and every fish follows the best so far.

Source: the IAFSA paper, section 3 (see `behaviour`). The swarm begins with the better one of each member and
its opposite. A fish moves to a better point at once, by steps that its weight beta shortens, and leaps if it
finds none.

Eq. 15, 17 and 18 as printed draw every fish towards the zero vector, where three of the five test functions
of the IAFSA paper have their optimum. That is left out here; the parameter `origin_pull` = 1 puts it back.
The other readings are in docs/readings.md.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.fish.behaviour import (
    Crowding,
    School,
    SmallestStep,
    SmallestVisual,
    Step,
    Tries,
    Visual,
    add_to_centre,
    count_companions,
    empty_centre,
    finish_centre,
    gather,
    is_roomy,
    leap,
    look_at_centre,
    move_randomly,
    offer,
    settle,
    step_towards,
    try_out,
)
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, evaluate_path, is_spent
from swarm_gym.problem.tables import Table


class ImprovedFishSwarmParameters(NamedTuple):
    """Parameters of the improved fish swarm."""

    visual: Visual
    step: Step
    smallest_visual: SmallestVisual
    smallest_step: SmallestStep
    first_beta: Annotated[
        float, Parameter(0.9, 0.0, 1.0, "beta_start", "share of a step that is made in the first iteration")
    ]
    last_beta: Annotated[
        float,
        Parameter(
            0.2,
            0.0,
            1.0,
            "beta_end",
            "share of a step that is made in the last iteration; linear in between",
        ),
    ]
    crowding: Crowding
    tries: Tries
    origin_pull: Annotated[
        float,
        Parameter(0.0, 0.0, 1.0, "–", "share of beta by which a move shrinks the position; 1 is as printed"),
    ]


@kernel
def begin(
    parameters: ImprovedFishSwarmParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
) -> None:
    """Draw a population, then keep the better one of each member and its opposite (eq. 8 to 10).

    A smooth member may lie outside the initial bounds. Its opposite may then leave the workspace, and is put
    on the bounds.
    """
    loop.draw_population(parameters, swarms, b, table, work, size)
    width = swarms.positions.shape[2]
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        for k in range(width):
            opposite = table.initial_lower[k] + table.initial_upper[k] - swarms.positions[b, i, k]
            work.path[k + 1] = min(max(opposite, table.lower[k]), table.upper[k])
        fitness, collision = evaluate_path(swarms, b, table, work)
        if fitness < swarms.fitness[b, i]:
            swarms.fitness[b, i], swarms.collision[b, i] = fitness, collision
            for k in range(width):
                swarms.positions[b, i, k] = work.path[k + 1]


@kernel(borrows=True)
def prey(
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    kept: float,
) -> None:
    """Let member i move to the first better one of a few points within a step (eq. 15), or leap."""
    for _ in range(school.tries):
        if is_spent(swarms, b):
            return
        move_randomly(school, swarms, b, table, work, swarms.positions[b, i], school.step, kept)
        fitness, collision = try_out(school, swarms, b, table, work)
        if fitness < swarms.fitness[b, i]:
            offer(school, work, fitness, collision)
            return
    leap(school, swarms, b, i, table, work)


@kernel(borrows=True)
def advance(
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    target: NDArray[np.float64],
    kept: float,
) -> None:
    """Let member i step towards a target if that makes it better (eq. 17, 18), or prey."""
    if is_spent(swarms, b):
        return
    fitness, collision = step_towards(school, swarms, b, i, table, work, target, kept)
    if fitness < swarms.fitness[b, i]:
        offer(school, work, fitness, collision)
    else:
        prey(school, swarms, b, i, table, work, kept)


@kernel(borrows=True)
def take_turns(school: School, swarms: Swarms, b: int, table: Table, work: Workspace, kept: float) -> None:
    """Let every fish of swarm `b` take its turn, while the evaluation budget lasts."""
    if is_spent(swarms, b):
        return
    size = swarms.size[b]
    empty_centre(school)
    for i in range(size):
        add_to_centre(school, swarms.positions[b, i])
    finish_centre(school, size)
    centre_fitness = look_at_centre(school, swarms, b, table, work)
    room_at_centre = is_roomy(school, swarms, b, count_companions(school, swarms, b, school.centre))
    for i in range(size):
        if is_spent(swarms, b):
            break
        if room_at_centre and centre_fitness < swarms.fitness[b, i]:
            advance(school, swarms, b, i, table, work, school.centre, kept)
        else:
            prey(school, swarms, b, i, table, work, kept)
        advance(school, swarms, b, i, table, work, swarms.best_position[b], kept)
        settle(school, swarms, b, i)


@kernel
def iterate(
    parameters: ImprovedFishSwarmParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration."""
    progress = swarms.iteration[b] / swarms.iterations[b]
    first, last = parameters.first_beta, parameters.last_beta
    visual = parameters.visual * math.exp(-25.0 * progress**3) + parameters.smallest_visual  # eq. 11
    step = parameters.step * math.exp(-math.pi * progress**2) + parameters.smallest_step  # eq. 12, 13
    beta = first - (first - last) * progress  # eq. 14
    kept = 1.0 - parameters.origin_pull * beta
    school = gather(parameters, table, visual, beta * step, parameters.tries, repair_degree)
    take_turns(school, swarms, b, table, work, kept)


class ImprovedFishSwarm(Optimizer):
    """The corrected IAFSA, with the parameters printed in the IAFSA paper."""

    name = "improved-fish-swarm"
    parameter_class = ImprovedFishSwarmParameters
    evaluations_per_member = 8.0  # with five tries
    kernels = loop.Kernels(iterate, begin)
