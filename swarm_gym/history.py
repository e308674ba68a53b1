"""The history of episodes: what a simulation records of each swarm after every iteration."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import namespace_of
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import POPULATION_COLLISION, Swarms, feasible_fitness_of, is_spent
from swarm_gym.settings import Settings
from swarm_gym.sources import SOURCE_DECISIONS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]


class Columns(NamedTuple):
    """The numbers of the first columns of every history; the optimizer's parameters follow."""

    population_collision: int
    population_size: int
    repair_degree: int
    best_fitness: int
    evaluations: int
    best_collision: int
    feasible_fitness: int


HISTORY = Columns._fields
COLUMN = Columns(*range(len(HISTORY)))
_NUM_COLUMNS = len(HISTORY)


def columns_of(optimizer: type[Optimizer], settings: Settings) -> tuple[str, ...]:
    """Return the names of the columns: `HISTORY`, the optimizer's parameters, and decisions on sources."""
    decided = SOURCE_DECISIONS if settings.decides_sources else ()
    return (*HISTORY, *optimizer.parameters, *decided)


def record(
    history: Floats,
    rows: Integers,
    chosen: Flags,
    swarms: Swarms,
    feasible_fitness: Floats,
    repair_degrees: Floats,
    parameters: Floats,
) -> None:
    """Write the present state of the chosen swarms, on the arrays of any library, see `swarm_gym.arrays`.

    Args:
        history: (B, iterations + 1, columns) array that is written.
        rows: (B,) numbers of the swarms, 0 to B - 1.
        chosen: (B,) swarms that are recorded.
        swarms: the swarms.
        feasible_fitness: (B,) fitness of the best feasible paths.
        repair_degrees: (B,) phi of the last iteration.
        parameters: (B, n) parameters of the optimizer in the last iteration.
    """
    xp = namespace_of(history)
    if xp is np:
        _record_chosen(history, chosen, swarms, feasible_fitness, repair_degrees, parameters)
        return
    old = history[rows, swarms.iteration]
    new = xp.empty_like(old)
    new[:, COLUMN.population_collision] = swarms.summary[:, POPULATION_COLLISION]
    new[:, COLUMN.population_size] = swarms.size
    new[:, COLUMN.repair_degree] = repair_degrees
    new[:, COLUMN.best_fitness] = swarms.best_fitness
    new[:, COLUMN.evaluations] = swarms.evaluations
    new[:, COLUMN.best_collision] = swarms.best_collision
    new[:, COLUMN.feasible_fitness] = feasible_fitness
    last = _NUM_COLUMNS + parameters.shape[1]
    new[:, _NUM_COLUMNS:last] = parameters
    new[:, last:] = swarms.source[:, : new.shape[1] - last]
    history[rows, swarms.iteration] = xp.where(chosen[:, None], new, old)


@entry
def _record_chosen(
    history: Floats,
    chosen: Flags,
    swarms: Swarms,
    feasible_fitness: Floats,
    repair_degrees: Floats,
    parameters: Floats,
) -> None:
    """Do what `record` does, on NumPy arrays."""
    for b in range(chosen.shape[0]):
        if chosen[b]:
            _record_swarm(history, b, swarms, feasible_fitness[b], repair_degrees[b], parameters)


@kernel(borrows=True)
def _record_swarm(
    history: Floats, b: int, swarms: Swarms, feasible_fitness: float, repair_degree: float, parameters: Floats
) -> None:
    """Write the present state of swarm `b`, see `record`."""
    last = _NUM_COLUMNS + parameters.shape[1]
    row = history[b, swarms.iteration[b]]
    row[COLUMN.population_collision] = swarms.summary[b, POPULATION_COLLISION]
    row[COLUMN.population_size] = swarms.size[b]
    row[COLUMN.repair_degree] = repair_degree
    row[COLUMN.best_fitness] = swarms.best_fitness[b]
    row[COLUMN.evaluations] = swarms.evaluations[b]
    row[COLUMN.best_collision] = swarms.best_collision[b]
    row[COLUMN.feasible_fitness] = feasible_fitness
    for k in range(_NUM_COLUMNS, last):
        row[k] = parameters[b, k - _NUM_COLUMNS]
    for k in range(last, row.shape[0]):
        row[k] = swarms.source[b, k - last]


@entry
def end_iteration(
    history: Floats,
    chosen: Flags,
    swarms: Swarms,
    running: Flags,
    targets: Floats,
    repair_degrees: Floats,
    parameters: Floats,
) -> None:
    """Count an iteration of the chosen swarms, record it, and end episodes; no event follows on it.

    Args:
        history: (B, iterations + 1, columns) array that is written.
        chosen: (B,) swarms that have been advanced.
        swarms: the swarms; their `iteration` is written.
        running: (B,) whether an episode is under way, which is written.
        targets: (problems,) fitness at which an episode ends.
        repair_degrees: (B,) phi of the iteration.
        parameters: (B, n) parameters of the optimizer in the iteration.
    """
    for b in range(chosen.shape[0]):
        if chosen[b]:
            swarms.iteration[b] += 1
            _record_swarm(history, b, swarms, feasible_fitness_of(swarms, b), repair_degrees[b], parameters)
            if (
                swarms.iteration[b] >= swarms.iterations[b]
                or is_spent(swarms, b)
                or swarms.best_fitness[b] <= targets[swarms.problem[b]]
            ):
                running[b] = False


def forget(history: Floats, rows: Integers, swarms: Swarms) -> None:
    """Fill the record of swarms with NaN, before their iterations are counted from 0 again.

    In NumPy's arrays, only what their last episodes wrote is filled: the record of a long one is large.

    Args:
        history: (B, iterations + 1, columns) array that is written.
        rows: (k,) numbers of the swarms.
        swarms: the swarms; one without members has had no episode.
    """
    if namespace_of(history) is not np:
        history[rows] = np.nan
        return
    _forget_rows(history, rows, swarms.size, swarms.iteration)


@entry
def _forget_rows(history: Floats, rows: Integers, size: Integers, iteration: Integers) -> None:
    """Do what `forget` does, on NumPy arrays."""
    for b in rows:
        written = history.shape[1] if size[b] == 0 else iteration[b] + 1
        history[b, :written] = np.nan
