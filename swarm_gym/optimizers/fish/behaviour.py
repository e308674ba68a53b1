"""What the fish swarms have in common: how a fish looks around, where it may go, and what it settles for.

Source: Zhang, Guan, Pu, "The robot path planning based on improved artificial fish swarm algorithm",
Mathematical Problems in Engineering, 2016, called the IAFSA paper here; readings are in docs/readings.md.

Lengths are measured in the ranges of the components. A distance is a root mean square over the components
where these make up a path, so that it does not grow with their number, and Euclidean on test functions.

A fish takes its turn: it looks for candidates by one or two behaviours and goes to the better one, even where
that is worse than where it was. Points that it only looks at, centres and what AFSA tries, are evaluated and
counted like all others, but are not remembered: the paper's bulletin is of fish (docs/readings.md).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, maximum, minimum, store, total
from swarm_gym.population import Swarms, Workspace, copy_position, evaluate_path, is_spent
from swarm_gym.problem.tables import Table, evaluate, repair, unit_length

Floats = NDArray[np.float64]


class School(NamedTuple):
    """A swarm of fish in one iteration: what its members go by, and scratch arrays of a turn."""

    visual: float  # V, how far a fish sees, in ranges
    step: float  # S, the longest step, in ranges
    crowding: float  # delta, the share of the swarm from which on a place is crowded
    tries: int  # of a fish that preys
    repair_degree: float  # phi
    unit: float  # Euclidean length of a distance of 1
    extent: Floats  # (C,) ranges of the components
    scale: Floats  # (C,) their inverses; 0 where a range is 0
    centre: Floats  # (C,) mean of members
    seen: Floats  # (C,) what a fish that preys goes to
    start: Floats  # (C,) where it looks around from
    candidate: Floats  # (C,) where the fish may go at the end of its turn
    outcome: Floats  # (2,) fitness and collision there; infinite while there is no candidate


@kernel
def gather(
    table: Table,
    visual: float,
    step: float,
    crowding: float,
    tries: float,
    repair_degree: float,
) -> School:
    """The fish as they begin an iteration."""
    width = table.lower.shape[0]
    extent, scale = np.empty(width), np.zeros(width)
    for k in range(width):
        extent[k] = table.upper[k] - table.lower[k]
        if extent[k] > 0.0:
            scale[k] = 1.0 / extent[k]
    return School(
        visual,
        step,
        crowding,
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
    """Squared Euclidean distance of two positions, in ranges."""
    squares = broadcast(0.0)
    for k in range(0, position.shape[0], NUM_LANES):
        difference = (load(other, k) - load(position, k)) * load(scale, k)
        squares = squares + difference * difference
    return total(squares)


@kernel(borrows=True)
def are_companions(school: School, position: Floats, other: Floats) -> bool:
    """Whether two positions lie within sight of each other; the same place does not count."""
    reach = school.visual * school.unit
    return 0.0 < square(school.scale, position, other) < reach * reach


@kernel(borrows=True)
def count_companions(school: School, swarms: Swarms, b: int, position: Floats) -> int:
    """How many members of swarm `b` are within sight of a position."""
    count = 0
    for k in range(swarms.size[b]):
        if are_companions(school, position, swarms.positions[b, k]):
            count += 1
    return count


@kernel(borrows=True)
def is_roomy(school: School, swarms: Swarms, b: int, companions: int) -> bool:
    """Whether a place with so many companions is not crowded."""
    return companions / swarms.size[b] < school.crowding


@kernel(borrows=True)
def draw(swarms: Swarms, b: int, work: Workspace) -> float:
    """A number uniform in [0, 1)."""
    fill_uniform(swarms.stream[b], work.noise)
    return work.noise[0]


@kernel(borrows=True)
def go_astray(
    school: School,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    position: Floats,
    radius: float,
    kept: float = 1.0,
) -> None:
    """Let `work.path` be a point in the box around a share of a position: X_j = X_i + Visual rand (eq. 2)."""
    fill_uniform(swarms.stream[b], work.noise)
    for k in range(0, position.shape[0], NUM_LANES):
        shift = radius * (2.0 * load(work.noise, k) - 1.0) * load(school.extent, k)
        moved = kept * load(position, k) + shift
        store(work.path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


@kernel(borrows=True)
def go_towards(
    school: School,
    table: Table,
    work: Workspace,
    position: Floats,
    target: Floats,
    length: float,
    kept: float = 1.0,
) -> None:
    """Let `work.path` be a step from a share of a position in the direction of a target (eq. 3, 5, 7)."""
    distance = math.sqrt(square(school.scale, position, target))
    share = length * school.unit / distance if distance > 0.0 else 0.0
    for k in range(0, position.shape[0], NUM_LANES):
        here = load(position, k)
        # Without an extent there is nowhere to go; the components cannot differ there.
        moved = kept * here + share * (load(target, k) - here)
        store(work.path, k + 1, minimum(maximum(moved, load(table.lower, k)), load(table.upper, k)))


@kernel(borrows=True)
def go_to(work: Workspace, position: Floats) -> None:
    """Let `work.path` be a position."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(work.path, k + 1, load(position, k))


