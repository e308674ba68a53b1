"""Artificial fish swarm algorithm: fish that swarm, follow, prey and leap.

Source: X. Li, Z. Shao, J. Qian, "An optimizing method based on autonomous animats: fish-swarm algorithm",
Systems Engineering Theory and Practice, 2002; in the form and with the parameters of the IAFSA paper,
section 2 (see `behaviour`). Fish take their turns one after the other. In its turn a fish swarms and follows.
It preys instead of either if there is no companion, no better point or no room. A turn takes between 2 and
2 (tries + 1) + 1 evaluations. Readings are in docs/readings.md.
"""

from collections.abc import Callable
from typing import NamedTuple

from swarm_gym.compiler.jit import kernel, kernel_by_class
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.fish.behaviour import (
    Crowding,
    School,
    Step,
    Tries,
    Visual,
    add_to_centre,
    approach,
    are_companions,
    copy_path,
    count_companions,
    empty_centre,
    finish_centre,
    gather,
    is_roomy,
    leap,
    look_at,
    look_at_centre,
    move_randomly,
    settle,
)
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameters
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import Table


class FishSwarmParameters(NamedTuple):
    """Parameters of the standard fish swarm."""

    visual: Visual
    step: Step
    crowding: Crowding
    tries: Tries


@kernel(borrows=True)
def prey(
    _parameters: FishSwarmParameters,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
) -> None:
    """Let member i step towards the first better one of a few points in sight, or leap (eq. 2, 3)."""
    for _ in range(school.tries):
        if is_spent(swarms, b):
            return
        move_randomly(school, swarms, b, table, work, swarms.positions[b, i], school.visual)
        if look_at(swarms, b, table, work) < swarms.fitness[b, i]:
            copy_path(work, school.seen)
            approach(school, swarms, b, i, table, work, school.seen)
            return
    leap(school, swarms, b, i, table, work)


# How a fish preys, by the class of its parameters: the only difference between the optimizers listed here.
PREY: dict[type, Callable[..., None]] = {FishSwarmParameters: prey}
prey_by_class = kernel_by_class(PREY)


@kernel(borrows=True)
def take_turns(
    parameters: Parameters, school: School, swarms: Swarms, b: int, table: Table, work: Workspace
) -> None:
    """Let every fish of swarm `b` take its turn, while the evaluation budget lasts."""
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        count, best = look_around(school, swarms, b, i)
        swarm(parameters, school, swarms, b, i, table, work, count)
        follow(parameters, school, swarms, b, i, table, work, best)
        settle(school, swarms, b, i)


@kernel(borrows=True)
def look_around(school: School, swarms: Swarms, b: int, i: int) -> tuple[int, int]:
    """Return the number of companions of member i and the best of them; their mean becomes the centre."""
    count, best = 0, -1
    empty_centre(school)
    for k in range(swarms.size[b]):
        if are_companions(school, swarms.positions[b, i], swarms.positions[b, k]):
            count += 1
            add_to_centre(school, swarms.positions[b, k])
            if best < 0 or swarms.fitness[b, k] < swarms.fitness[b, best]:
                best = k
    if count > 0:
        finish_centre(school, count)
    return count, best


@kernel(borrows=True)
def swarm(
    parameters: Parameters,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    count: int,
) -> None:
    """Let member i step towards the centre of its companions if that is better and not crowded (eq. 4, 5)."""
    if count > 0:
        is_better = look_at_centre(school, swarms, b, table, work) < swarms.fitness[b, i]
        if is_better and is_roomy(school, swarms, b, count):
            approach(school, swarms, b, i, table, work, school.centre)
            return
    prey_by_class(parameters, school, swarms, b, i, table, work)


@kernel(borrows=True)
def follow(
    parameters: Parameters,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    best: int,
) -> None:
    """Let member i step towards its best companion if that is better and not crowded (eq. 6, 7)."""
    if best >= 0 and swarms.fitness[b, best] < swarms.fitness[b, i]:
        target = swarms.positions[b, best]
        if is_roomy(school, swarms, b, count_companions(school, swarms, b, target)):
            approach(school, swarms, b, i, table, work, target)
            return
    prey_by_class(parameters, school, swarms, b, i, table, work)


@kernel
def iterate(
    parameters: FishSwarmParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one iteration."""
    school = gather(parameters, table, parameters.visual, parameters.step, parameters.tries, repair_degree)
    take_turns(parameters, school, swarms, b, table, work)


class FishSwarm(Optimizer):
    """AFSA of the IAFSA paper, with the parameters printed there."""

    name = "fish-swarm"
    parameter_class = FishSwarmParameters
    evaluations_per_member = 9.0  # with five tries
    kernels = loop.Kernels(iterate)
