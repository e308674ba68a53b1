"""Features of swarms: numbers by which a controller sees them, with their bounds.

`swarm_gym.observation` makes layouts of them. Features that the paper lacks are scaled by fixed
numbers, so there are no running statistics to store. Features work on the arrays of any library, see
`swarm_gym.arrays`; those that need paths work on NumPy arrays only.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import at_least, divided, floats
from swarm_gym.compiler.elementary import exp, log, log1p
from swarm_gym.corridors import KnownCorridors
from swarm_gym.history import COLUMN
from swarm_gym.population import (
    COLLISION_DEVIATION,
    DIVERSITY,
    FEASIBLE_SHARE,
    MEAN_COLLISION,
    POPULATION_COLLISION,
)
from swarm_gym.problem.onemax.table import OneMaxTable, count_ones
from swarm_gym.scenarios.onemax import SIZES
from swarm_gym.simulation import Simulation
from swarm_gym.sources import BECAME_BEST, BEST_SMOOTH

Floats = NDArray[np.float64]

RECENT = 5  # number of iterations over which recent progress is measured, and newcomers are watched
# Optimizers that the layout `named` tells apart. A policy has an input for each, so the list does not grow
# with the package: an optimizer that is not in it has 0 everywhere.
TOLD_APART = (
    "firefly", "generational-firefly", "particle-swarm", "elite-genetic", "multivariate", "fish-swarm",
    "improved-fish-swarm", "hybrid-fish-swarm", "glowworm", "ant-colony",
)  # fmt: skip
# Name of a feature, and of what an optimizer counts for it (`Optimizer.counts`).
RESTARTS_SO_FAR, RESTARTS_COUNTED = "restarts in this episode", "restarts"
SHARE_SPENT = "share of the evaluation budget spent"
NO_GOOD_NEWCOMER = 4.0  # log(gap of a newcomer / gap) of a bad _one, or of none


@dataclass(frozen=True)
class Feature:
    """One number per swarm, with finite bounds.

    Attributes:
        name: description of the number.
        values: function that returns the numbers of all swarms, shape (B,).
        high: function that returns the upper bound.
        low: lower bound.
        arrival_window: number of iterations whose new members the simulation must have recorded.
        needs_paths: whether members must be whole paths on a map.
        needs_bits: whether members must be bit strings.
        needs_restarts: whether the optimizer must count restarts.
        needs_search: whether the optimizer must be one of those that `swarm_gym.search_features` reads.
    """

    name: str
    values: Callable[[Simulation], Floats]
    high: Callable[[Simulation], float]
    low: float = 0.0
    arrival_window: int = 0
    needs_paths: bool = False
    needs_bits: bool = False
    needs_restarts: bool = False
    needs_search: bool = False


# Not computed, since the last digit would be that of the C library.
LOG_TEN = 2.302585092994046
_LOG_OF_LONGEST = 11.6  # above the logarithm of the longest bit string, 100,000


def _collision_bound(simulation: Simulation) -> float:
    return simulation.worlds.collision_bound


def _summary(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: simulation.swarms.summary[:, column]


def _log_scaled(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: log1p(simulation.swarms.summary[:, column], simulation.xp) / 8.0


def _log_bound(simulation: Simulation) -> float:
    return float(log1p(_collision_bound(simulation))) / 8.0


@cache
def _log_of_one_and(number: int) -> float:
    """Return log(1 + number); the same few numbers are asked for in every step."""
    return float(log1p(number))


def _log_extent(simulation: Simulation) -> float:
    """Return the bound of the scaled diversity.

    No member is farther from the mean than the workspace is wide.
    """
    extents = [math.sqrt(np.square(np.subtract(*problem.bounds)).sum()) for problem in simulation.problems]
    return float(log1p(max(extents))) / 8.0


def _clock(simulation: Simulation, iterations: NDArray[np.int64]) -> Floats:
    """Return log(1 + iterations), relative to its value at the end of an episode."""
    xp = simulation.xp
    return log1p(floats(xp, iterations), xp) / _log_of_one_and(simulation.settings.iterations)


def _log_progress(simulation: Simulation) -> Floats:
    """Return (B,) log(gap `RECENT` iterations ago, or at first, / gap now); 0 before the first reset."""
    xp, then = simulation.xp, at_least(simulation.xp, simulation.iteration - RECENT, 0)
    before = simulation.gaps.of(simulation.history[simulation.rows, then, COLUMN.best_fitness])
    now = simulation.gaps.now()
    return log(divided(xp, before, now, xp.isfinite(now), 1.0), xp)


def _log_relative_fitness(simulation: Simulation) -> Floats:
    """Return (B,) log(best fitness / lower bound).

    For test functions, whose lower bound is 0, it is log(1 + best fitness).
    """
    numbers = simulation.swarms.problem
    bound, unit = simulation.worlds.lower_bounds[numbers], simulation.worlds.gap_units[numbers]
    return log((simulation.swarms.best_fitness + (unit - bound)) / unit, simulation.xp)


def spent_share(simulation: Simulation) -> Floats:
    """Return (B,) the fraction of the evaluation budget that is spent; 0 without a budget."""
    if simulation.settings.max_evaluations is None:
        return simulation.full(0.0)
    return floats(simulation.xp, simulation.swarms.evaluations) / simulation.settings.max_evaluations


def _log_best_smooth(simulation: Simulation) -> Floats:
    """Return (B,) log(gap of the best smooth newcomer of the last `RECENT` iterations / gap), in [0, 4].

    It is 4 without such a newcomer.
    """
    xp = simulation.xp
    newcomer = simulation.gaps.of(xp.min(simulation.swarms.arrivals[:, BEST_SMOOTH], axis=1))
    none = float(exp(NO_GOOD_NEWCOMER))
    ratio = divided(xp, newcomer, simulation.gaps.now(), xp.isfinite(newcomer), none)
    return xp.clip(log(ratio, xp), 0.0, NO_GOOD_NEWCOMER)


def _became_best(simulation: Simulation) -> Floats:
    """Return (B,) x / (1 + x) of the number of newcomers of the last `RECENT` iterations that became best."""
    xp, swarms = simulation.xp, simulation.swarms
    # Nothing has been recorded before the first reset.
    counts = xp.where(swarms.size == 0, 0.0, xp.sum(swarms.arrivals[:, BECAME_BEST], axis=1))
    return counts / (1.0 + counts)


_KNOWN_CORRIDORS: WeakKeyDictionary[Simulation, KnownCorridors] = WeakKeyDictionary()


def _log_corridors(simulation: Simulation) -> Floats:
    """Return (B,) log(number of corridors that members are in) / log(largest population size).

    It is 0 before the first reset.
    """
    known = _KNOWN_CORRIDORS.setdefault(simulation, KnownCorridors())
    counts = np.ones(simulation.num_swarms)
    for row in np.flatnonzero(simulation.swarms.size).tolist():
        corridors = known.of(int(simulation.swarms.problem[row]), simulation.problem_of(row))
        counts[row] = corridors.count(simulation.positions(row))
    return log(counts) / float(log(max(simulation.settings.max_population_size, 2)))


def _last_rise(simulation: Simulation) -> tuple[NDArray[np.int64], Floats]:
    """Return (B,) the iteration after which the best fitness last rose, and the best after it / before it.

    The best fitness so far rises by events on the map only. Without a rise these are 0 and 1.
    """
    xp, rows, best = simulation.xp, simulation.rows, simulation.history[:, :, COLUMN.best_fitness]
    rose = best[:, 1:] > best[:, :-1] * (1.0 + 1e-9)  # False where nothing is recorded yet
    iterations = xp.arange(1, best.shape[1], device=simulation.device)
    when = xp.max(xp.where(rose, iterations, 0), axis=1)
    before, after = best[rows, at_least(xp, when - 1, 0)], best[rows, when]
    return when, divided(xp, after, before, when > 0, 1.0)


def _log_since_rise(simulation: Simulation) -> Floats:
    when, _ = _last_rise(simulation)
    return _clock(simulation, simulation.iteration - when)


def _log_rise(simulation: Simulation) -> Floats:
    _, ratio = _last_rise(simulation)
    return log(ratio, simulation.xp)


def _log_collision_ratio(simulation: Simulation, iteration: NDArray[np.int64] | int) -> Floats:
    """Return (B,) log((1 + E(P)) / (1 + E(P) after that iteration)) / 8; nan before the first reset."""
    before = simulation.history[simulation.rows, iteration, COLUMN.population_collision]
    now = simulation.swarms.summary[:, POPULATION_COLLISION]
    return log((1.0 + now) / (1.0 + before), simulation.xp) / 8.0


def _log_jump(simulation: Simulation) -> Floats:
    """Return (B,) the log ratio of E(P) to that one iteration before; 0 before the first iteration."""
    xp = simulation.xp
    jump = _log_collision_ratio(simulation, at_least(xp, simulation.iteration - 1, 0))
    return xp.where(xp.isnan(jump), 0.0, jump)


def _log_since_event(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + iterations since the last event) / log(1 + iterations of an episode)."""
    return _clock(simulation, simulation.iteration - simulation.worlds.begins[simulation.swarms.problem])


