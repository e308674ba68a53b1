"""The behaviours that the fish swarms share: how a fish looks around, where it moves and what it accepts.

Source: Zhang, Guan, Pu, "The robot path planning based on improved artificial fish swarm algorithm",
Mathematical Problems in Engineering, 2016, called the IAFSA paper here; readings are in docs/readings.md.

Lengths are measured in the ranges of the components. A distance is a root mean square over the components if
these make up a path, so that it does not grow with their number. On test functions it is Euclidean.

A fish takes its turn: it finds candidates by one or two behaviours and moves to the best of them, even if
that is worse than its position. Points that it only looks at, which are centres and the tries of AFSA, are
evaluated and counted like all others. They cannot become the best so far, since the bulletin of the IAFSA
paper lists only fish (docs/readings.md).
"""

import math
from typing import Annotated, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, maximum, minimum, store, total
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.population import Swarms, Workspace, copy_position, evaluate_path, is_spent
from swarm_gym.problem.tables import Table, evaluate, repair, unit_length

Floats = NDArray[np.float64]

# Fields that classes of parameters of fish swarms have in common.
Visual = Annotated[float, Parameter(0.3, 0.0, 1.0, "Visual", "how far a fish sees, in ranges", (0.001, 1.0))]
Step = Annotated[float, Parameter(0.1, 0.0, 1.0, "Step", "the longest step, in ranges", (0.001, 1.0))]
Crowding = Annotated[
    float,
    Parameter(0.6, 0.0, 1.0, "delta", "share of the swarm from which on a place is crowded", (0.05, 1.0)),
]
Tries = Annotated[
    float, Parameter(5.0, 1.0, 1000.0, "try_number", "points that a fish tries when it preys, rounded down")
]
SmallestVisual = Annotated[
    float, Parameter(0.01, 0.0, 1.0, "Visual_min", "smallest distance that a fish sees, in ranges")
]
SmallestStep = Annotated[
    float, Parameter(0.01, 0.0, 1.0, "Step_min", "smallest length of the longest step, in ranges")
]


class Crowded(Protocol):
    """Parameters of any fish swarm, as far as all of them need them."""

    @property
    def crowding(self) -> float:
        """The share of the swarm from which on a place is crowded."""


# Entries of `School.outcome`.
FITNESS, COLLISION = range(2)


class School(NamedTuple):
    """A swarm of fish in one iteration: the limits of its members, and scratch arrays of a turn."""

    visual: float  # V, how far a fish sees, in ranges
    step: float  # S, the longest step, in ranges
    crowding: float  # delta, the share of the swarm from which on a place is crowded
    tries: int  # points that a fish tries when it preys
    repair_degree: float  # phi
    unit: float  # Euclidean length of a distance of 1
    extent: Floats  # (C,) ranges of the components
    scale: Floats  # (C,) their inverses; 0 where a range is 0
    centre: Floats  # (C,) mean of members
    seen: Floats  # (C,) point to which a preying fish moves
    start: Floats  # (C,) point around which a fish looks
    candidate: Floats  # (C,) best point so far to which the fish can move at the end of its turn
    outcome: Floats  # (2,) fitness and collision of the candidate; infinite while there is none


@kernel
def gather(
    parameters: Crowded, table: Table, visual: float, step: float, tries: float, repair_degree: float
) -> School:
    """Return the fish at the beginning of an iteration, with these limits in it."""
    width = table.lower.shape[0]
    extent, scale = np.empty(width), np.zeros(width)
    for k in range(width):
        extent[k] = table.upper[k] - table.lower[k]
        if extent[k] > 0.0:
            scale[k] = 1.0 / extent[k]
    return School(
        visual,
        step,
        parameters.crowding,
        int(tries),
        repair_degree,
        unit_length(table),
        extent,
        scale,
        np.zeros(width),
        np.zeros(width),
        np.zeros(width),
        np.zeros(width),
        np.full(2, math.inf),
    )


@kernel(borrows=True)
def square(scale: Floats, position: Floats, other: Floats) -> float:
    """Return the squared Euclidean distance of two positions, in ranges."""
    squares = broadcast(0.0)
    for k in range(0, position.shape[0], NUM_LANES):
        difference = (load(other, k) - load(position, k)) * load(scale, k)
        squares = squares + difference * difference
    return total(squares)


@kernel(borrows=True)
def are_companions(school: School, position: Floats, other: Floats) -> bool:
    """Return whether two positions are within sight of each other; equal positions are not."""
    reach = school.visual * school.unit
    return 0.0 < square(school.scale, position, other) < reach * reach


@kernel(borrows=True)
def count_companions(school: School, swarms: Swarms, b: int, position: Floats) -> int:
    """Return how many members of swarm `b` are within sight of a position."""
    count = 0
    for k in range(swarms.size[b]):
        if are_companions(school, position, swarms.positions[b, k]):
            count += 1
    return count


@kernel(borrows=True)
def is_roomy(school: School, swarms: Swarms, b: int, companions: int) -> bool:
    """Return whether a place with this number of companions is not crowded."""
    return companions / swarms.size[b] < school.crowding


@kernel(borrows=True)
def draw(swarms: Swarms, b: int, work: Workspace) -> float:
    """Draw a number uniform in [0, 1)."""
    fill_uniform(swarms.stream[b], work.noise)
    return work.noise[0]


