"""Hybrid adaptive artificial fish swarm algorithm, HAAFSA-R: a reconstruction.

The source, Yao and Ren in TELKOMNIKA Indonesian Journal of Electrical Engineering 12(10), 2014,
doi 10.11591/telkomnika.v12i8.5247, was at hand as an abstract only: an artificial fish swarm with an
adaptive, enhanced prey behaviour, and with sight and step that change by segments of the run. How they do is
our own here; nothing is claimed of the original.

For the first third of the iterations sight and step are what they are in AFSA, in the second they shrink
linearly to a quarter, in the last exponentially. A fish preys in up to three rounds, each from the best point
of the one before, of more and more points the later it is.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.fish.behaviour import (
    School,
    approach,
    draw,
    gather,
    go_astray,
    go_to,
    leap,
    offer,
    take_down,
    try_out,
)
from swarm_gym.optimizers.fish.improved import SMALLEST_STEP, SMALLEST_VISUAL
from swarm_gym.optimizers.fish.standard import CROWDING, PREY, STEP, TRIES, VISUAL, take_turns
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, copy_position, is_spent
from swarm_gym.problem.tables import Table

Floats = NDArray[np.float64]

ROUNDS = 3


class HybridFishSwarmRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@kernel(borrows=True)
def prey(
    rules: HybridFishSwarmRules,  # noqa: ARG001
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
) -> None:
    """Member i goes from one better point to the next; without one towards the best so far, or it leaps."""
    here, best = school.start, school.seen
    copy_position(swarms.positions[b, i], here)
    fitness, collision = swarms.fitness[b, i], swarms.collision[b, i]
    for _ in range(ROUNDS):
        found, found_collision = math.inf, math.inf
        for _ in range(school.tries):
            if is_spent(swarms, b):
                break
            go_astray(school, swarms, b, table, work, here, school.visual)
            tried, tried_collision = try_out(school, swarms, b, table, work)
            if tried < found:
                found, found_collision = tried, tried_collision
                take_down(work, best)
        if found >= fitness:
            break
        fitness, collision = found, found_collision
        copy_position(best, here)
    if fitness < swarms.fitness[b, i]:
        go_to(work, here)
        offer(school, work, fitness, collision)
    elif not is_spent(swarms, b):
        if draw(swarms, b, work) < 0.5:
            approach(school, swarms, b, i, table, work, swarms.best_position[b])
        else:
            leap(school, swarms, b, i, table, work)


PREY[HybridFishSwarmRules] = prey


@kernel(borrows=True)
def share_left(progress: float) -> float:
    """The share of sight and step that is left at a share of the iterations."""
    if progress < 1.0 / 3.0:
        return 1.0
    if progress < 2.0 / 3.0:
        return 1.0 - 0.75 * (3.0 * progress - 1.0)
    return 0.25 * math.exp(-5.0 * (3.0 * progress - 2.0))


@kernel
def iterate(
    rules: HybridFishSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`."""
    progress = swarms.iteration[b] / swarms.iterations[b]
    visual, step = share_left(progress) * knobs[0], share_left(progress) * knobs[1]
    if progress >= 2.0 / 3.0:
        visual, step = max(visual, knobs[2]), max(step, knobs[3])
    tries = int(knobs[5]) * (1 + int(3.0 * progress))
    school = gather(table, visual, step, knobs[4], tries, repair_degree)
    take_turns(rules, school, swarms, b, table, work)


class HybridFishSwarm(Optimizer):
    """HAAFSA-R: a reconstruction, of which nothing is claimed for the original."""

    name = "hybrid-fish-swarm"
    knobs: ClassVar[dict[str, Knob]] = {
        "visual": VISUAL,
        "step": STEP,
        "smallest_visual": SMALLEST_VISUAL,
        "smallest_step": SMALLEST_STEP,
        "crowding": CROWDING,
        "tries": TRIES,
    }
    rules = HybridFishSwarmRules
    kernels = loop.Kernels(iterate)

    @staticmethod
    def affordable_size(evaluations: Floats) -> Floats:
        """With five tries a fish takes about 25 evaluations."""
        return evaluations / 25.0
