"""Hand-designed rules of the population size from the literature.

They were published for certain optimizers and decide the population size alone. Here phi is a constant of
each rule; with phi = 0, a rule is as it was published. Which members join or leave a population is the
environment's rule. The share of the iterations done stands for the share of the evaluations spent, but in
`EvaluationReduction`.
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
from swarm_gym.features import RESTARTS_SO_FAR, SHARE_SPENT
from swarm_gym.observation import ITERATION

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
        begin = observations[:, ITERATION] == 0
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
    reduction", IEEE CEC 2014 (L-SHADE). There the size falls with the share of the evaluations spent, as in
    `EvaluationReduction`.
    """

    observation: str = "scaled"

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:  # noqa: ARG002
        return self.start + (self.smallest - self.start) * self.fall(self._share_done(observations))

    @staticmethod
    def fall(share: Floats) -> Floats:
        """Return the share of the fall from `start` to `smallest`, by the share of what is done."""
        return share

    def _share_done(self, observations: Floats) -> Floats:
        # The observation is in single precision: rounding restores the share, so that halves round correctly.
        return np.round(observations[:, column(self.observation, SHARE_DONE)], 6)


@dataclass
class EvaluationReduction(LinearReduction):
    """A size that falls from `start` to `smallest` in proportion to the evaluations spent (LPSR).

    Later iterations have fewer members and spend fewer evaluations, so the size falls ever more slowly. Let
    an episode have as many iterations as evaluations, so that the budget ends it. Without a budget of
    evaluations, the size falls with the iterations.

    Source: see `LinearReduction`.
    """

    observation: str = "rich"

    def _share_done(self, observations: Floats) -> Floats:
        spent = observations[:, column(self.observation, SHARE_SPENT)]
        # The first population has spent some of a budget.
        return np.where(spent > 0.0, np.round(spent, 6), super()._share_done(observations))


@dataclass
class NonLinearReduction(LinearReduction):
    """A size that falls from `start` to `smallest`, faster than a linear reduction, and slowly at the end.

    The share of the fall is r^(1 - r), where r is the share of the iterations done.

    Source: V. Stanovov, S. Akhmedova, E. Semenkin, "NL-SHADE-RSP algorithm with adaptive archive and
    selective pressure for CEC 2021 numerical optimization", IEEE CEC 2021. There r is the share of the
    evaluations spent.
    """

    @staticmethod
    def fall(share: Floats) -> Floats:
        """Return the share of the fall from `start` to `smallest`, by the share of the iterations done."""
        return power(share, 1.0 - share)


@dataclass
class DiversityLadder(SizeRule):
    """A size that changes by a rung to keep the relative diversity near 1 - share of the iterations done.

    Source: R. Poláková, J. Tvrdík, P. Bujok, "Differential evolution with adaptive mechanism of population
    size according to current population diversity", Swarm and Evolutionary Computation 50, 100519 (2019).
    The diversity is the root mean square of the members' distances from their mean, relative to its value
    in the first population. It shall fall linearly to zero. Below a band around that line, the size grows by
    a rung; above the band, it shrinks by one. In the paper, with many more generations, a rung is one member.

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

    The observed logarithm is at most 4. Where the best fitness is above 54 times its lower bound, progress is
    not seen, and counts as stagnation.

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


@dataclass
class IncreasingSize(SizeRule):
    """A size that grows by a factor at each restart of the optimizer (IPOP).

    Source: A. Auger, N. Hansen, "A restart CMA evolution strategy with increasing population size", IEEE CEC
    2005. The rule sees a restart after the first generation of a run, which still has the former size.

    Attributes:
        start: size of the first run; the default is CMA-ES's in ten dimensions, 4 + 3 log 10.
        smallest: smallest size; it has an effect only above `start`.
        factor: factor of the size; 2 in the paper.
    """

    observation: str = "restarts"
    start: int = 10
    smallest: int = 2
    factor: float = 2.0
    ranges: ClassVar[Mapping[str, Range]] = {"factor": Range(1.0, 10.0)}

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:  # noqa: ARG002
        return self.start * power(self.factor, observations[:, column(self.observation, RESTARTS_SO_FAR)])


@dataclass
class TwoRegimes(IncreasingSize):
    """A size of two regimes; at a restart, the regime begins that has spent fewer evaluations (BIPOP).

    Source: N. Hansen, "Benchmarking a BI-population CMA-ES on the BBOB-2009 function testbed", GECCO 2009
    workshop. In the first regime, a run has `factor` times as many members as the one before, and `start`
    times the factor at first. In the second regime, a run has s (l / (2 s))^(u^2) members, rounded down. Here
    s is `start`, l the size of the last run of the first regime, and u is drawn uniformly from [0, 1]. The
    first run of all counts for the second regime.

    The paper also draws the first step size of a run of the second regime. It ends such a run when it has
    spent half as much as the last run of the first regime. Both are left to the optimizer here.
    """

    draws_numbers = True

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Forget runs, and seed one generator for each swarm."""
        super().reset(num_swarms, seed)
        self._generators = [np.random.default_rng(seed + row) for row in range(num_swarms)]
        self._restarts, self._wanted = np.zeros(num_swarms), np.full(num_swarms, float(self.start))
        # Size of the last run of the first regime; whether a run is of that regime.
        self._largest, self._grows = self._wanted.copy(), np.zeros(num_swarms, dtype=np.bool_)
        self._spent = np.zeros((2, num_swarms))  # evaluations of the second regime, and of the first

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        restarts = observations[:, column(self.observation, RESTARTS_SO_FAR)]
        rows = np.arange(len(restarts))
        self._wanted[begin] = self._largest[begin] = self.start
        self._grows[begin], self._spent[:, begin] = False, 0.0
        self._spent[self._grows.astype(int), rows] += np.where(begin, self.start, self._size)
        for row in np.flatnonzero((restarts > self._restarts) & ~begin):
            self._begin_run(int(row))
        self._restarts = restarts.copy()
        return self._wanted

    def _begin_run(self, row: int) -> None:
        """Choose the regime of the run of a swarm that has begun, and its size."""
        self._grows[row] = self._spent[0, row] >= self._spent[1, row]
        if self._grows[row]:
            self._wanted[row] = self._largest[row] = min(
                self.factor * self._largest[row], float(self.limits.largest)
            )
        else:
            drawn = self._generators[row].random()
            ratio = max(0.5 * self._largest[row] / self.start, 1.0)
            self._wanted[row] = np.floor(self.start * float(power(ratio, drawn * drawn)))
