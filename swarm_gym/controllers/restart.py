"""A hand-made rule that restarts a swarm when it stagnates: smooth immigrants replace its worst members.

Sources of the idea: J. Grefenstette, "Genetic algorithms for changing environments", PPSN 2 (1992), where
random immigrants replace a share of the members in every generation; A. Auger, N. Hansen, "A restart CMA
evolution strategy with increasing population size", IEEE CEC 2005, where stagnation starts the restart.
Immigrants replace the members that shrinking would delete, and the best path so far is stored apart.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Floats, SizeLimits
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.rule import BEST_FITNESS, Rule, column
from swarm_gym.observation import ITERATION
from swarm_gym.sources import SOURCE_RANGES, Source


@dataclass
class Restart(Rule):
    """A rule for fireflies: a constant size, and immigrants after `patience` iterations without progress.

    All new members are smooth. The defaults of size, phi, noise and attractiveness are those of FA-60.

    Attributes:
        size: population size of every iteration; the default is clipped to the limits.
        noise: alpha, in map units.
        attractiveness: beta0 in [0.01, 1].
        amplitude: largest offset of new members as a share of the workspace's width, in [0.01, 1].
        patience: number of consecutive iterations without an improvement after which immigrants come.
        improvement: smallest fall of the logarithm of the best fitness that counts as an improvement.
        immigrants: share of the members that they replace, in [0, 1].
    """

    start: int = 150
    size: int = 60
    noise: float = 2.0
    attractiveness: float = 0.1
    amplitude: float = 0.5
    patience: int = 10
    improvement: float = 0.001
    immigrants: float = 0.5
    observation: str = "extended"
    action: str = "sourced"
    sizes: ClassVar[tuple[str, ...]] = ("start", "size")

    def __post_init__(self) -> None:
        super().__post_init__()
        self.first_source = Source(1.0, self.amplitude)

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """Return the range of every parameter by its name."""
        return {
            **super().parameter_ranges(limits),
            "noise": Range(0.02, 100.0),
            "attractiveness": Range(0.01, 1.0),
            "amplitude": Range(*SOURCE_RANGES["amplitude"]),
            "patience": Range(1, 1000, integer=True),
            "improvement": Range(0.0, 10.0),
            "immigrants": Range(*SOURCE_RANGES["immigrants"]),
        }

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget best fitness and counts."""
        self._best = np.zeros(num_swarms)
        self._stagnation = np.zeros(num_swarms, dtype=np.int64)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 7) decisions; iteration 0 in an observation begins an episode of that swarm."""
        best, begins = (
            observations[:, column(self.observation, BEST_FITNESS)],
            observations[:, ITERATION] == 0,
        )
        improved = self._best - best > self.improvement
        self._best = best
        self._stagnation = np.where(improved | begins, 0, self._stagnation + 1)
        restarts = self._stagnation >= self.patience
        self._stagnation[restarts] = 0
        decided = [self.size, self.repair_degree, self.noise, self.attractiveness, 1.0, self.amplitude, 0.0]
        actions = np.tile(np.array(decided, dtype=np.float64), (len(observations), 1))
        actions[restarts, -1] = self.immigrants
        return actions
