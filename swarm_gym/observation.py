"""Observations: what a controller sees of a swarm.

A layout is a list of features. The paper's four numbers come in map units and iterations, unscaled, so that
its schedule can be computed from them exactly. The layouts for networks are scaled by fixed numbers: there
are no running statistics to save or to lose.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.simulation import HISTORY, Simulation

Floats = NDArray[np.float64]

ITERATION = 3  # column of every layout: the iteration, or its share of all; 0 at the beginning only
RECENT = 5  # iterations over which progress is looked back on


@dataclass(frozen=True)
class Feature:
    """One number per swarm, with finite bounds."""

    name: str
    values: Callable[[Simulation], Floats]  # to shape (B,)
    high: Callable[[Simulation], float]
    low: float = 0.0


@dataclass(frozen=True)
class Observation:
    """A named list of features."""

    name: str
    features: tuple[Feature, ...]
    dtype: type[np.floating]

    def space(self, simulation: Simulation) -> Box:
        """The space of one swarm's observation, shape (number of features,)."""
        low = np.array([feature.low for feature in self.features], dtype=self.dtype)
        high = np.array([feature.high(simulation) for feature in self.features], dtype=self.dtype)
        return Box(low, high, dtype=self.dtype)

    def observe(self, simulation: Simulation) -> NDArray:
        """Observations (B, number of features), a new array, up to rounding inside the bounds."""
        out = np.empty((simulation.num_swarms, len(self.features)), dtype=self.dtype)
        for column, feature in enumerate(self.features):
            out[:, column] = feature.values(simulation)
        return out

    def __reduce__(self) -> tuple[Callable[[str], "Observation"], tuple[str]]:
        # Pickled by name: features are functions.
        return make_observation, (self.name,)


def _collision_bound(simulation: Simulation) -> float:
    return simulation.worlds.collision_bound


def _summary(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: simulation.swarms.summary[:, column]


def _log_scaled(column: int) -> Callable[[Simulation], Floats]:
    return lambda simulation: np.log1p(simulation.swarms.summary[:, column]) / 8.0


def _log_bound(simulation: Simulation) -> float:
    return float(np.log1p(_collision_bound(simulation))) / 8.0


def _log_extent(simulation: Simulation) -> float:
    """Bound of the scaled diversity: no member is farther from the mean than the workspace is wide."""
    extents = [np.linalg.norm(np.subtract(*problem.bounds)) for problem in simulation.problems]
    return float(np.log1p(max(extents))) / 8.0


def _log_progress(simulation: Simulation) -> Floats:
    """(B,) log(gap `RECENT` iterations ago, or at first, / gap now); 0 before the first reset."""
    rows, then = np.arange(simulation.num_swarms), np.maximum(simulation.iteration - RECENT, 0)
    before = simulation.gap_of(simulation.history[rows, then, HISTORY.index("best_fitness")])
    now = simulation.gap()
    return np.log(np.divide(before, now, out=np.ones_like(now), where=np.isfinite(now)))


def _log_relative_fitness(simulation: Simulation) -> Floats:
    """(B,) log(best fitness / lower bound); log(1 + best fitness) where that is 0, of test functions."""
    numbers = simulation.swarms.problem
    bound, unit = simulation.lower_bounds[numbers], simulation.gap_units[numbers]
    return np.log((simulation.swarms.best_fitness + (unit - bound)) / unit)


def _spent(simulation: Simulation) -> Floats:
    """(B,) share of the budget that is spent; 0 without a budget."""
    if simulation.settings.max_evaluations is None:
        return np.zeros(simulation.num_swarms)
    return simulation.swarms.evaluations / simulation.settings.max_evaluations


def _one(_: Simulation) -> float:
    return 1.0


PAPER = (
    Feature("population collision E(P)", _summary(0), _collision_bound),
    Feature("mean collision", _summary(1), _collision_bound),
    Feature("standard deviation of the collision", _summary(2), _collision_bound),
    Feature("iteration", lambda s: s.iteration.astype(np.float64), lambda s: s.settings.iterations),
)
SCALED = (
    Feature("log(1 + E(P)) / 8", _log_scaled(0), _log_bound),
    Feature("log(1 + mean collision) / 8", _log_scaled(1), _log_bound),
    Feature("log(1 + standard deviation of the collision) / 8", _log_scaled(2), _log_bound),
    Feature("share of the iterations done", lambda s: s.iteration / s.settings.iterations, _one),
)
EXTENDED = (
    *SCALED,
    Feature(
        "log population size, relative to that of the largest",
        lambda s: np.log1p(s.swarms.size) / np.log1p(s.settings.max_population_size),
        _one,
    ),
    Feature("feasible share", _summary(3), _one),
    Feature("log(best fitness / lower bound)", _log_relative_fitness, lambda _: 4.0),
    Feature(
        "log(E(P) / first E(P)) / 8",
        lambda s: np.log((1.0 + s.swarms.summary[:, 0]) / (1.0 + s.history[:, 0, 0])) / 8.0,
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
    Feature("log(1 + diversity) / 8", _log_scaled(4), _log_extent),
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

OBSERVATIONS: dict[str, Observation] = {
    layout.name: layout
    for layout in (
        Observation("paper", PAPER, np.float64),
        Observation("scaled", SCALED, np.float32),
        Observation("extended", EXTENDED, np.float32),
        Observation("rich", RICH, np.float32),
        Observation("priced", PRICED, np.float32),
    )
}


def make_observation(name: str) -> Observation:
    """The observation layout of that name; names joined by + are layouts one after the other.

    Raises:
        UnknownNameError: if there is none.
    """
    parts = [look_up("observation layout", part, OBSERVATIONS) for part in str(name).split("+")]
    if len(parts) == 1:
        return parts[0]
    features = tuple(feature for part in parts for feature in part.features)
    return Observation(name, features, np.result_type(*(part.dtype for part in parts)).type)
