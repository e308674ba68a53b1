"""Hand-made rules by which smooth immigrants replace the worst members at certain iterations.

They differ in when immigrants come: after stagnation, every so many iterations, or after a jump of E(P). All
other decisions are constant. Immigrants replace the members that shrinking would delete, and the best path
so far is stored apart.

Sources: J. Grefenstette, "Genetic algorithms for changing environments", PPSN 2 (1992), for random
immigrants; H. Cobb, "An investigation into the use of hypermutation as an adaptive operator in genetic
algorithms having continuous, time-dependent nonstationary environments". NRL Memorandum Report 6760 (1990),
for more mutation after a change; A. Auger, N. Hansen, "A restart CMA evolution strategy with increasing
population size", IEEE CEC 2005, for restarts after stagnation.
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Floats
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.rule import BEST_FITNESS, Rule, column
from swarm_gym.observation import ITERATION
from swarm_gym.sources import SOURCE_RANGES, Source

JUMP = "log(E(P) / E(P) one iteration before) / 8"
NOISE, IMMIGRANTS = 2, -1  # columns of the sourced action of fireflies


@dataclass
class ImmigrantRule(Rule):
    """A rule for fireflies: constant decisions, and immigrants in some iterations.

    All new members are smooth. The defaults of size, phi, noise and attractiveness are FA-60's.

    Attributes:
        size: population size of every iteration; the default is clipped to the limits.
        noise: alpha, in map units.
        attractiveness: beta0 in [0.01, 1].
        amplitude: largest offset of new members as a share of the workspace's width, in [0.01, 1].
        immigrants: share of the members that they replace, in [0, 1].
    """

    start: int = 150
    size: int = 60
    noise: float = 2.0
    attractiveness: float = 0.1
    amplitude: float = 0.5
    immigrants: float = 0.5
    action: str = "sourced"
    made_for = "firefly"  # no field: other optimizers have other parameters
    sizes: ClassVar[tuple[str, ...]] = ("start", "size")
    ranges: ClassVar[Mapping[str, Range]] = {
        "noise": Range(0.02, 100.0),
        "attractiveness": Range(0.01, 1.0),
        "amplitude": Range(*SOURCE_RANGES["amplitude"]),
        "immigrants": Range(*SOURCE_RANGES["immigrants"]),
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        self.first_source = Source(1.0, self.amplitude)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 7) decisions; iteration 0 in an observation begins an episode of that swarm."""
        decided = [self.size, self.repair_degree, self.noise, self.attractiveness, 1.0, self.amplitude, 0.0]
        actions = np.tile(np.array(decided, dtype=np.float64), (len(observations), 1))
        actions[self._come(observations), IMMIGRANTS] = self.immigrants
        return actions

    @abstractmethod
    def _come(self, observations: NDArray) -> NDArray[np.bool_]:
        """Return (B,) whether immigrants come in the next iteration, and remember what is seen."""


@dataclass
class Restart(ImmigrantRule):
    """Immigrants after `patience` iterations without progress.

    Attributes:
        patience: number of consecutive iterations without an improvement after which immigrants come.
        improvement: smallest fall of the logarithm of the best fitness that counts as an improvement.
    """

    patience: int = 10
    improvement: float = 0.001
    observation: str = "extended"
    ranges: ClassVar[Mapping[str, Range]] = {
        "patience": Range(1, 1000, integer=True),
        "improvement": Range(0.0, 10.0),
    }

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget best fitness and counts."""
        self._best = np.zeros(num_swarms)
        self._stagnation = np.zeros(num_swarms, dtype=np.int64)

    def _come(self, observations: NDArray) -> NDArray[np.bool_]:
        best = observations[:, column(self.observation, BEST_FITNESS)]
        improved = self._best - best > self.improvement
        self._best = best
        begins = observations[:, ITERATION] == 0
        self._stagnation = np.where(improved | begins, 0, self._stagnation + 1)
        restarts = self._stagnation >= self.patience
        self._stagnation[restarts] = 0
        return restarts


@dataclass
class Periodic(ImmigrantRule):
    """Immigrants every `period` iterations, whatever happens: a blind rule.

    Attributes:
        period: number of iterations from one immigration to the next.
        phase: number of iterations before the first immigration.
    """

    period: int = 10
    phase: int = 10
    observation: str = "paper"
    ranges: ClassVar[Mapping[str, Range]] = {
        "period": Range(1, 1000, integer=True),
        "phase": Range(0, 1000, integer=True),
    }

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the rule has no memory."""

    def _come(self, observations: NDArray) -> NDArray[np.bool_]:
        since = observations[:, ITERATION] - self.phase
        return (since >= 0) & (since % self.period == 0)


@dataclass
class Reaction(ImmigrantRule):
    """Immigrants and more noise for `duration` iterations after E(P) has jumped.

    While it reacts, and in the iteration after it, jumps do not count: immigrants raise E(P) themselves.

    Attributes:
        jump: smallest rise of log(1 + E(P)) from one iteration to the next that counts as a jump.
        duration: number of iterations of a reaction.
        hypermutation: factor of the noise in these iterations; the noise stays in its range.
    """

    jump: float = 0.5
    duration: int = 3
    hypermutation: float = 1.0
    observation: str = "jumps"
    ranges: ClassVar[Mapping[str, Range]] = {
        "jump": Range(0.0, 8.0),
        "duration": Range(1, 1000, integer=True),
        "hypermutation": Range(1.0, 1000.0),
    }

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget reactions."""
        self._left = np.zeros(num_swarms, dtype=np.int64)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 7) decisions; iteration 0 in an observation begins an episode of that swarm."""
        actions = super().act(observations)
        highest = ImmigrantRule.ranges["noise"].high
        actions[self._left > 0, NOISE] = min(self.noise * self.hypermutation, highest)
        return actions

    def _come(self, observations: NDArray) -> NDArray[np.bool_]:
        jumped = 8.0 * observations[:, column(self.observation, JUMP)] > self.jump
        begins = observations[:, ITERATION] == 0
        # `_left` is still that of the last decision: above 0 if it was part of a reaction.
        left = np.where(self._left > 0, self._left - 1, np.where(jumped, self.duration, 0))
        self._left = np.where(begins, 0, left)
        return self._left > 0