def _log_until_event(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + iterations until the next event) / log(1 + all iterations); 1 without one."""
    coming = simulation.worlds.next_event[simulation.swarms.problem]
    length = simulation.settings.iterations
    return _clock(simulation, simulation.xp.where(coming > 0, coming - simulation.iteration, length))


def log_size(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + population size), relative to its value at the largest size."""
    xp = simulation.xp
    largest = _log_of_one_and(simulation.settings.max_population_size)
    return log1p(floats(xp, simulation.swarms.size), xp) / largest


def _spent_of_reference(simulation: Simulation) -> Floats:
    """Return (B,) x / (1 + x) of the evaluations, relative to `Settings.reference_evaluations`."""
    spent = floats(simulation.xp, simulation.swarms.evaluations)
    return spent / (spent + simulation.settings.reference_evaluations)


def _log_price(simulation: Simulation) -> Floats:
    xp = simulation.xp
    return log(at_least(xp, simulation.prices.of_reference, 1e-4) / 0.1, xp) / (3.0 * LOG_TEN)


def _ones(simulation: Simulation) -> Floats:
    """Return (B,) numbers of ones; all before the first reset."""
    zeros = simulation.swarms.best_fitness
    xp = simulation.xp
    tables = simulation.worlds.tables
    if xp is np and isinstance(tables, OneMaxTable):
        return count_ones(tables.size, simulation.swarms.problem, zeros)
    return simulation.lengths() - xp.where(xp.isfinite(zeros), zeros, 0.0)


