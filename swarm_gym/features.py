"""Features of swarms: numbers by which a controller sees them, with their bounds.

`swarm_gym.observation` makes layouts of them. Features other than those of the paper are scaled by fixed
numbers, so there are no running statistics to store.
"""

from collections.abc import Callable
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from swarm_gym.corridors import KnownCorridors
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.population import (
    COLLISION_DEVIATION,
    DIVERSITY,
    FEASIBLE_SHARE,
    MEAN_COLLISION,
    POPULATION_COLLISION,
)
from swarm_gym.simulation import HISTORY, Simulation
from swarm_gym.sources import BECAME_BEST, BEST_SMOOTH

Floats = NDArray[np.float64]

RECENT = 5  # number of iterations over which recent progress is measured, and newcomers are watched
NO_GOOD_NEWCOMER = 4.0  # log(gap of a newcomer / gap) of a bad one, or of none
_BEST = HISTORY.index("best_fitness")
_COLLISION = HISTORY.index("population_collision")


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
    """

    name: str
    values: Callable[[Simulation], Floats]
    high: Callable[[Simulation], float]
    low: float = 0.0
    arrival_window: int = 0
    needs_paths: bool = False


def _collision_bound(simulation: Simulation) -> float:
    return simulation.worlds.collision_bound


def _summary(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: simulation.swarms.summary[:, column]


def _log_scaled(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: np.log1p(simulation.swarms.summary[:, column]) / 8.0


def _log_bound(simulation: Simulation) -> float:
    return float(np.log1p(_collision_bound(simulation))) / 8.0


def _log_extent(simulation: Simulation) -> float:
    """Return the bound of the scaled diversity.

    No member is farther from the mean than the workspace is wide.
    """
    extents = [np.linalg.norm(np.subtract(*problem.bounds)) for problem in simulation.problems]
    return float(np.log1p(max(extents))) / 8.0


def _log_progress(simulation: Simulation) -> Floats:
    """Return (B,) log(gap `RECENT` iterations ago, or at first, / gap now); 0 before the first reset."""
    rows, then = np.arange(simulation.num_swarms), np.maximum(simulation.iteration - RECENT, 0)
    before = simulation.gap_of(simulation.history[rows, then, _BEST])
    now = simulation.gap()
    return np.log(np.divide(before, now, out=np.ones_like(now), where=np.isfinite(now)))


def _log_relative_fitness(simulation: Simulation) -> Floats:
    """Return (B,) log(best fitness / lower bound).

    For test functions, whose lower bound is 0, it is log(1 + best fitness).
    """
    numbers = simulation.swarms.problem
    bound, unit = simulation.lower_bounds[numbers], simulation.gap_units[numbers]
    return np.log((simulation.swarms.best_fitness + (unit - bound)) / unit)


def _spent(simulation: Simulation) -> Floats:
    """Return (B,) the fraction of the evaluation budget that is spent; 0 without a budget."""
    if simulation.settings.max_evaluations is None:
        return np.zeros(simulation.num_swarms)
    return simulation.swarms.evaluations / simulation.settings.max_evaluations


def _log_best_smooth(simulation: Simulation) -> Floats:
    """Return (B,) log(gap of the best smooth newcomer of the last `RECENT` iterations / gap), in [0, 4].

    It is 4 without such a newcomer.
    """
    newcomer = simulation.gap_of(simulation.swarms.arrivals[:, BEST_SMOOTH].min(axis=1))
    ratio = np.full(simulation.num_swarms, np.exp(NO_GOOD_NEWCOMER))
    np.divide(newcomer, simulation.gap(), out=ratio, where=np.isfinite(newcomer))
    return np.clip(np.log(ratio), 0.0, NO_GOOD_NEWCOMER)


def _became_best(simulation: Simulation) -> Floats:
    """Return (B,) x / (1 + x) of the number of newcomers of the last `RECENT` iterations that became best."""
    counts = simulation.swarms.arrivals[:, BECAME_BEST].sum(axis=1)
    counts[simulation.swarms.size == 0] = 0.0  # nothing has been recorded before the first reset
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
    return np.log(counts) / np.log(max(simulation.settings.max_population_size, 2))


def _last_rise(simulation: Simulation) -> tuple[NDArray[np.int64], Floats]:
    """Return (B,) the iteration after which the best fitness last rose, and the best after it / before it.

    The best fitness so far rises by events on the map only. Without a rise these are 0 and 1.
    """
    best = simulation.history[:, :, _BEST]
    rows, last = np.arange(len(best)), best.shape[1] - 1
    rose = best[:, 1:] > best[:, :-1] * (1.0 + 1e-9)  # False where nothing is recorded yet
    when = np.where(rose.any(axis=1), last - np.argmax(rose[:, ::-1], axis=1), 0)
    before, after = best[rows, np.maximum(when - 1, 0)], best[rows, when]
    return when, np.divide(after, before, out=np.ones(len(best)), where=when > 0)


def _log_since_rise(simulation: Simulation) -> Floats:
    when, _ = _last_rise(simulation)
    return np.log1p(simulation.iteration - when) / np.log1p(simulation.settings.iterations)


def _log_rise(simulation: Simulation) -> Floats:
    _, ratio = _last_rise(simulation)
    return np.log(ratio)


def _log_collision_ratio(simulation: Simulation, iteration: NDArray[np.int64] | int) -> Floats:
    """Return (B,) log((1 + E(P)) / (1 + E(P) after that iteration)) / 8; nan before the first reset."""
    before = simulation.history[np.arange(simulation.num_swarms), iteration, _COLLISION]
    return np.log((1.0 + simulation.swarms.summary[:, POPULATION_COLLISION]) / (1.0 + before)) / 8.0


def _log_jump(simulation: Simulation) -> Floats:
    """Return (B,) the log ratio of E(P) to that one iteration before; 0 before the first iteration."""
    return np.nan_to_num(_log_collision_ratio(simulation, np.maximum(simulation.iteration - 1, 0)))


def _log_since_event(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + iterations since the last event) / log(1 + those of an episode)."""
    since = simulation.iteration - simulation.worlds.begins[simulation.swarms.problem]
    return np.log1p(since) / np.log1p(simulation.settings.iterations)


