"""The measures of what swarms reach: gaps of the best fitness, and the price of evaluations.

They work on the arrays of any library, see `swarm_gym.arrays`.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import divided, namespace_of
from swarm_gym.compiler.elementary import exp, log
from swarm_gym.compiler.rows import gaps_above
from swarm_gym.population import Swarms
from swarm_gym.settings import Settings
from swarm_gym.worlds import Worlds

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Gaps:
    """The gaps of B swarms: how far their best fitness is above a lower bound, or above the optimum.

    Bounds and optima belong to the problems that the swarms work on now.

    Args:
        swarms: state of the swarms.
        worlds: problems that the swarms work on.
        initial: (B,) array for the initial gaps.

    Attributes:
        initial: (B,) best fitness of the first population above the lower bound; where the map has changed
            since, times what that did to the gap.
    """

    def __init__(self, swarms: Swarms, worlds: Worlds, initial: Floats):
        self._swarms, self._worlds = swarms, worlds
        self.initial = initial

    def of(self, fitness: Floats) -> Floats:
        """Return (B,) fitness values (B,) minus the lower bounds; positive, so that they have logarithms."""
        worlds, problem, xp = self._worlds, self._swarms.problem, namespace_of(fitness)
        if xp is np:
            return gaps_above(fitness, problem, worlds.lower_bounds, worlds.gap_units)
        return xp.maximum(fitness - worlds.lower_bounds[problem], 1e-9 * worlds.gap_units[problem])

    def now(self) -> Floats:
        """Return (B,) the gaps of the best fitness so far."""
        return self.of(self._swarms.best_fitness)

    def optimality(self) -> Floats:
        """Return (B,) (best fitness so far - optimum) / optimum; NaN where the optimum is unknown.

        If the optimum is 0, as for test functions, it is the best fitness itself. On bit strings, it is the
        evaluations of the run against the least expected number. It is infinite for a run that has not found
        the string of all ones. An optimum that is not known is computed when it is first asked for, if that
        takes less than about a second.
        """
        worlds, swarms = self._worlds, self._swarms
        worlds.compute_optima()
        optimum, value = worlds.optima[swarms.problem], swarms.best_fitness
        if worlds.counts_evaluations:
            arrived = value <= worlds.targets[swarms.problem]
            value = np.where(arrived, swarms.evaluations, np.inf)
        unit = namespace_of(optimum).where(optimum == 0.0, 1.0, optimum)
        return (value - optimum) / unit

    def carry_over(self, before: Floats, changed: Flags) -> None:
        """Scale the initial gaps of swarms whose problems have changed, (B,), by what that did to the gaps.

        Args:
            before: (B,) gaps before the change.
            changed: (B,) swarms whose problems have changed.
        """
        self.initial *= divided(namespace_of(before), self.now(), before, changed, 1.0)


class Prices:
    """The prices of evaluations in the present episodes of B swarms.

    Args:
        of_reference: (B,) array for the prices.
        settings: options of the environment.

    Attributes:
        of_reference: (B,) cost of `Settings.reference_evaluations` evaluations.
    """

    def __init__(self, of_reference: Floats, settings: Settings):
        self.of_reference = of_reference
        self._reference = settings.reference_evaluations

    def cost(self, evaluations: NDArray[np.int64]) -> Floats:
        """Return (B,) what these numbers of evaluations, (B,), cost."""
        return self.of_reference * evaluations / self._reference


def prices_at(shares: Floats, settings: Settings) -> Floats:
    """Return (k,) prices of episodes, at these shares in [0, 1) of the logarithms of their range, (k,)."""
    if not isinstance(settings.price, tuple):
        return np.full(len(shares), settings.price, dtype=np.float64)
    low, high = log(settings.price)
    return exp(low + (high - low) * shares)