def _zeros(simulation: Simulation) -> Floats:
    """Return (B,) numbers of bits that are not set, at least 1."""
    return at_least(simulation.xp, simulation.lengths() - _ones(simulation), 1.0)


def _is_optimizer(name: str) -> Callable[[Simulation], Floats]:
    return lambda simulation: simulation.full(float(simulation.optimizer.name == name))


def _one(_: Simulation) -> float:
    return 1.0


PAPER = (
    Feature("population collision E(P)", _summary(POPULATION_COLLISION), _collision_bound),
    Feature("mean collision", _summary(MEAN_COLLISION), _collision_bound),
    Feature("standard deviation of the collision", _summary(COLLISION_DEVIATION), _collision_bound),
    Feature("iteration", lambda s: floats(s.xp, s.iteration), lambda s: s.settings.iterations),
)
SCALED = (
    Feature("log(1 + E(P)) / 8", _log_scaled(POPULATION_COLLISION), _log_bound),
    Feature("log(1 + mean collision) / 8", _log_scaled(MEAN_COLLISION), _log_bound),
    Feature("log(1 + standard deviation of the collision) / 8", _log_scaled(COLLISION_DEVIATION), _log_bound),
    Feature(
        "share of the iterations done", lambda s: floats(s.xp, s.iteration) / s.settings.iterations, _one
    ),
)
EXTENDED = (
    *SCALED,
    Feature(
        "log population size, relative to that of the largest",
        log_size,
        _one,
    ),
    Feature("feasible share", _summary(FEASIBLE_SHARE), _one),
    Feature("log(best fitness / lower bound)", _log_relative_fitness, lambda _: 4.0),
    Feature(
        "log(E(P) / first E(P)) / 8",
        lambda s: _log_collision_ratio(s, 0),
        _one,
        low=-1.0,
    ),
    Feature(
        "evaluations / reference evaluations, as x / (1 + x)",
        _spent_of_reference,
        _one,
    ),
)
RICH = (
    *EXTENDED,
    Feature(
        "log(1 + iteration), relative to that of the last",
        lambda s: _clock(s, s.iteration),
        _one,
    ),
    Feature(
        f"log(gap {RECENT} iterations ago / gap)",
        _log_progress,
        lambda _: 4.0,
    ),
    Feature("log(1 + diversity) / 8", _log_scaled(DIVERSITY), _log_extent),
    Feature(SHARE_SPENT, spent_share, _one),
)
PRICED = (
    *RICH,
    Feature(
        "log10(price / 0.1) / 3",
        _log_price,
        lambda _: 4.0,
        low=-1.0,
    ),
)
CORRIDORS = (
    *SCALED,
    Feature(
        f"log(gap of the best smooth newcomer of the last {RECENT} iterations / gap)",
        _log_best_smooth,
        lambda _: NO_GOOD_NEWCOMER,
        arrival_window=RECENT,
    ),
    Feature(
        f"newcomers of the last {RECENT} iterations that became the best so far, as x / (1 + x)",
        _became_best,
        _one,
        arrival_window=RECENT,
    ),
    Feature(
        "log number of corridors, relative to that of the largest population",
        _log_corridors,
        _one,
        needs_paths=True,
    ),
)
JUMPS = (
    *SCALED,
    Feature("log(E(P) / E(P) one iteration before) / 8", _log_jump, _one, low=-1.0),
    Feature(
        "log(1 + iterations since the best fitness last rose), relative to that of the last",
        _log_since_rise,
        _one,
    ),
    Feature("log(best fitness / that before it last rose)", _log_rise, lambda _: 4.0),
)
TOLD = (
    *SCALED,
    Feature("log(1 + iterations since the last event), relative to that of the last", _log_since_event, _one),
    Feature("log(1 + iterations until the next event), relative to that of the last", _log_until_event, _one),
)
NAMED = (
    *SCALED,
    *(Feature(f"whether the optimizer is {name}", _is_optimizer(name), _one) for name in TOLD_APART),
)
RESTARTS = (
    *PAPER,
    Feature(
        RESTARTS_SO_FAR,
        lambda s: floats(s.xp, s.optimizer.counts(s.swarms)[RESTARTS_COUNTED]),
        lambda s: float(s.settings.iterations),
        needs_restarts=True,
    ),
)
THEORY = (
    Feature("length n of the bit string", lambda s: s.lengths(), lambda _: float(SIZES[-1]), needs_bits=True),
    Feature("number of ones f", _ones, lambda _: float(SIZES[-1]), needs_bits=True),
)
THEORY_SCALED = (
    Feature("share of zeros, (n - f) / n", lambda s: 1.0 - _ones(s) / s.lengths(), _one, needs_bits=True),
    Feature(
        "log(n / (n - f))",
        lambda s: log(s.lengths() / _zeros(s), s.xp),
        lambda _: _LOG_OF_LONGEST,
        needs_bits=True,
    ),
)