def _log_until_event(simulation: Simulation) -> Floats:
    """Return (B,) log(1 + iterations until the next event) / log(1 + those of an episode); 1 without one."""
    coming = simulation.worlds.next_event[simulation.swarms.problem]
    length = simulation.settings.iterations
    until = np.where(coming > 0, coming - simulation.iteration, length)
    return np.log1p(until) / np.log1p(length)


def _is_optimizer(name: str) -> Callable[[Simulation], Floats]:
    return lambda simulation: np.full(simulation.num_swarms, float(simulation.optimizer.name == name))


def _one(_: Simulation) -> float:
    return 1.0


PAPER = (
    Feature("population collision E(P)", _summary(POPULATION_COLLISION), _collision_bound),
    Feature("mean collision", _summary(MEAN_COLLISION), _collision_bound),
    Feature("standard deviation of the collision", _summary(COLLISION_DEVIATION), _collision_bound),
    Feature("iteration", lambda s: s.iteration.astype(np.float64), lambda s: s.settings.iterations),
)
SCALED = (
    Feature("log(1 + E(P)) / 8", _log_scaled(POPULATION_COLLISION), _log_bound),
    Feature("log(1 + mean collision) / 8", _log_scaled(MEAN_COLLISION), _log_bound),
    Feature("log(1 + standard deviation of the collision) / 8", _log_scaled(COLLISION_DEVIATION), _log_bound),
    Feature("share of the iterations done", lambda s: s.iteration / s.settings.iterations, _one),
)
EXTENDED = (
    *SCALED,
    Feature(
        "log population size, relative to that of the largest",
        lambda s: np.log1p(s.swarms.size) / np.log1p(s.settings.max_population_size),
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
        lambda s: s.swarms.evaluations / (s.swarms.evaluations + s.settings.reference_evaluations),
        _one,
    ),
)
RICH = (
    *EXTENDED,
    Feature(
        "log(1 + iteration), relative to that of the last",
        lambda s: np.log1p(s.iteration) / np.log1p(s.settings.iterations),
        _one,
    ),
    Feature(
        f"log(gap {RECENT} iterations ago / gap)",
        _log_progress,
        lambda _: 4.0,
    ),
    Feature("log(1 + diversity) / 8", _log_scaled(DIVERSITY), _log_extent),
    Feature("share of the evaluation budget spent", _spent, _one),
)
PRICED = (
    *RICH,
    Feature(
        "log10(price / 0.1) / 3",
        lambda s: np.log10(np.maximum(s.price, 1e-4) / 0.1) / 3.0,
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
    *(Feature(f"whether the optimizer is {name}", _is_optimizer(name), _one) for name in OPTIMIZERS),
)