@kernel(borrows=True)
def move_randomly(
    school: School,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    position: Floats,
    radius: float,
    kept: float = 1.0,
) -> None:
    """Draw `work.path` from the box around a position that is scaled by `kept` (eq. 2)."""
    fill_uniform(swarms.stream[b], work.noise)
    for k in range(0, position.shape[0], NUM_LANES):
        shift = radius * (2.0 * load(work.noise, k) - 1.0) * load(school.extent, k)
        moved = kept * load(position, k) + shift
        store(work.path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


@kernel(borrows=True)
def move_towards(
    school: School,
    table: Table,
    work: Workspace,
    position: Floats,
    target: Floats,
    length: float,
    kept: float = 1.0,
) -> None:
    """Let `work.path` be a step towards a target, from a position that is scaled by `kept` (eq. 3, 5, 7)."""
    distance = math.sqrt(square(school.scale, position, target))
    share = length * school.unit / distance if distance > 0.0 else 0.0
    for k in range(0, position.shape[0], NUM_LANES):
        here = load(position, k)
        # A component without an extent cannot change: it is the same in both positions.
        moved = kept * here + share * (load(target, k) - here)
        store(work.path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


@kernel(borrows=True)
def move_to(work: Workspace, position: Floats) -> None:
    """Let `work.path` be a position."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(work.path, k + 1, load(position, k))


@kernel(borrows=True)
def copy_path(work: Workspace, position: Floats) -> None:
    """Copy the position of `work.path` into an array, (C,)."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(position, k, load(work.path, k + 1))


@kernel(borrows=True)
def empty_centre(school: School) -> None:
    """Begin the mean of some positions."""
    for k in range(0, school.centre.shape[0], NUM_LANES):
        store(school.centre, k, broadcast(0.0))


@kernel(borrows=True)
def add_to_centre(school: School, position: Floats) -> None:
    """Add a position to the mean."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(school.centre, k, load(school.centre, k) + load(position, k))


@kernel(borrows=True)
def finish_centre(school: School, count: int) -> None:
    """Divide the sum of the positions by their number."""
    for k in range(0, school.centre.shape[0], NUM_LANES):
        store(school.centre, k, load(school.centre, k) / count)


@kernel(borrows=True)
def look_at(swarms: Swarms, b: int, table: Table, work: Workspace) -> float:
    """Return the fitness of `work.path`; count the evaluation, but do not make the path the best so far."""
    fitness, _ = evaluate(table, work.path)
    swarms.evaluations[b] += 1
    return fitness


@kernel(borrows=True)
def try_out(school: School, swarms: Swarms, b: int, table: Table, work: Workspace) -> tuple[float, float]:
    """Repair `work.path`, to which a fish can move, and return its fitness and collision."""
    if school.repair_degree > 0.0:
        repair(table, work.path, school.repair_degree)
    return evaluate_path(swarms, b, table, work)


@kernel(borrows=True)
def look_at_centre(school: School, swarms: Swarms, b: int, table: Table, work: Workspace) -> float:
    """Return the fitness of the centre, as `look_at` does."""
    move_to(work, school.centre)
    return look_at(swarms, b, table, work)


@kernel(borrows=True)
def step_towards(
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    target: Floats,
    kept: float = 1.0,
) -> tuple[float, float]:
    """Try out a step of random length of member i, scaled by `kept`, towards a target; see `try_out`."""
    length = school.step * draw(swarms, b, work)
    move_towards(school, table, work, swarms.positions[b, i], target, length, kept)
    return try_out(school, swarms, b, table, work)


@kernel(borrows=True)
def offer(school: School, work: Workspace, fitness: float, collision: float) -> None:
    """Let `work.path` be the candidate if it is better than the present one."""
    if fitness < school.outcome[FITNESS]:
        school.outcome[FITNESS], school.outcome[COLLISION] = fitness, collision
        copy_path(work, school.candidate)


@kernel(borrows=True)
def approach(
    school: School,
    swarms: Swarms,
    b: int,
    i: int,
    table: Table,
    work: Workspace,
    target: Floats,
) -> None:
    """Offer a step of random length from member i towards a target."""
    if not is_spent(swarms, b):
        fitness, collision = step_towards(school, swarms, b, i, table, work, target)
        offer(school, work, fitness, collision)


@kernel(borrows=True)
def leap(school: School, swarms: Swarms, b: int, i: int, table: Table, work: Workspace) -> None:
    """Offer a random point within the sight of member i."""
    if not is_spent(swarms, b):
        move_randomly(school, swarms, b, table, work, swarms.positions[b, i], school.visual)
        fitness, collision = try_out(school, swarms, b, table, work)
        offer(school, work, fitness, collision)


@kernel(borrows=True)
def settle(school: School, swarms: Swarms, b: int, i: int) -> None:
    """End the turn of member i: it moves to the candidate, if there is one."""
    if school.outcome[FITNESS] < math.inf:
        swarms.fitness[b, i], swarms.collision[b, i] = school.outcome[FITNESS], school.outcome[COLLISION]
        copy_position(school.candidate, swarms.positions[b, i])
        school.outcome[FITNESS] = math.inf
