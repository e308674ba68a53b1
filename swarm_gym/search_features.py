"""Features by which functions are told apart: how a search with a distribution or a memory of itself goes on.

They are read from the state of CMA-ES and of differential evolution. Fitness enters through its order, and
through ratios of differences. Lengths are in ranges of the initial bounds. So the features stay as they are
if fitness is shifted or scaled, or if the box is. A number that an optimizer does not have is 0.
"""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import log, log1p, power
from swarm_gym.features import (
    LOG_TEN,
    RESTARTS,
    SCALED,
    SHARE_SPENT,
    Feature,
    log_size,
    spent_share,
)
from swarm_gym.history import COLUMN
from swarm_gym.optimizers.cma_es import state as cma
from swarm_gym.optimizers.cma_es.cma_es import CmaEs
from swarm_gym.optimizers.cma_es.movement import BETA, LONGEST
from swarm_gym.optimizers.cma_es.rates import write_weights
from swarm_gym.optimizers.differential_evolution import (
    ARCHIVE_USE,
    MEAN_CROSSOVER,
    MEAN_FACTOR,
    DifferentialEvolution,
)
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

GENERATIONS = 10  # generations over which shares and gains are measured
LONGEST_WAIT = 63  # generations since the best improved; longer ones are seen as this one
STEP_DECADES = 6.0  # decades of the step size, relative to the first one, that a 1 stands for
# Names of the features by which the rule `early-restarts` decides.
LOG_STEP = "log10(step size / first step size) / 6"
WAIT = f"log(1 + generations since the best improved), relative to that of {LONGEST_WAIT}"


def can_search(simulation: Simulation) -> bool:
    """Return whether the optimizer has a state that these features read."""
    return issubclass(simulation.optimizer, CmaEs | DifferentialEvolution)


def _is_cma(simulation: Simulation) -> bool:
    return issubclass(simulation.optimizer, CmaEs)


def _of_cma(values: Callable[[Simulation], Floats]) -> Callable[[Simulation], Floats]:
    """Return a feature that is 0 for other optimizers than CMA-ES, and before the first reset."""

    def found(simulation: Simulation) -> Floats:
        if not _is_cma(simulation):
            return simulation.full(0.0)
        return np.where(simulation.swarms.size > 0, values(simulation), 0.0)

    return found


def _of_evolution(column: int) -> Callable[[Simulation], Floats]:
    """Return a feature that is a column of `Swarms.field` of differential evolution, and 0 for others."""

    def found(simulation: Simulation) -> Floats:
        if not issubclass(simulation.optimizer, DifferentialEvolution):
            return simulation.full(0.0)
        return simulation.swarms.field[:, column]

    return found


def _log_step(simulation: Simulation) -> Floats:
    """Return (B,) log10(step size / first one) / 6."""
    first = simulation.parameters[:, list(simulation.optimizer.parameters).index("first_step")]
    step = simulation.swarms.field[:, cma.STEP_SIZE]
    return np.clip(log(np.where(step > 0.0, step / first, 1.0)) / (STEP_DECADES * LOG_TEN), -2.5, 1.0)


@cache
def _step_rate(size: int, dimension: int) -> float:
    """Return c_sigma / d_sigma of a generation."""
    rates = write_weights(np.empty(max(size, 1)), dimension)
    return rates.step_rate / rates.damping


def _step_trend(simulation: Simulation) -> Floats:
    """Return (B,) the logarithm of the factor by which the evolution path has changed the step size last."""
    swarms = simulation.swarms
    rates = np.array([_step_rate(size, simulation.dimension) for size in swarms.size.tolist()])
    change = rates * (swarms.field[:, cma.PATH_LENGTH] - 1.0)
    return np.clip(np.where(swarms.registers[:, cma.GENERATION] > 0, change, 0.0), -1.0, 1.0)


def _log_condition(simulation: Simulation) -> Floats:
    """Return (B,) log10(condition number of the covariance) / 7."""
    condition = np.maximum(simulation.swarms.field[:, cma.CONDITION], 1.0)
    return np.minimum(log(condition) / (7.0 * LOG_TEN), 2.0)


def _path_length(simulation: Simulation) -> Floats:
    return np.minimum(simulation.swarms.field[:, cma.PATH_LENGTH], 3.0)


def _recent_bests(simulation: Simulation, count: int) -> Floats:
    """Return (B, count) the best fitness after the last iterations, the present one first."""
    iterations = np.maximum(simulation.iteration[:, None] - np.arange(count), 0)
    return simulation.history[simulation.rows[:, None], iterations, COLUMN.best_fitness]


def _success_share(simulation: Simulation) -> Floats:
    """Return (B,) the share of the last generations that improved the best fitness."""
    best = _recent_bests(simulation, GENERATIONS + 1)
    improved = (best[:, :-1] < best[:, 1:]).sum(axis=1)
    return improved / np.clip(simulation.iteration, 1, GENERATIONS)


