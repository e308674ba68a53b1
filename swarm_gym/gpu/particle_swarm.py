"""Particle swarm optimization on the device; `swarm_gym.optimizers.particle_swarm` says what it does."""

import math
from collections.abc import Callable

from swarm_gym.gpu.population import (
    Floats,
    PopulationKernels,
    ProblemKernels,
    Tally,
    num_rounds,
    store_member,
)
from swarm_gym.gpu.random_stream import Stream, draw
from swarm_gym.gpu.warps import NUM_LANES, ONE, TWO, kernel, wait
from swarm_gym.optimizers.particle_swarm import ParticleSwarmParameters, particle_columns
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Tables

# Columns of the parameters of a swarm.
_FIRST, _LAST, _FACTOR, _COGNITIVE, _SOCIAL, _LIMIT = map(
    ParticleSwarmParameters._fields.index,
    ("first_inertia", "last_inertia", "inertia_factor", "cognitive", "social", "velocity_limit"),
)
# Columns of what is remembered of a particle; `BEST_POSITION` and `VELOCITY` have one for each lane.
VELOCITY, BEST_POSITION, BEST_FITNESS = particle_columns(NUM_LANES)


@kernel
def remember(swarms: Swarms, b: int, lane: int, i: int, place: float, fitness: float) -> None:
    """Let a position be the best one of particle i so far."""
    swarms.memory[b, i, BEST_POSITION + lane] = place
    if lane == 0:
        swarms.memory[b, i, BEST_FITNESS] = fitness


@kernel
def settle(swarms: Swarms, b: int, tables: Tables, p: int, lane: int, first: int, size: int) -> None:
    """Let the members from `first` on begin at rest; their best positions are the present ones."""
    for i in range(first, size):
        swarms.memory[b, i, VELOCITY + lane] = 0.0
        remember(swarms, b, lane, i, swarms.positions[b, i, lane], swarms.fitness[b, i])
    wait()


@kernel
def start(
    parameters: Floats,
    swarms: Swarms,
    b: int,
    tables: Tables,
    p: int,
    lane: int,
    size: int,
    stream: Stream,
) -> Stream:
    """Draw velocities up to their limit for a first population; return the stream after it."""
    fastest = parameters[b, _LIMIT] * (tables.upper[p, lane] - tables.lower[p, lane])
    rounds = num_rounds(tables, p)
    for i in range(size):
        drawn, stream = draw(stream, lane, rounds)
        number = swarms.positions.dtype.type(drawn)
        swarms.memory[b, i, VELOCITY + lane] = fastest * (TWO * number - ONE)
    return stream


def make_recall(population: PopulationKernels) -> Callable[..., Tally]:
    """Return the function that evaluates again the best position of each particle."""
    evaluate_path = population.evaluate_path

    @kernel
    def recall(swarms: Swarms, b: int, tables: Tables, p: int, lane: int, size: int, tally: Tally) -> Tally:
        """Keep the better of the position and the best position of each particle; return the tally."""
        for i in range(size):
            own_best = math.inf
            if tally.evaluations < swarms.budget[b]:
                place = swarms.memory[b, i, BEST_POSITION + lane]
                own_best, _, tally = evaluate_path(swarms, b, tables, p, lane, place, tally)
            if lane == 0:
                swarms.memory[b, i, BEST_FITNESS] = own_best
            if swarms.fitness[b, i] < own_best:
                remember(swarms, b, lane, i, swarms.positions[b, i, lane], swarms.fitness[b, i])
        return tally

    return recall


def make_iterate(
    problem: ProblemKernels, population: PopulationKernels
) -> Callable[..., tuple[Stream, Tally]]:
    """Return the function that advances a swarm by one iteration on a kind of problem."""
    repair, evaluate_path = problem.repair, population.evaluate_path

    @kernel
    def iterate(
        parameters: Floats,
        swarms: Swarms,
        b: int,
        tables: Tables,
        p: int,
        lane: int,
        size: int,
        repair_degree: float,
        stream: Stream,
        tally: Tally,
    ) -> tuple[Stream, Tally]:
        """Advance swarm `b`; the best position of the swarm is from the iteration before."""
        number = swarms.positions.dtype.type
        progress = number(swarms.iteration[b] / max(swarms.iterations[b] - 1, 1))
        inertia = parameters[b, _FIRST] + (parameters[b, _LAST] - parameters[b, _FIRST]) * progress
        inertia *= parameters[b, _FACTOR]
        cognitive, social = parameters[b, _COGNITIVE], parameters[b, _SOCIAL]
        lower, upper = tables.lower[p, lane], tables.upper[p, lane]
        fastest = parameters[b, _LIMIT] * (upper - lower)
        swarm_best, rounds = swarms.best_position[b, lane], num_rounds(tables, p)
        for i in range(size):
            if tally.evaluations >= swarms.budget[b]:
                break
            first, stream = draw(stream, lane, rounds)
            second, stream = draw(stream, lane, rounds)
            own_share, common_share = number(first), number(second)
            place, own_best = swarms.positions[b, i, lane], swarms.memory[b, i, BEST_FITNESS]
            velocity = (
                inertia * swarms.memory[b, i, VELOCITY + lane]
                + cognitive * own_share * (swarms.memory[b, i, BEST_POSITION + lane] - place)
                + social * common_share * (swarm_best - place)
            )
            velocity = min(max(velocity, -fastest), fastest)
            wanted = place + velocity
            reached = min(max(wanted, lower), upper)
            swarms.memory[b, i, VELOCITY + lane] = velocity if reached == wanted else 0.0
            if repair_degree > 0.0:
                reached = repair(tables, p, lane, reached, repair_degree)
            fitness, collision, tally = evaluate_path(swarms, b, tables, p, lane, reached, tally)
            store_member(swarms, b, lane, i, reached, fitness, collision)
            if fitness < own_best:
                remember(swarms, b, lane, i, reached, fitness)
        return stream, tally

    return iterate
