"""The history of episodes: what a simulation records of each swarm after every iteration."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import POPULATION_COLLISION, Swarms
from swarm_gym.settings import Settings
from swarm_gym.sources import SOURCE_DECISIONS

Floats = NDArray[np.float64]


class Recorded(NamedTuple):
    """The state of B swarms after an iteration, arrays (B,): the first columns of every history.

    The optimizer's parameters follow.
    """

    population_collision: Floats
    population_size: NDArray[np.int64]
    repair_degree: Floats | float
    best_fitness: Floats
    evaluations: NDArray[np.int64]
    best_collision: Floats
    feasible_fitness: Floats


HISTORY = Recorded._fields


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
    recorded = Recorded(
        population_collision=swarms.summary[:, POPULATION_COLLISION],
        population_size=swarms.size,
        repair_degree=repair_degrees,
        best_fitness=swarms.best_fitness,
        evaluations=swarms.evaluations,
        best_collision=swarms.best_collision,
        feasible_fitness=feasible_fitness,
    )
    for column, values in enumerate(recorded):
        rows[:, column] = values
    last = len(HISTORY) + parameters.shape[1]
    rows[:, len(HISTORY) : last] = parameters
    rows[:, last:] = swarms.source[:, : rows.shape[1] - last]
