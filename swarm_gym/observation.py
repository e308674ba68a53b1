"""Observations: the numbers by which a controller sees a swarm.

A layout is a list of features. All layouts, except for bit strings, have the iteration as fourth number,
and all but these and `search` begin with three numbers about collision:

| layout | dtype | features |
|---|---|---|
| `paper` | float64 | E(P), mean and standard deviation of the collision in map units; iteration |
| `scaled` | float32 | logarithms of the first three; fraction of the iterations done |
| `extended` | float32 | `scaled`, and size, feasible share, best fitness, change of E(P), evaluations |
| `rich` | float32 | `extended`, and a logarithmic clock, recent progress, diversity, share of the budget |
| `priced` | float32 | `rich`, and the price of evaluations in this episode |
| `corridors` | float32 | `scaled`, and how good recent newcomers are, and the number of corridors in use |
| `jumps` | float32 | `scaled`, and what a change of the map does: jumps of E(P) and of the best fitness |
| `told` | float32 | `scaled`, and iterations since the last event on the map and until the next |
| `named` | float32 | `scaled`, and for each optimizer in `features.TOLD_APART` whether it is this one |
| `restarts` | float64 | `paper`, and how often the optimizer has restarted, such as CMA-ES |
| `search` | float32 | of CMA-ES and differential evolution: step size, covariance, success, memory, budget |
| `distribution` | float64 | `restarts`, and how far the distribution of CMA-ES moves; dimension |
| `theory` | float64 | on bit strings: length n and number of ones f |
| `theory-scaled` | float32 | on bit strings: share of zeros, (n - f) / n, and its logarithm |

`paper` has the numbers of the SPSFA paper, unscaled, so that its schedule can be computed exactly. The other
layouts are for networks. They are scaled by fixed numbers, so there are no running statistics to store. Names
joined by `+`, such as `paper+rich`, stand for several layouts one after the other.

`search` has no numbers in map units. It is the same if the fitness is shifted or scaled, or the box is, see
`swarm_gym.search_features`.

`told` has what no controller can see, the times of events: it is for upper bounds of what seeing is worth.

`corridors` needs members that are whole paths on a map, so it refuses walks and test functions. Environments
record newcomers only for this layout. A newcomer is drawn from the source of new members: by growth, by
immigration, or by the search of `Multivariate` anywhere on the map. After an event on a map, it still counts
with the fitness that it had when it was new. `swarm_gym.corridors` says what corridors are. A simulation
whose state is tensors, see `swarm_gym.arrays`, refuses this layout.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.corridors import require_paths
from swarm_gym.errors import SettingError
from swarm_gym.features import (
    CORRIDORS,
    EXTENDED,
    JUMPS,
    NAMED,
    PAPER,
    PRICED,
    RESTARTS,
    RESTARTS_COUNTED,
    RICH,
    SCALED,
    THEORY,
    THEORY_SCALED,
    TOLD,
    Feature,
)
from swarm_gym.own_code import find
from swarm_gym.problem import OneMaxProblem
from swarm_gym.search_features import DISTRIBUTION, SEARCH, can_search
from swarm_gym.simulation import Simulation

# Column with the iteration, or its fraction of all, of every layout that is not of bit strings; 0 only at the
# beginning.
ITERATION = 3


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

    @cached_property
    def _needs_bits(self) -> bool:
        return any(feature.needs_bits for feature in self.features)

    @cached_property
    def _needs_restarts(self) -> bool:
        return any(feature.needs_restarts for feature in self.features)

    @cached_property
    def _needs_search(self) -> bool:
        return any(feature.needs_search for feature in self.features)

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

        They are an array of the simulation's library, on its device.

        Raises:
            SettingError: if the simulation cannot be observed by this layout.
        """
        self._require(simulation)
        xp, shape = simulation.xp, (simulation.num_swarms, len(self.features))
        out = xp.empty(shape, dtype=getattr(xp, self.dtype.__name__), device=simulation.device)
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
            if simulation.xp is not np:
                raise SettingError(
                    f"{asked} needs a simulation on NumPy arrays, got one on tensors; choose a layout that "
                    "counts no corridors"
                )
        if self._needs_bits and not isinstance(simulation.problems[0], OneMaxProblem):
            raise SettingError(
                f"{asked} counts the ones of bit strings, but scenario "
                f"{simulation.problems[0].scenario.name!r} has none; choose a scenario such as onemax:100, "
                "or another layout"
            )
        counts = simulation.optimizer.counts(simulation.swarms)
        if self._needs_restarts and RESTARTS_COUNTED not in counts:
            raise SettingError(
                f"{asked} counts restarts, but optimizer {simulation.optimizer.name!r} never begins anew; "
                "choose an optimizer that does, or another layout"
            )
        if self._needs_search and not can_search(simulation):
            raise SettingError(
                f"{asked} reads the step size of cma-es or the memory of differential-evolution, but "
                f"optimizer {simulation.optimizer.name!r} has neither; choose one of these optimizers, or "
                "another layout"
            )
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


OBSERVATIONS: dict[str, Observation] = {
    layout.name: layout
    for layout in (
        Observation("paper", PAPER, np.float64),
        Observation("scaled", SCALED, np.float32),
        Observation("extended", EXTENDED, np.float32),
        Observation("rich", RICH, np.float32),
        Observation("priced", PRICED, np.float32),
        Observation("corridors", CORRIDORS, np.float32),
        Observation("jumps", JUMPS, np.float32),
        Observation("told", TOLD, np.float32),
        Observation("named", NAMED, np.float32),
        Observation("restarts", RESTARTS, np.float64),
        Observation("search", SEARCH, np.float32),
        Observation("distribution", DISTRIBUTION, np.float64),
        Observation("theory", THEORY, np.float64),
        Observation("theory-scaled", THEORY_SCALED, np.float32),
    )
}


def make_observation(name: str) -> Observation:
    """Return the layout of a name; names joined by `+` are layouts one after the other.

    Raises:
        UnknownNameError: if there is no layout of that name.
        OwnCodeError: if own code cannot be imported, or is no layout.
    """
    parts = [
        find("observation layout", part, OBSERVATIONS, _is_observation, "an Observation")
        for part in str(name).split("+")
    ]
    if len(parts) == 1:
        return parts[0]
    features = tuple(feature for part in parts for feature in part.features)
    return Observation(name, features, np.result_type(*(part.dtype for part in parts)).type)


def _is_observation(found: object) -> bool:
    return isinstance(found, Observation)
