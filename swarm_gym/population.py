"""Populations as arrays: evaluation, the best so far, E(P), growth and shrinking.

Source: SPSFA paper, section III, eq. 7 (population collision evaluation) and eq. 12 (growth); the paper
describes shrinking in words.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import STREAM_SHAPE
from swarm_gym.compiler.simd import NUM_LANES, load, store
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, evaluate
from swarm_gym.scenarios import Point
from swarm_gym.sources import IMMIGRANTS, NUM_SOURCE_NUMBERS, draw_newcomer, note_arrival

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Columns of `Swarms.summary`.
NUM_SUMMARIES = 5
POPULATION_COLLISION, MEAN_COLLISION, COLLISION_DEVIATION, FEASIBLE_SHARE, DIVERSITY = range(NUM_SUMMARIES)


class Swarms(NamedTuple):
    """State of B swarms of up to M members of dimension D; changed in place by the kernels.

    Positions have C = `padding.columns(D)` columns, of which those from D on are zero.
    """

    problem: Integers  # (B,) number of the problem in the stacked problem tables
    stream: NDArray[np.uint64]  # (B, 4, 8) random streams
    size: Integers  # (B,) living members: the first `size` rows
    positions: Floats  # (B, M, C)
    fitness: Floats  # (B, M)
    collision: Floats  # (B, M)
    best_position: Floats  # (B, C) best so far; never lost by a resize
    best_fitness: Floats  # (B,)
    best_collision: Floats  # (B,)
    feasible_position: Floats  # (B, C) best of the feasible positions so far; members may all collide
    feasible_fitness: Floats  # (B,) infinite if there was none since the map last changed
    evaluations: Integers  # (B,) calls of the cost function in this episode
    budget: Integers  # (B,) evaluations allowed in this episode
    summary: Floats  # (B, 5) E(P), mean and standard deviation of the collision, feasible share, diversity
    iteration: Integers  # (B,) iterations done in this episode
    iterations: Integers  # (B,) iterations of an episode
    memory: Floats  # (B, M, K) numbers that an optimizer stores for each member
    registers: Integers  # (B, R) integers that it stores for a swarm
    field: Floats  # (B, F) numbers that it stores for the cells of a map
    walk: Floats  # (B, L, 2) points of a walk from the start, if members are not whole paths; map units
    best_walk: (
        Integers  # (B,) number of these points in the best path so far, which ends with a straight line
    )
    walked: Integers  # (B,) number of these points that a robot has passed
    source: Floats  # (B, 4) source of new members, see `sources`
    arrivals: Floats  # (B, 2, W) records of new members, see `sources`; W = 0 for none

    @classmethod
    def allocate(
        cls,
        num_swarms: int,
        capacity: int,
        dimension: int,
        memory_columns: int = 0,
        num_registers: int = 0,
        field_size: int = 0,
        walk_points: int = 0,
        arrival_window: int = 0,
    ) -> "Swarms":
        """Return empty swarms."""
        members = (num_swarms, capacity)
        return cls(
            problem=np.zeros(num_swarms, dtype=np.int64),
            stream=np.zeros((num_swarms, *STREAM_SHAPE), dtype=np.uint64),
            size=np.zeros(num_swarms, dtype=np.int64),
            positions=np.zeros((*members, columns(dimension))),
            fitness=np.zeros(members),
            collision=np.zeros(members),
            best_position=np.zeros((num_swarms, columns(dimension))),
            best_fitness=np.full(num_swarms, np.inf),
            best_collision=np.full(num_swarms, np.inf),
            feasible_position=np.zeros((num_swarms, columns(dimension))),
            feasible_fitness=np.full(num_swarms, np.inf),
            evaluations=np.zeros(num_swarms, dtype=np.int64),
            budget=np.zeros(num_swarms, dtype=np.int64),
            summary=np.zeros((num_swarms, NUM_SUMMARIES)),
            iteration=np.zeros(num_swarms, dtype=np.int64),
            iterations=np.ones(num_swarms, dtype=np.int64),
            memory=np.zeros((*members, memory_columns)),
            registers=np.zeros((num_swarms, num_registers), dtype=np.int64),
            field=np.zeros((num_swarms, field_size)),
            walk=np.zeros((num_swarms, walk_points, 2)),
            best_walk=np.zeros(num_swarms, dtype=np.int64),
            walked=np.zeros(num_swarms, dtype=np.int64),
            source=np.zeros((num_swarms, NUM_SOURCE_NUMBERS)),
            arrivals=np.full((num_swarms, 2, arrival_window), np.inf),
        )

    def best_walk_points(self, row: int) -> Floats:
        """Return the points of the best walk so far of a swarm, a view (k, 2)."""
        return self.walk[row, : self.best_walk[row]]

    def best_path(self, row: int, target: Point | Floats) -> Floats:
        """Return the points of the best walk so far and then the target, (k + 1, 2)."""
        return np.vstack([self.best_walk_points(row), target])


class Workspace(NamedTuple):
    """Scratch arrays for a step of one swarm, so that moves allocate nothing."""

    path: Floats  # (C + 1,) a zero for the start, then the position of a member
    noise: Floats  # (C,)
    numbers: Floats  # (F,) as many as a swarm stores for the cells of a map; their values are arbitrary


@kernel
def make_workspace(num_columns: int, num_numbers: int = 0) -> Workspace:
    """Return scratch arrays for positions of C columns, and F further numbers."""
    return Workspace(np.zeros(num_columns + 1), np.empty(num_columns), np.empty(num_numbers))


@kernel(borrows=True)
def clear_workspace(work: Workspace) -> None:
    """Make scratch arrays like new ones, for the next swarm."""
    for k in range(work.path.shape[0]):
        work.path[k] = 0.0


@kernel(borrows=True)
def is_spent(swarms: Swarms, b: int) -> bool:
    """Return whether the evaluation budget of swarm `b` is spent."""
    return swarms.evaluations[b] >= swarms.budget[b]


@kernel(borrows=True)
def feasible_fitness_of(swarms: Swarms, b: int) -> float:
    """Return the fitness of the best feasible path of swarm `b`; NaN where there is none.

    Walks keep no other path than the best by fitness.
    """
    if swarms.walk.shape[1] > 0:
        return swarms.best_fitness[b] if swarms.best_collision[b] <= FEASIBILITY_TOLERANCE else math.nan
    return swarms.feasible_fitness[b] if math.isfinite(swarms.feasible_fitness[b]) else math.nan


@kernel(borrows=True)
def copy_position(position: Floats, other: Floats) -> None:
    """Copy a position, (C,), into another array."""
    for k in range(0, position.shape[0], NUM_LANES):
        store(other, k, load(position, k))


@kernel(inline="early")
def evaluate_path(swarms: Swarms, b: int, table: Table, work: Workspace) -> tuple[float, float]:
    """Return fitness and collision of `work.path`; count the evaluation and update the best paths so far."""
    fitness, collision = evaluate(table, work.path)
    swarms.evaluations[b] += 1
    if fitness < swarms.best_fitness[b]:
        swarms.best_fitness[b] = fitness
        swarms.best_collision[b] = collision
        for k in range(swarms.best_position.shape[1]):
            swarms.best_position[b, k] = work.path[k + 1]
    if collision <= FEASIBILITY_TOLERANCE and fitness < swarms.feasible_fitness[b]:
        swarms.feasible_fitness[b] = fitness
        for k in range(swarms.best_position.shape[1]):
            swarms.feasible_position[b, k] = work.path[k + 1]
    return fitness, collision


@kernel(inline="early")
def evaluate_member(swarms: Swarms, b: int, member: int, table: Table, work: Workspace) -> None:
    """Evaluate `work.path` as `evaluate_path` does, and make it the position of a member."""
    swarms.fitness[b, member], swarms.collision[b, member] = evaluate_path(swarms, b, table, work)
    for k in range(swarms.positions.shape[2]):
        swarms.positions[b, member, k] = work.path[k + 1]


@kernel
def add_members(
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    count: int,
    lower: Floats,
    upper: Floats,
) -> None:
    """Append up to `count` members from the swarm's source, while the budget lasts.

    Uniform members lie in the box [lower, upper], (C,) each.
    """
    source, stream = swarms.source[b], swarms.stream[b]
    for _ in range(min(count, swarms.budget[b] - swarms.evaluations[b])):
        smooth = draw_newcomer(source, stream, table, work.noise, work.path, lower, upper)
        best = swarms.best_fitness[b]
        evaluate_member(swarms, b, swarms.size[b], table, work)
        fitness = swarms.fitness[b, swarms.size[b]]
        note_arrival(swarms.arrivals[b], swarms.iteration[b], smooth, fitness, best)
        swarms.size[b] += 1


@kernel
def adopt_members(swarms: Swarms, b: int, table: Table, work: Workspace, count: int) -> None:
    """Evaluate the first `count` positions as they stand, as the members of swarm `b`, which is empty."""
    for i in range(count):
        for k in range(swarms.positions.shape[2]):
            work.path[k + 1] = swarms.positions[b, i, k]
        evaluate_member(swarms, b, i, table, work)
    swarms.size[b] = count


@kernel
def re_evaluate_members(swarms: Swarms, b: int, table: Table, work: Workspace) -> None:
    """Evaluate the members of swarm `b` again, in order; the best so far are the best of them afterwards.

    Members for which the budget does not suffice are deleted.
    """
    forget_best(swarms, b)
    left = swarms.budget[b] - swarms.evaluations[b]
    adopt_members(swarms, b, table, work, min(swarms.size[b], left))


@kernel
def recall(swarms: Swarms, b: int, table: Table, work: Workspace, position: Floats) -> float:
    """Evaluate a stored position, (C,), and return its fitness; infinite if the budget is spent."""
    if is_spent(swarms, b):
        return math.inf
    for k in range(position.shape[0]):
        work.path[k + 1] = position[k]
    fitness, _ = evaluate_path(swarms, b, table, work)
    return fitness


@kernel
def clear(swarms: Swarms, b: int) -> None:
    """Let swarm `b` have no members, evaluations or best path."""
    swarms.size[b] = 0
    swarms.evaluations[b] = 0
    forget_best(swarms, b)


@kernel
def forget_best(swarms: Swarms, b: int) -> None:
    """Let swarm `b` have no best path, and no feasible one."""
    swarms.best_fitness[b] = math.inf
    swarms.best_collision[b] = math.inf
    swarms.feasible_fitness[b] = math.inf


@kernel(inline="early")
def resize(swarms: Swarms, b: int, table: Table, work: Workspace, new_size: int) -> None:
    """Grow or shrink swarm `b` to `new_size` members."""
    if new_size > swarms.size[b]:
        grow(swarms, b, table, work, new_size)
    elif new_size < swarms.size[b]:
        shrink(swarms, b, new_size)


@kernel
def grow(swarms: Swarms, b: int, table: Table, work: Workspace, new_size: int) -> None:
    """Add members from the source; uniform ones lie in the box that the population spans (eq. 12)."""
    lower, upper = span(swarms.positions[b], swarms.size[b], table)
    add_members(swarms, b, table, work, new_size - swarms.size[b], lower, upper)


@kernel
def num_staying(swarms: Swarms, b: int, new_size: int) -> int:
    """Return how many members of swarm `b` stay when it gets `new_size` members and immigrants.

    Immigrants replace their share of the members that would stay without them, but never all members.
    """
    staying = min(swarms.size[b], new_size)
    replaced = math.floor(swarms.source[b, IMMIGRANTS] * staying + 0.5)
    return max(staying - replaced, 1)


@kernel
def span(positions: Floats, count: int, table: Table) -> tuple[Floats, Floats]:
    """Return the lower and upper corner, (C,) each, of the box of the first `count` positions, (M, C).

    In a component in which they have no extent, the box has the bounds of the workspace.
    """
    width = positions.shape[1]
    lower, upper = np.full(width, math.inf), np.full(width, -math.inf)
    for i in range(count):
        for k in range(width):
            lower[k] = min(lower[k], positions[i, k])
            upper[k] = max(upper[k], positions[i, k])
    for k in range(width):
        if lower[k] >= upper[k]:
            lower[k], upper[k] = table.lower[k], table.upper[k]
    return lower, upper


@kernel
def shrink(swarms: Swarms, b: int, new_size: int) -> None:
    """Delete infeasible members, worst collision first, then feasible ones, worst fitness first.

    Ties in collision go to the worse fitness, full ties to the later member; the order inside the
    infeasible members is a reading (docs/readings.md). The survivors keep their order.
    """
    size = swarms.size[b]
    fitness, collision = swarms.fitness[b], swarms.collision[b]
    doomed = np.zeros(size, dtype=np.bool_)
    for _ in range(size - new_size):
        worst = -1
        for i in range(size):
            if not doomed[i] and (
                worst < 0 or not outlives(fitness[i], collision[i], fitness[worst], collision[worst])
            ):
                worst = i
        doomed[worst] = True
    kept = 0
    for i in range(size):
        if not doomed[i]:
            fitness[kept], collision[kept] = fitness[i], collision[i]
            for k in range(swarms.positions.shape[2]):
                swarms.positions[b, kept, k] = swarms.positions[b, i, k]
            for k in range(swarms.memory.shape[2]):
                swarms.memory[b, kept, k] = swarms.memory[b, i, k]
            kept += 1
    swarms.size[b] = new_size


@kernel
def outlives(fitness: float, collision: float, other_fitness: float, other_collision: float) -> bool:
    """Return whether shrinking keeps a member rather than another one; not if they are equal."""
    feasible = collision <= FEASIBILITY_TOLERANCE
    other_feasible = other_collision <= FEASIBILITY_TOLERANCE
    if feasible != other_feasible:
        return feasible
    if feasible or collision == other_collision:
        return fitness < other_fitness
    return collision < other_collision


@kernel(borrows=True)
def summarise(swarms: Swarms, b: int, mean_weight: float) -> None:
    """Write E(P) = k mean + (1 - k) std (eq. 7) and the other statistics into `swarms.summary`.

    The standard deviation has the denominator size - 1, and is 0 for one member. The diversity is the root
    mean square of the members' distances from their mean, in map units.
    """
    size = swarms.size[b]
    total, feasible = 0.0, 0
    for i in range(size):
        total += swarms.collision[b, i]
        if swarms.collision[b, i] <= FEASIBILITY_TOLERANCE:
            feasible += 1
    mean = total / size
    squares = 0.0
    for i in range(size):
        squares += (swarms.collision[b, i] - mean) ** 2
    deviation = math.sqrt(squares / (size - 1)) if size > 1 else 0.0
    summary = swarms.summary[b]
    summary[POPULATION_COLLISION] = mean_weight * mean + (1.0 - mean_weight) * deviation
    summary[MEAN_COLLISION] = mean
    summary[COLLISION_DEVIATION] = deviation
    summary[FEASIBLE_SHARE] = feasible / size
    summary[DIVERSITY] = _diversity(swarms.positions[b], size)


@kernel(borrows=True)
def _diversity(positions: Floats, size: int) -> float:
    squares = 0.0
    for k in range(positions.shape[1]):
        mean = 0.0
        for i in range(size):
            mean += positions[i, k]
        mean /= size
        for i in range(size):
            squares += (positions[i, k] - mean) ** 2
    return math.sqrt(squares / size)
