"""The history of episodes: what a simulation records of each swarm after every iteration."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import POPULATION_COLLISION, Swarms
from swarm_gym.settings import Settings
from swarm_gym.sources import SOURCE_DECISIONS

Floats = NDArray[np.float64]


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


def columns_of(optimizer: type[Optimizer], settings: Settings) -> tuple[str, ...]:
    """Return the names of the columns: `HISTORY`, the optimizer's parameters, and decisions on sources."""
    decided = SOURCE_DECISIONS if settings.decides_sources else ()
    return (*HISTORY, *optimizer.parameters, *decided)


def write_state(
    rows: Floats,
    swarms: Swarms,
    feasible_fitness: Floats,
    repair_degrees: Floats | float,
    parameters: Floats,
) -> None:
    """Write the present state of B swarms.

    Args:
        rows: (B, columns) array that is written.
        swarms: the swarms.
        feasible_fitness: (B,) fitness of the best feasible paths.
        repair_degrees: phi of the last iteration, for all swarms or (B,).
        parameters: (B, n) parameters of the optimizer in the last iteration.
    """
    rows[:, COLUMN.population_collision] = swarms.summary[:, POPULATION_COLLISION]
    rows[:, COLUMN.population_size] = swarms.size
    rows[:, COLUMN.repair_degree] = repair_degrees
    rows[:, COLUMN.best_fitness] = swarms.best_fitness
    rows[:, COLUMN.evaluations] = swarms.evaluations
    rows[:, COLUMN.best_collision] = swarms.best_collision
    rows[:, COLUMN.feasible_fitness] = feasible_fitness
    last = len(HISTORY) + parameters.shape[1]
    rows[:, len(HISTORY) : last] = parameters
    rows[:, last:] = swarms.source[:, : rows.shape[1] - last]
