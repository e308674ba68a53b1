"""Hand-designed rules of the population size from the literature.

They were published for other optimizers and decide the population size alone. Here phi is a constant of each
rule; with phi = 0, a rule is as it was published. Which members join or leave a population is the
environment's rule, and the share of the iterations done stands for the share of the evaluations spent.
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import expm1, power
from swarm_gym.controllers.controller import Floats
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.rule import BEST_FITNESS, SHARE_DONE, Rule, column

DIVERSITY = "log(1 + diversity) / 8"


@dataclass
class SizeRule(Rule):
    """A rule of the population size, with a constant phi; `start` is the size of iteration 1, too.

    Attributes:
        smallest: smallest size after iteration 1; the default is clipped to the limits.
    """

    smallest: int = 10
    sizes: ClassVar[tuple[str, ...]] = ("start", "smallest")

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget the sizes."""
        self._size = np.zeros(num_swarms)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 2) next sizes and phi; iteration 0 in an observation begins an episode of that swarm."""
        begin = observations[:, column(self.observation, SHARE_DONE)] == 0
        size = np.floor(self._next_size(observations.astype(np.float64), begin) + 0.5)
        self._size = np.where(begin, self.start, np.clip(size, self.smallest, self.limits.largest))
        return np.stack([self._size, np.full(len(self._size), self.repair_degree)], axis=1)

    @abstractmethod
    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        """Return (B,) real-valued sizes that follow those in `_size`.

        Sizes of swarms whose episode begins are ignored; for them, only the rule's memory is updated.
        """


@dataclass
class LinearReduction(SizeRule):
    """A size that falls from `start` to `smallest` in proportion to the iterations done.

    Source: R. Tanabe, A. S. Fukunaga, "Improving the search performance of SHADE using linear population size
    reduction", IEEE CEC 2014 (L-SHADE). There the size falls with the share of the evaluations spent.
    """

    observation: str = "scaled"

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:  # noqa: ARG002
        return self.start + (self.smallest - self.start) * _share_done(self.observation, observations)


@dataclass
class NonLinearReduction(SizeRule):
    """A size that falls from `start` to `smallest`, faster than a linear reduction, and slowly at the end.

    The share of the fall is r^(1 - r), where r is the share of the iterations done.

    Source: V. Stanovov, S. Akhmedova, E. Semenkin, "NL-SHADE-RSP algorithm with adaptive archive and
    selective pressure for CEC 2021 numerical optimization", IEEE CEC 2021. There r is the share of the
    evaluations spent.
    """

    observation: str = "scaled"

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:  # noqa: ARG002
        share = _share_done(self.observation, observations)
        return self.start + (self.smallest - self.start) * power(share, 1.0 - share)


def _share_done(layout: str, observations: Floats) -> Floats:
    # The observation is in single precision: rounding restores the share, so that halves round correctly.
    return np.round(observations[:, column(layout, SHARE_DONE)], 6)


@dataclass
class DiversityLadder(SizeRule):
    """A size that changes by a rung to keep the relative diversity near 1 - share of the iterations done.

    Source: R. Poláková, J. Tvrdík, P. Bujok, "Differential evolution with adaptive mechanism of population
    size according to current population diversity", Swarm and Evolutionary Computation 50, 100519 (2019).
    The diversity is the root mean square of the members' distances from their mean, relative to that of the
    first population. It shall fall linearly to zero. Below a band around that line, the size grows by a rung;
    above the band, it shrinks by one. In the paper, with many more generations, a rung is one member.

    Attributes:
        rung: number of members by which the size changes.
        band: half the width of the band, relative to the wanted diversity; 0.1 in the paper.
    """

    observation: str = "rich"
    rung: int = 3
    band: float = 0.1
    ranges: ClassVar[Mapping[str, Range]] = {"rung": Range(1, 1000, integer=True), "band": Range(0.0, 1.0)}

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Forget sizes and first diversities."""
        super().reset(num_swarms, seed)
        self._first = np.zeros(num_swarms)

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        diversity = expm1(8.0 * observations[:, column(self.observation, DIVERSITY)])
        self._first = np.where(begin, diversity, self._first)
        wanted = self._first * (1.0 - observations[:, column(self.observation, SHARE_DONE)])
        up, down = diversity < (1.0 - self.band) * wanted, diversity > (1.0 + self.band) * wanted
        return self._size + self.rung * (up.astype(np.float64) - down)


@dataclass
class StatusMonitor(SizeRule):
    """A size that grows on stagnation and shrinks on progress of the best fitness.

    Source of the idea: W. Zhu, Y. Tang, J.-A. Fang, W. Zhang, "Adaptive population tuning scheme for
    differential evolution", Information Sciences 223, 164-191 (2013). While the best solution keeps
    improving, members are superfluous; while it does not, more members are needed. The parameters have this
    project's defaults: episodes of a hundred iterations leave no time for small steps, and fireflies improve
    their best solution by a little in nearly every iteration.

    Attributes:
        patience: number of consecutive iterations with, or without, an improvement that changes the size.
        improvement: smallest fall of the logarithm of the best fitness that counts as an improvement.
        step: share of the population by which the size changes, at least one member.
    """

    observation: str = "extended"
    patience: int = 3
    improvement: float = 0.001
    step: float = 0.1
    ranges: ClassVar[Mapping[str, Range]] = {
        "patience": Range(1, 1000, integer=True),
        "improvement": Range(0.0, 10.0),
        "step": Range(0.0, 1.0),
    }

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
