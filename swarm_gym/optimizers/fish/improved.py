"""Improved artificial fish swarm algorithm: shrinking sight and steps, and everybody follows the best.

Source: the IAFSA paper, section 3 (see `fish`). The swarm begins with the better one of each member and its
opposite. A fish moves to what is better at once, by steps that its weight beta shortens, and leaps where it
finds nothing.

Eq. 15, 17 and 18 as printed draw every fish towards the zero vector, where three of the paper's five test
functions have their optimum. That is left out here; the parameter `origin_pull` = 1 puts it back. The other
readings are in docs/readings.md.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.fish.behaviour import (
    School,
    add_to_centre,
    count_companions,
    empty_centre,
    finish_centre,
    gather,
    go_astray,
    is_roomy,
    leap,
    look_at_centre,
    offer,
    settle,
    step_towards,
    try_out,
)
from swarm_gym.optimizers.fish.standard import CROWDING, STEP, TRIES, VISUAL
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, evaluate_path, is_spent
from swarm_gym.problem.tables import Table

Floats = NDArray[np.float64]


class ImprovedFishSwarmRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@kernel
def begin(
    rules: ImprovedFishSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    size: int,
    knobs: Floats,
) -> None:
    """Draw a population, then keep the better one of each member and its opposite (eq. 8 to 10)."""
    loop.draw_population(rules, swarms, b, table, work, size, knobs)
    width = swarms.positions.shape[2]
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        for k in range(width):
            opposite = table.initial_lower[k] + table.initial_upper[k] - swarms.positions[b, i, k]
            work.path[k + 1] = opposite
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
    """Member i goes to the first of a few points within a step that is better (eq. 15), or leaps."""
    for _ in range(school.tries):
        if is_spent(swarms, b):
            return
        go_astray(school, swarms, b, table, work, swarms.positions[b, i], school.step, kept)
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
    target: Floats,
    kept: float,
) -> None:
    """Member i steps towards a target if it gets better by that (eq. 17, 18), or preys."""
    if is_spent(swarms, b):
        return
    fitness, collision = step_towards(school, swarms, b, i, table, work, target, kept)
    if fitness < swarms.fitness[b, i]:
        offer(school, work, fitness, collision)
    else:
        prey(school, swarms, b, i, table, work, kept)


@kernel(borrows=True)
def take_turns(school: School, swarms: Swarms, b: int, table: Table, work: Workspace, kept: float) -> None:
    """Every fish of swarm `b` takes its turn, while the evaluation budget lasts."""
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
    rules: ImprovedFishSwarmRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`."""
    progress = swarms.iteration[b] / swarms.iterations[b]
    visual = knobs[0] * math.exp(-25.0 * progress**3) + knobs[2]  # eq. 11
    step = knobs[1] * math.exp(-math.pi * progress**2) + knobs[3]  # eq. 12, 13
    beta = knobs[4] - (knobs[4] - knobs[5]) * progress  # eq. 14
    kept = 1.0 - knobs[8] * beta
    school = gather(table, visual, beta * step, knobs[6], knobs[7], repair_degree)
    take_turns(school, swarms, b, table, work, kept)


SMALLEST_VISUAL = Knob(0.01, 0.0, 1.0, "Visual_min", "least distance that a fish sees, in ranges")
SMALLEST_STEP = Knob(0.01, 0.0, 1.0, "Step_min", "least length of the longest step, in ranges")


class ImprovedFishSwarm(Optimizer):
    """IAFSA of its paper, with the parameters printed there, corrected."""

    name = "improved-fish-swarm"
    knobs: ClassVar[dict[str, Knob]] = {
        "visual": VISUAL,
        "step": STEP,
        "smallest_visual": SMALLEST_VISUAL,
        "smallest_step": SMALLEST_STEP,
        "first_beta": Knob(
            0.9, 0.0, 1.0, "beta_start", "share of a step that is made in the first iteration"
        ),
        "last_beta": Knob(0.2, 0.0, 1.0, "beta_end", "the same in the last one; linear between them"),
        "crowding": CROWDING,
        "tries": TRIES,
        "origin_pull": Knob(
            0.0, 0.0, 1.0, "–", "share of beta by which a move shrinks the position; 1 is as printed"
        ),
    }
    rules = ImprovedFishSwarmRules
    kernels = loop.Kernels(iterate, begin)

    @staticmethod
    def affordable_size(evaluations: Floats) -> Floats:
        """With five tries a fish takes about eight evaluations."""
        return evaluations / 8.0
