"""The firefly algorithm on the device; `swarm_gym.optimizers.firefly` says what it does and cites it."""

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
from swarm_gym.gpu.warps import HALF, exponential, kernel, maximum, minimum, natural, total
from swarm_gym.optimizers.firefly import FireflyParameters
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Tables

# Columns of the parameters of a swarm.
_NOISE, _ATTRACTIVENESS, _ABSORPTION = map(
    FireflyParameters._fields.index, ("noise", "attractiveness", "absorption")
)


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
        """Advance swarm `b` by one iteration; end early if the evaluation budget is spent."""
        width = parameters[b, _NOISE]
        attractiveness, absorption = parameters[b, _ATTRACTIVENESS], parameters[b, _ABSORPTION]
        lower, upper, budget = tables.lower[p, lane], tables.upper[p, lane], swarms.budget[b]
        rounds = num_rounds(tables, p)
        for i in range(size):
            place = swarms.positions[b, i, lane]
            fitness, collision = swarms.fitness[b, i], swarms.collision[b, i]
            for j in range(size):
                if j != i and swarms.fitness[b, natural(j)] < fitness:
                    if tally.evaluations >= budget:
                        break
                    drawn, stream = draw(stream, lane, rounds)
                    number = swarms.positions.dtype.type(drawn)
                    difference = swarms.positions[b, natural(j), lane] - place
                    decay = exponential(-absorption * total(difference * difference))
                    attraction = attractiveness * decay  # eq. 13, 14
                    moved = place + attraction * difference + width * (number - HALF)  # eq. 15
                    place = minimum(maximum(moved, lower), upper)
                    if repair_degree > 0.0:
                        place = repair(tables, p, lane, place, repair_degree)
                    fitness, collision, tally = evaluate_path(swarms, b, tables, p, lane, place, tally)
            store_member(swarms, b, lane, i, place, fitness, collision)
        return stream, tally

    return iterate
