"""Differential evolution with a memory of what was successful, L-SHADE.

Source: R. Tanabe, A. S. Fukunaga, "Improving the search performance of SHADE using linear population size
reduction", IEEE CEC 2014; mutation and archive come from J. Zhang, A. C. Sanderson, "JADE: adaptive
differential evolution with optional external archive", IEEE Transactions on Evolutionary Computation 13(5),
2009. The population size is decided from outside: the linear reduction of the paper is the controller
`lpsr`, and `nlpsr` is a later one. Readings are listed in docs/readings.md.

A generation makes one trial of each member. The scale factor F of a trial comes from a Cauchy distribution,
and its crossover rate CR from a normal one. Both are around an entry of the memory. Factors and rates of the
trials that improved on their member enter the memory, and the members that they replace enter the archive.
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import logarithm, sine_of_quarters
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, Parameters
from swarm_gym.population import Swarms, Workspace, evaluate_path, is_spent
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import Table, Tables, repair

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

LONGEST_MEMORY = 100  # entries that the state has room for
LARGEST_ARCHIVE_RATE = 3  # archived vectors for each member that it has room for
WIDTH = 0.1  # scale of the Cauchy distribution, and standard deviation of the normal one
FIRST_ENTRY = 0.5  # scale factor and crossover rate that the memory begins with
TERMINAL = -1.0  # entry of the crossover rate that stands for 0 from then on
FEWEST_BEST = 2

# Columns of `Swarms.field`: means of the memory and the share of the archive that is filled, as of the last
# iteration; then the entries of the memory.
MEAN_FACTOR, MEAN_CROSSOVER, ARCHIVE_USE, FACTORS = range(4)
CROSSOVERS = FACTORS + LONGEST_MEMORY
# Columns of `Swarms.registers`: entry of the memory that is replaced next, and number of archived vectors.
NEXT_ENTRY, ARCHIVED = range(2)


class DifferentialEvolutionParameters(NamedTuple):
    """Parameters of differential evolution."""

    best_share: Annotated[
        float,
        Parameter(
            0.11, 0.0, 1.0, "p", "share of the best members that trials move to, at least two", (0.02, 0.5)
        ),
    ]
    memory_length: Annotated[
        float,
        Parameter(6.0, 1.0, float(LONGEST_MEMORY), "H", "entries of the memory, rounded", (1.0, 32.0)),
    ]
    archive_rate: Annotated[
        float,
        Parameter(
            2.6,
            0.0,
            float(LARGEST_ARCHIVE_RATE),
            "r_arc",
            "largest archive, in population sizes",
            (0.1, float(LARGEST_ARCHIVE_RATE)),
        ),
    ]


@kernel
def iterate(
    parameters: DifferentialEvolutionParameters,
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    repair_degree: float,
) -> None:
    """Advance swarm `b` by one generation; when the budget is spent, the remaining members have no trials."""
    size = swarms.size[b]
    parents, fitness = swarms.positions[b, :size].copy(), swarms.fitness[b, :size].copy()
    best = _best_members(fitness, math.floor(parameters.best_share * size + 0.5))
    limit = math.floor(parameters.archive_rate * size + 0.5)
    length = math.floor(parameters.memory_length + 0.5)
    archive = _archive(swarms, b)
    _trim_archive(swarms, b, work, archive, limit)
    factors, rates, gains = np.zeros(size), np.zeros(size), np.zeros(size)
    for i in range(size):
        if is_spent(swarms, b):
            break
        factors[i], rates[i] = _make_trial(swarms, b, table, work, parents, archive, best, i, length)
        if repair_degree > 0.0:
            repair(table, work.path, repair_degree)
        found, collision = evaluate_path(swarms, b, table, work)
        if found <= fitness[i]:
            gains[i] = fitness[i] - found
            swarms.fitness[b, i], swarms.collision[b, i] = found, collision
            for k in range(parents.shape[1]):
                swarms.positions[b, i, k] = work.path[k + 1]
    _archive_parents(swarms, b, work, archive, parents, gains, limit)
    _remember(swarms, b, factors, rates, gains, length)
    _summarise(swarms, b, limit, length)


@kernel
def _best_members(fitness: Floats, count: int) -> Integers:
    """Return the numbers of so many members with the best fitness, at least two; ties go to the earlier."""
    size = fitness.shape[0]
    count = min(max(count, FEWEST_BEST), size)
    best, known = np.empty(count, dtype=np.int64), 0
    for i in range(size):
        if known < count or fitness[i] < fitness[best[count - 1]]:
            at = min(known, count - 1)
            while at > 0 and fitness[i] < fitness[best[at - 1]]:
                best[at] = best[at - 1]
                at -= 1
            best[at] = i
            known = min(known + 1, count)
    return best


@kernel(borrows=True)
def _make_trial(
    swarms: Swarms,
    b: int,
    table: Table,
    work: Workspace,
    parents: Floats,
    archive: Floats,
    best: Integers,
    i: int,
    length: int,
) -> tuple[float, float]:
    """Write the trial of member i into `work.path`; return its scale factor and crossover rate.

    Mutation is current-to-pbest/1, crossover is binomial. A component beyond a bound is put midway between
    the bound and the member.
    """
    stream, noise, path = swarms.stream[b], work.noise, work.path
    fill_uniform(stream, noise)
    entry = int(noise[0] * length)
    rate = _crossover_rate(swarms.field[b, CROSSOVERS + entry], noise[1], noise[2])
    factor = _scale_factor(swarms.field[b, FACTORS + entry], noise[3])
    towards = parents[best[int(noise[4] * best.shape[0])]]
    size, archived = parents.shape[0], swarms.registers[b, ARCHIVED]
    first, second = _draw_others(size, archived, i, noise[5], noise[6])
    certain = int(noise[7] * table.dimension)
    while factor <= 0.0:
        fill_uniform(stream, noise)
        factor = _scale_factor(swarms.field[b, FACTORS + entry], noise[0])
    member, plus = parents[i], parents[first]
    minus = parents[second] if second < size else archive[second - size]
    fill_uniform(stream, noise)
    for k in range(parents.shape[1]):
        wanted = member[k]
        if noise[k] < rate or k == certain:
            wanted += factor * (towards[k] - member[k]) + factor * (plus[k] - minus[k])
            if wanted < table.lower[k]:
                wanted = 0.5 * (table.lower[k] + member[k])
            elif wanted > table.upper[k]:
                wanted = 0.5 * (table.upper[k] + member[k])
        path[k + 1] = wanted
    return factor, rate


@kernel
def _crossover_rate(entry: float, first: float, second: float) -> float:
    """Return a normal number around an entry of the memory, clipped to [0, 1], of two uniform numbers."""
    if entry == TERMINAL:
        return 0.0
    radius = math.sqrt(-2.0 * logarithm(1.0 - first))  # Box and Muller
    return min(max(entry + WIDTH * radius * sine_of_quarters(2.0 * math.pi * second, 1), 0.0), 1.0)


@kernel(inline="late")
def _scale_factor(entry: float, share: float) -> float:
    """Return a Cauchy number around an entry of the memory, at most 1, of a uniform number."""
    sine = sine_of_quarters(math.pi * share, 0)
    if sine == 0.0:
        return 1.0
    return min(entry + WIDTH * sine_of_quarters(math.pi * share, 1) / sine, 1.0)


@kernel
def _draw_others(size: int, archived: int, i: int, first: float, second: float) -> tuple[int, int]:
    """Return the number of a member, and of another member or, from `size` on, an archived vector.

    Both differ from member i and from each other. Where there are too few, both are member i.
    """
    if size < 2 or size + archived < 3:
        return i, i
    one = int(first * (size - 1))
    if one >= i:
        one += 1
    other = int(second * (size + archived - 2))
    if other >= min(i, one):
        other += 1
    if other >= max(i, one):
        other += 1
    return one, other


@kernel
def _archive(swarms: Swarms, b: int) -> Floats:
    """Return the rows of the archive of swarm `b`, a view; it has several for each member."""
    rows, width = swarms.memory.shape[1] * LARGEST_ARCHIVE_RATE, swarms.positions.shape[2]
    return swarms.memory[b].reshape((rows, width))


@kernel
def _trim_archive(swarms: Swarms, b: int, work: Workspace, archive: Floats, limit: int) -> None:
    """Delete archived vectors at random until there are no more than the limit."""
    while swarms.registers[b, ARCHIVED] > limit:
        fill_uniform(swarms.stream[b], work.noise)
        count = swarms.registers[b, ARCHIVED]
        archive[int(work.noise[0] * count)] = archive[count - 1]
        swarms.registers[b, ARCHIVED] = count - 1


@kernel
def _archive_parents(
    swarms: Swarms,
    b: int,
    work: Workspace,
    archive: Floats,
    parents: Floats,
    gains: Floats,
    limit: int,
) -> None:
    """Archive the members that better trials replaced; a full archive loses vectors at random."""
    if limit == 0:
        return
    for i in range(gains.shape[0]):
        if gains[i] > 0.0:
            row = swarms.registers[b, ARCHIVED]
            if row < limit:
                swarms.registers[b, ARCHIVED] = row + 1
            else:
                fill_uniform(swarms.stream[b], work.noise)
                row = int(work.noise[0] * limit)
            archive[row] = parents[i]


@kernel
def _remember(swarms: Swarms, b: int, factors: Floats, rates: Floats, gains: Floats, length: int) -> None:
    """Replace an entry of the memory by weighted Lehmer means of the factors and rates that improved."""
    total, highest = gains.sum(), 0.0
    if not total > 0.0:
        return
    factor, factor_squared, rate, rate_squared = 0.0, 0.0, 0.0, 0.0
    for i in range(gains.shape[0]):
        if gains[i] > 0.0:
            weight = gains[i] / total
            factor += weight * factors[i]
            factor_squared += weight * factors[i] * factors[i]
            rate += weight * rates[i]
            rate_squared += weight * rates[i] * rates[i]
            highest = max(highest, rates[i])
    memory, entry = swarms.field[b], swarms.registers[b, NEXT_ENTRY] % length
    memory[FACTORS + entry] = factor_squared / factor
    if memory[CROSSOVERS + entry] == TERMINAL or highest == 0.0:
        memory[CROSSOVERS + entry] = TERMINAL
    else:
        memory[CROSSOVERS + entry] = rate_squared / rate
    swarms.registers[b, NEXT_ENTRY] = (entry + 1) % length


@kernel
def _summarise(swarms: Swarms, b: int, limit: int, length: int) -> None:
    """Write the means of the memory, where the terminal value is 0, and the use of the archive."""
    memory = swarms.field[b]
    factor, crossover = 0.0, 0.0
    for entry in range(length):
        factor += memory[FACTORS + entry]
        crossover += max(memory[CROSSOVERS + entry], 0.0)
    memory[MEAN_FACTOR], memory[MEAN_CROSSOVER] = factor / length, crossover / length
    memory[ARCHIVE_USE] = swarms.registers[b, ARCHIVED] / limit if limit > 0 else 0.0


@kernel
def _forget(swarms: Swarms, b: int) -> None:
    """Let the memory of swarm `b` have its first entries, and the archive no vectors."""
    swarms.field[b, :] = FIRST_ENTRY
    swarms.field[b, ARCHIVE_USE] = 0.0
    swarms.registers[b, :] = 0


@kernel
def begin(parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int) -> None:
    """Begin swarm `b` with drawn members, and nothing remembered."""
    loop.draw_population(parameters, swarms, b, table, work, size)
    _forget(swarms, b)


@kernel
def adopt(parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int) -> None:
    """Begin swarm `b` with given members, and nothing remembered."""
    loop.adopt_population(parameters, swarms, b, table, work, size)
    _forget(swarms, b)


@kernel
def change_size(
    parameters: Parameters, swarms: Swarms, b: int, table: Table, work: Workspace, size: int
) -> None:
    """Grow or shrink swarm `b`; the next generation trims the archive, stored next to the members."""
    archived = swarms.registers[b, ARCHIVED]
    kept = _archive(swarms, b)[:archived].copy()
    loop.resize_population(parameters, swarms, b, table, work, size)
    _archive(swarms, b)[:archived] = kept


class DifferentialEvolution(Optimizer):
    """L-SHADE, whose population size is decided from outside."""

    name = "differential-evolution"
    parameter_class = DifferentialEvolutionParameters
    smallest_population = 4
    default_options: ClassVar[Mapping[str, object]] = {"min_population_size": 4}
    kernels = loop.Kernels(iterate, begin, adopt, change_size)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[Floats]:
        """Return the positions, the best so far, and the archived vectors."""
        archive = swarms.memory[row].reshape(-1, swarms.positions.shape[2])
        archived = archive[: swarms.registers[row, ARCHIVED], :dimension]
        return [*Optimizer.decision_vectors(swarms, row, dimension), archived]

    @staticmethod
    def memory_columns(dimension: int) -> int:
        """Return the number of columns of the archived vectors that a member has room for."""
        return LARGEST_ARCHIVE_RATE * columns(dimension)

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """Return the number of registers: the next entry of the memory, and how many vectors are archived."""
        return ARCHIVED + 1

    @staticmethod
    def field_size(tables: Tables) -> int:  # noqa: ARG004
        """Return the number of means and entries of the memory."""
        return CROSSOVERS + LONGEST_MEMORY
