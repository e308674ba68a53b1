"""Artificial fish swarm algorithm: fish that swarm, follow, prey and leap.

Source: X. Li, Z. Shao, J. Qian, "An optimizing method based on autonomous animats: fish-swarm algorithm",
Systems Engineering Theory and Practice, 2002; in the form and with the parameters of the IAFSA paper,
section 2 (see `fish`). Fish take their turns one after the other. Each both swarms and follows, and preys in
place of either where there is nobody, nothing better or no room; it takes between 2 and 2 (tries + 1) + 1
evaluations. Readings are in docs/readings.md.
"""

from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel, kernel_by_class
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.fish.behaviour import (
    School,
    add_to_centre,
    approach,
    are_companions,
    count_companions,
    empty_centre,
    finish_centre,
    gather,
    go_astray,
    is_roomy,
    leap,
    look_at,
    look_at_centre,
    settle,
    take_down,
)
from swarm_gym.optimizers.optimizer import Knob, Optimizer
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import Table

Floats = NDArray[np.float64]


class FishSwarmRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@kernel(borrows=True)
def prey(
    rules: FishSwarmRules,  # noqa: ARG001
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
) -> None:
    """Member i steps towards the first of a few points in sight that is better, or leaps (eq. 2, 3)."""
    for _ in range(school.tries):
        if is_spent(swarms, b):
            return
        go_astray(school, swarms, b, table, work, swarms.positions[b, i], school.visual)
        if look_at(swarms, b, table, work) < swarms.fitness[b, i]:
            take_down(work, school.seen)
            approach(school, swarms, b, i, table, work, school.seen)
            return
    leap(school, swarms, b, i, table, work)


# By which rules a fish preys; all else is the same in the optimizers of these rules.
PREY: dict[type, Any] = {FishSwarmRules: prey}
prey_by_rules = kernel_by_class(PREY)


@kernel(borrows=True)
def take_turns(rules: Any, school: School, swarms: Swarms, b: int, table: Table, work: Workspace) -> None:
    """Every fish of swarm `b` takes its turn, while the evaluation budget lasts."""
    for i in range(swarms.size[b]):
        if is_spent(swarms, b):
            break
        count, best = look_around(school, swarms, b, i)
        swarm(rules, school, swarms, b, i, table, work, count)
        follow(rules, school, swarms, b, i, table, work, best)
        settle(school, swarms, b, i)


@kernel(borrows=True)
def look_around(school: School, swarms: Swarms, b: int, i: int) -> tuple[int, int]:
    """How many companions member i has, and which is the best one; their mean is the centre then."""
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
    rules: Any,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    count: int,
) -> None:
    """Member i steps towards the centre of its companions, if that is better and not crowded (eq. 4, 5)."""
    if count > 0:
        is_better = look_at_centre(school, swarms, b, table, work) < swarms.fitness[b, i]
        if is_better and is_roomy(school, swarms, b, count):
            approach(school, swarms, b, i, table, work, school.centre)
            return
    prey_by_rules(rules, school, swarms, b, i, table, work)


@kernel(borrows=True)
def follow(
    rules: Any,
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    best: int,
) -> None:
    """Member i steps towards its best companion, if that is better and not crowded (eq. 6, 7)."""
    if best >= 0 and swarms.fitness[b, best] < swarms.fitness[b, i]:
        target = swarms.positions[b, best]
        if is_roomy(school, swarms, b, count_companions(school, swarms, b, target)):
            approach(school, swarms, b, i, table, work, target)
            return
    prey_by_rules(rules, school, swarms, b, i, table, work)


@kernel
def iterate(
    rules: FishSwarmRules,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`."""
    school = gather(table, knobs[0], knobs[1], knobs[2], knobs[3], repair_degree)
    take_turns(rules, school, swarms, b, table, work)


VISUAL = Knob(0.3, 0.0, 1.0, "Visual", "how far a fish sees, in ranges", (0.001, 1.0))
STEP = Knob(0.1, 0.0, 1.0, "Step", "the longest step, in ranges", (0.001, 1.0))
CROWDING = Knob(0.6, 0.0, 1.0, "delta", "share of the swarm from which on a place is crowded")
TRIES = Knob(5.0, 1.0, 1000.0, "try_number", "points that a fish tries when it preys, rounded down")


class FishSwarm(Optimizer):
    """AFSA of the IAFSA paper, with the parameters printed there."""

    name = "fish-swarm"
    knobs: ClassVar[dict[str, Knob]] = {
        "visual": VISUAL,
        "step": STEP,
        "crowding": CROWDING,
        "tries": TRIES,
    }
    rules = FishSwarmRules
    kernels = loop.Kernels(iterate)

    @staticmethod
    def affordable_size(evaluations: Floats) -> Floats:
        """With five tries a fish takes about nine evaluations."""
        return evaluations / 9.0
