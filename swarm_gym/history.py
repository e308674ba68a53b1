"""The history of episodes: what a simulation records of each swarm after every iteration."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import POPULATION_COLLISION, Swarms
from swarm_gym.settings import Settings
from swarm_gym.sources import SOURCE_DECISIONS

Floats = NDArray[np.float64]

# The first columns of every history; the optimizer's parameters follow.
HISTORY = (
    "population_collision",
    "population_size",
    "repair_degree",
    "best_fitness",
    "evaluations",
    "best_collision",
    "feasible_fitness",
)


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
    rows[:, 0] = swarms.summary[:, POPULATION_COLLISION]
    rows[:, 1] = swarms.size
    rows[:, 2] = repair_degrees
    rows[:, 3] = swarms.best_fitness
    rows[:, 4] = swarms.evaluations
    rows[:, 5] = swarms.best_collision
    rows[:, 6] = feasible_fitness
    last = len(HISTORY) + parameters.shape[1]
    rows[:, len(HISTORY) : last] = parameters
    rows[:, last:] = swarms.source[:, : rows.shape[1] - last]
