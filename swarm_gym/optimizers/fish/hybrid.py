"""Hybrid adaptive artificial fish swarm algorithm, HAAFSA-R: a reconstruction.

The source, Yao and Ren in TELKOMNIKA Indonesian Journal of Electrical Engineering 12(10), 2014,
doi 10.11591/telkomnika.v12i8.5247, was available as an abstract only: an artificial fish swarm with an
adaptive, enhanced prey behaviour, and with sight and step that change by segments of the run. The rules of
these changes are our own; nothing is claimed about the original.

In the first third of the iterations sight and step are as in AFSA. They shrink linearly to a quarter in
the second third, and exponentially in the last. A fish preys in up to three rounds, each from the best point
of the round before. Each third of the iterations adds as many tries as the first one has.
"""

import math
from typing import NamedTuple

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
    approach,
    copy_path,
    draw,
    gather,
    leap,
    move_randomly,
    move_to,
    offer,
    try_out,
)
from swarm_gym.optimizers.fish.standard import PREY, take_turns
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import Swarms, Workspace, copy_position, is_spent
from swarm_gym.problem.tables import Table

ROUNDS = 3  # in which a fish preys at most


class HybridFishSwarmParameters(NamedTuple):
    """Parameters of the hybrid fish swarm."""

    visual: Visual
    step: Step
    smallest_visual: SmallestVisual
    smallest_step: SmallestStep
    crowding: Crowding
    tries: Tries


@kernel(borrows=True)
def prey(
    _parameters: HybridFishSwarmParameters,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
) -> None:
    """Let member i move from one better point to the next; without any, towards the best so far, or leap."""
    here, best = school.start, school.seen
    copy_position(swarms.positions[b, i], here)
    fitness, collision = swarms.fitness[b, i], swarms.collision[b, i]
    for _ in range(ROUNDS):
        found, found_collision = math.inf, math.inf
        for _ in range(school.tries):
            if is_spent(swarms, b):
                break
            move_randomly(school, swarms, b, table, work, here, school.visual)
            tried, tried_collision = try_out(school, swarms, b, table, work)
            if tried < found:
                found, found_collision = tried, tried_collision
                copy_path(work, best)
        if found >= fitness:
            break
        fitness, collision = found, found_collision
        copy_position(best, here)
    if fitness < swarms.fitness[b, i]:
        move_to(work, here)
        offer(school, work, fitness, collision)
    elif not is_spent(swarms, b):
        if draw(swarms, b, work) < 0.5:
            approach(school, swarms, b, i, table, work, swarms.best_position[b])
        else:
            leap(school, swarms, b, i, table, work)


PREY[HybridFishSwarmParameters] = prey


@kernel(borrows=True)
def share_left(progress: float) -> float:
    """Return the share of sight and step that is left after a share of the iterations."""
    if progress < 1.0 / 3.0:
        return 1.0
    if progress < 2.0 / 3.0:
        return 1.0 - 0.75 * (3.0 * progress - 1.0)
    return 0.25 * math.exp(-5.0 * (3.0 * progress - 2.0))


@kernel
def iterate(
    parameters: HybridFishSwarmParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration."""
    progress = swarms.iteration[b] / swarms.iterations[b]
    visual, step = share_left(progress) * parameters.visual, share_left(progress) * parameters.step
    if progress >= 2.0 / 3.0:
        visual, step = max(visual, parameters.smallest_visual), max(step, parameters.smallest_step)
    tries = int(parameters.tries) * (1 + int(3.0 * progress))
    school = gather(parameters, table, visual, step, tries, repair_degree)
    take_turns(parameters, school, swarms, b, table, work)


class HybridFishSwarm(Optimizer):
    """HAAFSA-R, a reconstruction; nothing is claimed about the original algorithm."""

    name = "hybrid-fish-swarm"
    parameter_class = HybridFishSwarmParameters
    evaluations_per_member = 25.0  # with five tries
    kernels = loop.Kernels(iterate)
