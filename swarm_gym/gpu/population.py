"""Populations on the device: evaluation, the best so far, E(P), growth and shrinking.

The same rules in the same order as `swarm_gym.population` and `swarm_gym.sources`, which say what they mean.
Lane k holds component k of a position; numbers of a whole swarm are the same in all lanes.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.gpu.random_stream import Stream, draw
from swarm_gym.gpu.warps import BLOCK, NUM_LANES, from_lane, kernel, total, wait
from swarm_gym.population import (
    COLLISION_DEVIATION,
    DIVERSITY,
    FEASIBLE_SHARE,
    MEAN_COLLISION,
    POPULATION_COLLISION,
    Swarms,
)
from swarm_gym.population import outlives as _outlives
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.problem.tables import Tables
from swarm_gym.sources import AMPLITUDE, BECAME_BEST, BEST_SMOOTH, IMMIGRANTS, KIND_OF_BENDS, SMOOTH_SHARE

Floats = NDArray[np.float64]  # or of float32, see `warps`


class Tally(NamedTuple):
    """Numbers of a swarm that every evaluation may change; kept in registers during an iteration."""

    evaluations: int
    best_fitness: float
    best_collision: float
    feasible_fitness: float


class ProblemKernels(NamedTuple):
    """The functions of one kind of problem on the device; `p` is the number of the problem.

    Attributes:
        evaluate: (tables, p, lane, place) -> fitness and degree of collision.
        repair: (tables, p, lane, place, repair_degree) -> the component of this lane after one repair pass.
        draw_bend: (tables, p, lane, amplitude, kind, noise, share) -> this lane's component of a smooth bend.
    """

    evaluate: Callable[..., tuple[float, float]]
    repair: Callable[..., float]
    draw_bend: Callable[..., float]


class PopulationKernels(NamedTuple):
    """The functions of populations on one kind of problem, see `make_population_kernels`."""

    evaluate_path: Callable[..., tuple[float, float, Tally]]
    adopt_members: Callable[..., Tally]
    add_members: Callable[..., tuple[int, Stream, Tally]]
    change_size: Callable[..., tuple[int, Stream, Tally]]


@kernel
def load_tally(swarms: Swarms, b: int) -> Tally:
    """Return the tally of swarm `b`."""
    return Tally(
        swarms.evaluations[b], swarms.best_fitness[b], swarms.best_collision[b], swarms.feasible_fitness[b]
    )


@kernel
def store_tally(swarms: Swarms, b: int, lane: int, tally: Tally) -> None:
    """Write a tally to where `load_tally` reads it."""
    if lane == 0:
        swarms.evaluations[b] = tally.evaluations
        swarms.best_fitness[b] = tally.best_fitness
        swarms.best_collision[b] = tally.best_collision
        swarms.feasible_fitness[b] = tally.feasible_fitness


@kernel
def store_member(
    swarms: Swarms, b: int, lane: int, member: int, place: float, fitness: float, collision: float
) -> None:
    """Write a member; all lanes see it afterwards."""
    swarms.positions[b, member, lane] = place
    if lane == 0:
        swarms.fitness[b, member] = fitness
        swarms.collision[b, member] = collision
    wait()


@kernel
def num_rounds(tables: Tables, p: int) -> int:
    """Return how often eight random numbers are drawn for the components of a position."""
    return (tables.dimension[p] + BLOCK) // BLOCK


# The rule of the CPU; without Numba's compiler, it is a function of Python already.
outlives = kernel(getattr(_outlives, "py_func", _outlives))


@kernel
def stays(swarms: Swarms, b: int, size: int, new_size: int, member: int) -> bool:
    """Return whether a member is among the `new_size` that outlive the others; later ones lose ties."""
    fitness, collision = swarms.fitness[b, member], swarms.collision[b, member]
    outliving = 0
    for i in range(size):
        other, its_collision = swarms.fitness[b, i], swarms.collision[b, i]
        if outlives(other, its_collision, fitness, collision) or (
            i < member and not outlives(fitness, collision, other, its_collision)
        ):
            outliving += 1
    return outliving < new_size


@kernel
def shrink(swarms: Swarms, b: int, lane: int, size: int, new_size: int) -> None:
    """Delete all but `new_size` of `size` members; the survivors keep their order.

    Lanes share the members. `registers` holds for each of them whether it stays.
    """
    for member in range(lane, size, NUM_LANES):
        swarms.registers[b, member] = 1 if stays(swarms, b, size, new_size, member) else 0
    wait()
    kept = 0
    for i in range(size):
        if swarms.registers[b, i] == 1:
            if kept < i:
                fitness, collision = swarms.fitness[b, i], swarms.collision[b, i]
                for k in range(lane, swarms.memory.shape[2], NUM_LANES):
                    swarms.memory[b, kept, k] = swarms.memory[b, i, k]
                store_member(swarms, b, lane, kept, swarms.positions[b, i, lane], fitness, collision)
            kept += 1


@kernel
def num_staying(swarms: Swarms, b: int, size: int, new_size: int) -> int:
    """Return how many members stay when a swarm gets immigrants, see `swarm_gym.population`."""
    staying = min(size, new_size)
    replaced = int(math.floor(swarms.source[b, IMMIGRANTS] * staying + 0.5))  # noqa: RUF046  # a float in CUDA
    return max(staying - replaced, 1)


@kernel
def begin_arrivals(swarms: Swarms, b: int, lane: int) -> None:
    """Delete the records of new members that records of this iteration replace."""
    window = swarms.arrivals.shape[2]
    if window > 0 and lane == 0:
        now = swarms.iteration[b] % window
        swarms.arrivals[b, BEST_SMOOTH, now] = math.inf
        swarms.arrivals[b, BECAME_BEST, now] = 0.0


@kernel
def forget_arrivals(swarms: Swarms, b: int, lane: int) -> None:
    """Delete all records of new members."""
    if lane == 0:
        for k in range(swarms.arrivals.shape[2]):
            swarms.arrivals[b, BEST_SMOOTH, k] = math.inf
            swarms.arrivals[b, BECAME_BEST, k] = 0.0


@kernel
def note_arrival(swarms: Swarms, b: int, lane: int, smooth: bool, fitness: float, best: float) -> None:
    """Record a new member, where `best` was the best fitness before."""
    window = swarms.arrivals.shape[2]
    if window > 0 and lane == 0:
        now = swarms.iteration[b] % window
        if smooth:
            swarms.arrivals[b, BEST_SMOOTH, now] = min(swarms.arrivals[b, BEST_SMOOTH, now], fitness)
        if fitness < best:
            swarms.arrivals[b, BECAME_BEST, now] += 1.0


@kernel
def summarise(swarms: Swarms, b: int, lane: int, size: int, mean_weight: float) -> None:
    """Write E(P) and the other statistics of a swarm.

    Sums over members have the order of those on the CPU; only the diversity is added by lanes here. All
    lanes wait for each other before anything is written: here and after this call, lanes write numbers that
    others have read at the beginning of the entry.
    """
    collisions, feasible = 0.0, 0
    place_sum = 0.0
    for i in range(size):
        collision = swarms.collision[b, i]
        collisions += collision
        if collision <= FEASIBILITY_TOLERANCE:
            feasible += 1
        place_sum += swarms.positions[b, i, lane]
    mean, middle = collisions / size, place_sum / size
    squares, spread = 0.0, 0.0
    for i in range(size):
        difference = swarms.collision[b, i] - mean
        squares += difference * difference
        away = swarms.positions[b, i, lane] - middle
        spread += away * away
    deviation = math.sqrt(squares / (size - 1)) if size > 1 else 0.0
    diversity = math.sqrt(total(spread) / size)
    wait()
    if lane == 0:
        swarms.size[b] = size
        swarms.summary[b, POPULATION_COLLISION] = mean_weight * mean + (1.0 - mean_weight) * deviation
        swarms.summary[b, MEAN_COLLISION] = mean
        swarms.summary[b, COLLISION_DEVIATION] = deviation
        swarms.summary[b, FEASIBLE_SHARE] = feasible / size
        swarms.summary[b, DIVERSITY] = diversity


def make_population_kernels(problem: ProblemKernels) -> PopulationKernels:
    """Return the functions of populations on a kind of problem."""
    evaluate, draw_bend = problem.evaluate, problem.draw_bend

    @kernel
    def evaluate_path(
        swarms: Swarms, b: int, tables: Tables, p: int, lane: int, place: float, tally: Tally
    ) -> tuple[float, float, Tally]:
        """Return fitness and collision of a path; count the evaluation and update the best paths so far."""
        fitness, collision = evaluate(tables, p, lane, place)
        best, best_collision, feasible = tally.best_fitness, tally.best_collision, tally.feasible_fitness
        if fitness < best:
            best, best_collision = fitness, collision
            swarms.best_position[b, lane] = place
        if collision <= FEASIBILITY_TOLERANCE and fitness < feasible:
            feasible = fitness
            swarms.feasible_position[b, lane] = place
        return fitness, collision, Tally(tally.evaluations + 1, best, best_collision, feasible)

    @kernel
    def adopt_members(
        swarms: Swarms, b: int, tables: Tables, p: int, lane: int, count: int, tally: Tally
    ) -> Tally:
        """Evaluate the first `count` positions as they stand, as the members; return the tally."""
        for i in range(count):
            place = swarms.positions[b, i, lane]
            fitness, collision, tally = evaluate_path(swarms, b, tables, p, lane, place, tally)
            store_member(swarms, b, lane, i, place, fitness, collision)
        return tally

    @kernel
    def add_members(
        swarms: Swarms,
        b: int,
        tables: Tables,
        p: int,
        lane: int,
        size: int,
        count: int,
        lower: float,
        upper: float,
        stream: Stream,
        tally: Tally,
    ) -> tuple[int, Stream, Tally]:
        """Append up to `count` members from the swarm's source to `size` members, while the budget lasts.

        Returns:
            The new size, stream and tally.
        """
        rounds, share = num_rounds(tables, p), swarms.source[b, SMOOTH_SHARE]
        for _ in range(min(count, swarms.budget[b] - tally.evaluations)):
            drawn, stream = draw(stream, lane, rounds)
            noise = swarms.positions.dtype.type(drawn)
            smooth = share > 0.0 and from_lane(noise, 0) < share
            if smooth:
                kind = int(swarms.source[b, KIND_OF_BENDS])
                place = draw_bend(tables, p, lane, swarms.source[b, AMPLITUDE], kind, noise, share)
            else:
                if share > 0.0:  # the first of the old numbers is known to be large
                    drawn, stream = draw(stream, lane, rounds)
                    noise = swarms.positions.dtype.type(drawn)
                place = lower + (upper - lower) * noise  # eq. 12
            best = tally.best_fitness
            fitness, collision, tally = evaluate_path(swarms, b, tables, p, lane, place, tally)
            store_member(swarms, b, lane, size, place, fitness, collision)
            note_arrival(swarms, b, lane, smooth, fitness, best)
            size += 1
        return size, stream, tally

    @kernel
    def change_size(
        swarms: Swarms,
        b: int,
        tables: Tables,
        p: int,
        lane: int,
        size: int,
        new_size: int,
        stream: Stream,
        tally: Tally,
    ) -> tuple[int, Stream, Tally]:
        """Grow or shrink a swarm; uniform new members lie in the box that the population spans (eq. 12)."""
        if new_size < size:
            shrink(swarms, b, lane, size, new_size)
            size = new_size
        elif new_size > size:
            infinity = swarms.positions.dtype.type(math.inf)
            lower, upper = infinity, -infinity
            for i in range(size):
                place = swarms.positions[b, i, lane]
                lower, upper = min(lower, place), max(upper, place)
            if lower >= upper:
                lower, upper = tables.lower[p, lane], tables.upper[p, lane]
            count = new_size - size
            size, stream, tally = add_members(
                swarms, b, tables, p, lane, size, count, lower, upper, stream, tally
            )
        return size, stream, tally

    return PopulationKernels(evaluate_path, adopt_members, add_members, change_size)
