"""Observations: the numbers by which a controller sees a swarm.

A layout is a list of features, and every layout begins with three numbers about collision and the iteration:

| layout | dtype | features |
|---|---|---|
| `paper` | float64 | E(P), mean and standard deviation of the collision in map units; iteration |
| `scaled` | float32 | logarithms of the first three; fraction of the iterations done |
| `extended` | float32 | `scaled`, and size, feasible share, best fitness, change of E(P), evaluations |
| `rich` | float32 | `extended`, and a logarithmic clock, recent progress, diversity, share of the budget |
| `priced` | float32 | `rich`, and the price of evaluations in this episode |
| `corridors` | float32 | `scaled`, and how good recent newcomers are, and the number of corridors in use |

`paper` has the numbers of the SPSFA paper, unscaled, so that its schedule can be computed exactly. The other
layouts are for networks. They are scaled by fixed numbers, so there are no running statistics to store. Names
joined by `+`, such as `paper+rich`, stand for several layouts one after the other.

`corridors` needs members that are whole paths on a map, so it refuses walks and test functions. Environments
record newcomers only for this layout. A newcomer is drawn from the source of new members: by growth, by
immigration, or by the search of `Multivariate` anywhere on the map. After an event on a map, it still counts
with the fitness that it had when it was new. `swarm_gym.corridors` says what corridors are.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.corridors import KnownCorridors, require_paths
from swarm_gym.errors import SettingError
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

ITERATION = 3  # column of every layout with the iteration, or its fraction of all; 0 only at the beginning
RECENT = 5  # number of iterations over which recent progress is measured, and newcomers are watched
NO_GOOD_NEWCOMER = 4.0  # log(gap of a newcomer / gap) of a bad one, or of none


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


@dataclass(frozen=True)
class Observation:
    """A layout of observations: a named list of features.

    Attributes:
        name: name of the layout, as in the option `observation`.
        features: features, in the order of the numbers.
        dtype: type of the numbers.
    """

    name: str
    features: tuple[Feature, ...]
    dtype: type[np.floating]

    @cached_property
    def arrival_window(self) -> int:
        """Number of iterations whose new members the simulation must record; 0 for none."""
        return max(feature.arrival_window for feature in self.features)

    @cached_property
    def _needs_paths(self) -> bool:
        return any(feature.needs_paths for feature in self.features)

    def space(self, simulation: Simulation) -> Box:
        """Return the space of one swarm's observation, shape (number of features,).

        Raises:
            SettingError: if the simulation cannot be observed by this layout.
        """
        self._require(simulation)
        low = np.array([feature.low for feature in self.features], dtype=self.dtype)
        high = np.array([feature.high(simulation) for feature in self.features], dtype=self.dtype)
        return Box(low, high, dtype=self.dtype)

    def observe(self, simulation: Simulation) -> NDArray:
        """Return new observations (B, number of features), up to rounding inside the bounds.

        Raises:
            SettingError: if the simulation cannot be observed by this layout.
        """
        self._require(simulation)
        out = np.empty((simulation.num_swarms, len(self.features)), dtype=self.dtype)
        for column, feature in enumerate(self.features):
            out[:, column] = feature.values(simulation)
        return out

    def _require(self, simulation: Simulation) -> None:
        """Raise an error if the simulation lacks something that a feature needs.

        Raises:
            SettingError: naming the layout.
        """
        asked = f"observation {self.name!r}"
        if self._needs_paths:
            require_paths(asked, simulation.problems[0])
        recorded = simulation.swarms.arrivals.shape[2]
        if self.arrival_window not in (0, recorded):
            raise SettingError(
                f"{asked} needs records of new members of the last {self.arrival_window} iterations, but the "
                f"simulation has them of {recorded}; make the environment with this observation, or use "
                f"Simulation(..., arrival_window={self.arrival_window})"
            )

    def __reduce__(self) -> tuple[Callable[[str], "Observation"], tuple[str]]:
        # Layouts are pickled by name, since features are functions.
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
    """Return the bound of the scaled diversity.

    No member is farther from the mean than the workspace is wide.
    """
    extents = [np.linalg.norm(np.subtract(*problem.bounds)) for problem in simulation.problems]
    return float(np.log1p(max(extents))) / 8.0


def _log_progress(simulation: Simulation) -> Floats:
    """Return (B,) log(gap `RECENT` iterations ago, or at first, / gap now); 0 before the first reset."""
    rows, then = np.arange(simulation.num_swarms), np.maximum(simulation.iteration - RECENT, 0)
    before = simulation.gap_of(simulation.history[rows, then, HISTORY.index("best_fitness")])
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
        lambda s: (
            np.log((1.0 + s.swarms.summary[:, POPULATION_COLLISION]) / (1.0 + s.history[:, 0, 0])) / 8.0
        ),
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

OBSERVATIONS: dict[str, Observation] = {
    layout.name: layout
    for layout in (
        Observation("paper", PAPER, np.float64),
        Observation("scaled", SCALED, np.float32),
        Observation("extended", EXTENDED, np.float32),
        Observation("rich", RICH, np.float32),
        Observation("priced", PRICED, np.float32),
        Observation("corridors", CORRIDORS, np.float32),
    )
}


def make_observation(name: str) -> Observation:
    """Return the layout of a name; names joined by `+` are layouts one after the other.

    Raises:
        UnknownNameError: if there is no layout of that name.
    """
    parts = [look_up("observation layout", part, OBSERVATIONS) for part in str(name).split("+")]
    if len(parts) == 1:
        return parts[0]
    features = tuple(feature for part in parts for feature in part.features)
    return Observation(name, features, np.result_type(*(part.dtype for part in parts)).type)
