"""Population size by a monitor of the search's status: it grows on stagnation and shrinks on progress.

Source of the idea: W. Zhu, Y. Tang, J.-A. Fang, W. Zhang, "Adaptive population tuning scheme for differential
evolution", Information Sciences 223, 164-191 (2013): where the best solution keeps improving, members are
superfluous; where it keeps failing to, more of them are needed.

Readings: how many iterations in a row are progress or stagnation, what counts as an improvement and by how
much the size changes are parameters with this project's defaults: episodes of a hundred iterations leave no
time for small steps, and fireflies nearly always improve their best by a little. Who joins and who leaves is
the environment's rule.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Floats, SizeLimits
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.size_rule import BEST_FITNESS, SizeRule, column


@dataclass
class StatusMonitor(SizeRule):
    """Counts iterations in a row with and without an improvement of the best fitness.

    Attributes:
        patience: iterations in a row with, or without, an improvement after which the size changes.
        improvement: the least fall of the logarithm of the best fitness that is one.
        step: share of the population by which the size changes, at least by one member.
    """

    observation: str = "extended"
    patience: int = 3
    improvement: float = 0.001
    step: float = 0.1

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """What the parameters may be."""
        own = {
            "patience": Range(1, 1000, integer=True),
            "improvement": Range(0.0, 10.0),
            "step": Range(0.0, 1.0),
        }
        return super().parameter_ranges(limits) | own

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Forget sizes, best fitness and counts."""
        super().reset(num_swarms, seed)
        self._best = np.zeros(num_swarms)
        self._progress = np.zeros(num_swarms, dtype=np.int64)
        self._stagnation = np.zeros(num_swarms, dtype=np.int64)

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        best = observations[:, column(self.observation, BEST_FITNESS)]
        improved = self._best - best > self.improvement
        self._best = best
        self._progress = np.where(improved & ~begin, self._progress + 1, 0)
        self._stagnation = np.where(improved | begin, 0, self._stagnation + 1)
        shrink, grow = self._progress >= self.patience, self._stagnation >= self.patience
        self._progress[shrink], self._stagnation[grow] = 0, 0
        change = np.maximum(np.floor(self.step * self._size + 0.5), 1.0)
        return self._size + change * (grow.astype(np.float64) - shrink)
