"""Population size by rungs, up where the diversity is too low and down where it is too high.

Source: R. Poláková, J. Tvrdík, P. Bujok, "Differential evolution with adaptive mechanism of population size
according to current population diversity", Swarm and Evolutionary Computation 50, 100519 (2019). The
diversity, the root mean square of the members' distances from their mean, is related to that of the first
population, and shall fall linearly to zero with the search; outside of a band around that line, the size
changes by a rung.

Readings: the share of the iterations done stands for that of the evaluations spent. A rung is one member
there, in runs of many more generations; here it is a parameter. Who joins and who leaves is the environment's
rule.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Floats, SizeLimits
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.size_rule import DIVERSITY, SHARE_DONE, SizeRule, column


@dataclass
class DiversityLadder(SizeRule):
    """Keeps the relative diversity near 1 - share of the iterations done.

    Attributes:
        rung: members by which the size changes.
        band: half the width of the band, relative to the diversity that is wanted; 0.1 in the paper.
    """

    observation: str = "rich"
    rung: int = 3
    band: float = 0.1

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """What the parameters may be."""
        own = {"rung": Range(1, 1000, integer=True), "band": Range(0.0, 1.0)}
        return super().parameter_ranges(limits) | own

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Forget sizes and first diversities."""
        super().reset(num_swarms, seed)
        self._first = np.zeros(num_swarms)

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        diversity = np.expm1(8.0 * observations[:, column(self.observation, DIVERSITY)])
        self._first = np.where(begin, diversity, self._first)
        wanted = self._first * (1.0 - observations[:, column(self.observation, SHARE_DONE)])
        up, down = diversity < (1.0 - self.band) * wanted, diversity > (1.0 + self.band) * wanted
        return self._size + self.rung * (up.astype(np.float64) - down)