@kernel(borrows=True)
def take_down(work: Workspace, position: Floats) -> None:
    """Let an array, (C,), hold the position of `work.path`."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(position, k, load(work.path, k + 1))


@kernel(borrows=True)
def empty_centre(school: School) -> None:
    """Begin to find the mean of some positions."""
    for k in range(0, school.centre.shape[0], NUM_LANES):
        store(school.centre, k, broadcast(0.0))


@kernel(borrows=True)
def add_to_centre(school: School, position: Floats) -> None:
    """Add one of these positions."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(school.centre, k, load(school.centre, k) + load(position, k))


@kernel(borrows=True)
def finish_centre(school: School, count: int) -> None:
    """Divide the sum by the number of positions."""
    for k in range(0, school.centre.shape[0], NUM_LANES):
        store(school.centre, k, load(school.centre, k) / count)


@kernel(borrows=True)
def look_at(swarms: Swarms, b: int, table: Table, work: Workspace) -> float:
    """Fitness of `work.path`, where no fish goes; counted, not remembered."""
    fitness, _ = evaluate(table, work.path)
    swarms.evaluations[b] += 1
    return fitness


@kernel(borrows=True)
def try_out(school: School, swarms: Swarms, b: int, table: Table, work: Workspace) -> tuple[float, float]:
    """Fitness and collision of `work.path`, repaired, where a fish may go."""
    if school.repair_degree > 0.0:
        repair(table, work.path, school.repair_degree)
    return evaluate_path(swarms, b, table, work)


@kernel(borrows=True)
def look_at_centre(school: School, swarms: Swarms, b: int, table: Table, work: Workspace) -> float:
    """Fitness of the centre."""
    go_to(work, school.centre)
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
    """Try out a step of random length from a share of where member i is towards a target."""
    length = school.step * draw(swarms, b, work)
    go_towards(school, table, work, swarms.positions[b, i], target, length, kept)
    return try_out(school, swarms, b, table, work)


@kernel(borrows=True)
def offer(school: School, work: Workspace, fitness: float, collision: float) -> None:
    """Let `work.path` be the candidate if it is better than the one before."""
    if fitness < school.outcome[0]:
        school.outcome[0], school.outcome[1] = fitness, collision
        take_down(work, school.candidate)


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
    """Offer any point that member i sees."""
    if not is_spent(swarms, b):
        go_astray(school, swarms, b, table, work, swarms.positions[b, i], school.visual)
        fitness, collision = try_out(school, swarms, b, table, work)
        offer(school, work, fitness, collision)


@kernel(borrows=True)
def settle(school: School, swarms: Swarms, b: int, i: int) -> None:
    """End the turn of member i: it goes to the candidate, if there is one."""
    if school.outcome[0] < math.inf:
        swarms.fitness[b, i], swarms.collision[b, i] = school.outcome[0], school.outcome[1]
        copy_position(school.candidate, swarms.positions[b, i])
        school.outcome[0] = math.inf