def _wait(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + generations since the best fitness improved), relative to the longest wait."""
    best = _recent_bests(simulation, LONGEST_WAIT + 1)
    improved = best[:, :-1] < best[:, 1:]
    none = np.minimum(simulation.iteration, LONGEST_WAIT)
    since = np.where(improved.any(axis=1), improved.argmax(axis=1), none)
    return scaled_wait(since.astype(np.float64))


def scaled_wait(generations: Floats | float) -> Floats:
    """Return generations since the best improved as they are observed: 1 is the longest wait."""
    return log1p(generations) / float(log1p(LONGEST_WAIT))


def _medians(simulation: Simulation) -> tuple[Floats, NDArray[np.int64]]:
    """Return (B, k) median fitness of the last generations of CMA-ES, the last one first.

    Returns:
        Also (B,) how many generations before the last one are known, at most k - 1. Where fewer are known,
        the oldest one stands for those before it.
    """
    swarms = simulation.swarms
    first = cma.layout(swarms.positions.shape[2]).medians
    known = np.clip(swarms.registers[:, cma.RECORDED] - 1, 0, GENERATIONS)
    ages = np.minimum(np.arange(GENERATIONS + 1), known[:, None])
    places = (swarms.registers[:, cma.RECORDED, None] - 1 - ages) % cma.LONGEST_HISTORY
    return swarms.field[simulation.rows[:, None], first + places], known


def _ruggedness(simulation: Simulation) -> Floats:
    """Return (B,) the share of the last generations whose median fitness is worse than the one before."""
    medians, known = _medians(simulation)
    return (medians[:, :-1] > medians[:, 1:]).sum(axis=1) / np.maximum(known, 1)


def _gain_per_spread(simulation: Simulation) -> Floats:
    """Return (B,) the gain of the last generations per spread of fitness, as x / (1 + |x|).

    The gain is taken of the median fitness. Differential evolution keeps no medians, but never loses its best
    member: there it is taken of the best.
    """
    swarms = simulation.swarms
    if _is_cma(simulation):
        medians, _ = _medians(simulation)
        gain = medians[:, -1] - medians[:, 0]
        spread = swarms.field[:, cma.GENERATION_MEDIAN] - swarms.field[:, cma.GENERATION_BEST]
    else:
        best = _recent_bests(simulation, GENERATIONS + 1)
        gain = best[:, -1] - best[:, 0]
        spread = _median_above_best(simulation)
    whole = np.abs(gain) + spread
    return np.divide(gain, whole, out=np.zeros_like(gain), where=whole > 0.0)


def _median_above_best(simulation: Simulation) -> Floats:
    """Return (B,) median minus best fitness of the members; 0 before the first reset."""
    swarms = simulation.swarms
    alive = np.arange(swarms.fitness.shape[1]) < swarms.size[:, None]
    ranked = np.sort(np.where(alive, swarms.fitness, np.inf), axis=1)
    middle = 0.5 * (
        ranked[simulation.rows, np.maximum(swarms.size - 1, 0) // 2]
        + ranked[simulation.rows, np.minimum(swarms.size // 2, ranked.shape[1] - 1)]
    )
    found = swarms.size > 0
    return np.where(found, middle, 0.0) - np.where(found, ranked[:, 0], 0.0)


def _feature(
    name: str, values: Callable[[Simulation], Floats], low: float = 0.0, high: float = 1.0
) -> Feature:
    return Feature(name, values, lambda _: high, low, needs_search=True)


# The fourth is the iteration, as in other layouts.
SEARCH = (
    _feature(LOG_STEP, _of_cma(_log_step), -2.5),
    _feature("log factor of the step size in the last generation", _of_cma(_step_trend), -1.0),
    _feature("log10(condition number of the covariance) / 7", _of_cma(_log_condition), high=2.0),
    SCALED[3],
    _feature("length of the evolution path, relative to its expectation", _of_cma(_path_length), high=3.0),
    _feature(f"share of the last {GENERATIONS} generations that improved the best", _success_share),
    _feature(f"share of the last {GENERATIONS} generations whose median got worse", _of_cma(_ruggedness)),
    _feature(
        f"gain over {GENERATIONS} generations per spread of the fitness, as x / (1 + |x|)",
        _gain_per_spread,
        -1.0,
    ),
    _feature(WAIT, _wait),
    _feature(SHARE_SPENT, spent_share),
    _feature("log population size, relative to that of the largest", log_size),
    _feature("mean scale factor in the memory", _of_evolution(MEAN_FACTOR)),
    _feature("mean crossover rate in the memory", _of_evolution(MEAN_CROSSOVER)),
    _feature("share of the archive that is filled", _of_evolution(ARCHIVE_USE)),
)

# Names of the features by which the rule `psa` follows the distribution.
MOVEMENT, MOVEMENT_EXPECTED = "squared length of the movement's path", "the same where selection is random"
DIMENSION = "dimension of the decision vectors"


def _movement(simulation: Simulation) -> Floats:
    return simulation.swarms.field[:, cma.MOVEMENT]


def _movement_expected(simulation: Simulation) -> Floats:
    """Return (B,) gamma_theta: 0 after a restart, and soon 1."""
    generations = simulation.swarms.registers[:, cma.GENERATION]
    return 1.0 - power((1.0 - BETA) ** 2, generations.astype(np.float64))


# How far the distribution of CMA-ES moves, see `swarm_gym.optimizers.cma_es.movement`.
DISTRIBUTION = (
    *RESTARTS,
    _feature(MOVEMENT, _of_cma(_movement), high=LONGEST),
    _feature(MOVEMENT_EXPECTED, _of_cma(_movement_expected)),
    Feature(
        DIMENSION,
        lambda simulation: simulation.full(float(simulation.dimension)),
        lambda simulation: float(simulation.dimension),
        needs_search=True,
    ),
)
