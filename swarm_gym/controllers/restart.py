"""A hand-made rule that restarts a swarm when it stagnates: smooth immigrants replace its worst members.

Sources of the idea: J. Grefenstette, "Genetic algorithms for changing environments", PPSN 2 (1992), where
random immigrants replace a share of the members in every generation; A. Auger, N. Hansen, "A restart CMA
evolution strategy with increasing population size", IEEE CEC 2005, where stagnation starts the restart. The
best members stay, so a restart loses nothing.
"""

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.parameters import Range, parse_parameters
from swarm_gym.observation import ITERATION, make_observation
from swarm_gym.sources import SMALLEST_AMPLITUDE, Source

BEST_FITNESS = "log(best fitness / lower bound)"


@dataclass
class Restart(Controller):
    """A rule for fireflies: a constant size, and immigrants after `patience` iterations without progress.

    All new members are smooth. The defaults of size, phi, noise and attractiveness are those of FA-60.

    Attributes:
        start: PS(0).
        size: population size of every iteration; the default is clipped to the limits.
        repair_degree: phi in [0, 1] of every iteration.
        noise: alpha, in map units.
        attractiveness: beta0 in [0.01, 1].
        amplitude: largest offset of new members as a share of the workspace's width, in [0.01, 1].
        patience: number of consecutive iterations without an improvement after which immigrants come.
        improvement: smallest fall of the logarithm of the best fitness that counts as an improvement.
        immigrants: share of the members that they replace, in [0, 1].
        limits: population sizes that the environment allows.

    Raises:
        SettingError: for a parameter outside its range, see `parameter_ranges`.
    """

    start: int = 150
    size: int = 60
    repair_degree: float = 0.0
    noise: float = 2.0
    attractiveness: float = 0.1
    amplitude: float = 0.5
    patience: int = 10
    improvement: float = 0.001
    immigrants: float = 0.5
    limits: SizeLimits = field(default_factory=SizeLimits)
    observation: str = "extended"
    action: str = "sourced"

    def __post_init__(self) -> None:
        for name in ("start", "size"):
            if getattr(self, name) == getattr(type(self), name):
                setattr(self, name, self.limits.clip(getattr(self, name)))
        for name, span in self.parameter_ranges(self.limits).items():
            span.require(name, getattr(self, name))
        self.initial_population_size = self.start
        self.first_source = Source(1.0, self.amplitude)
        features = [feature.name for feature in make_observation(self.observation).features]
        self._best_fitness = features.index(BEST_FITNESS)
        self.reset(0)

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:
        """Return the rule with parameters such as `size=40,patience=5`; empty text is the defaults.

        Raises:
            SettingError: for an unknown key, a repeated key or a value outside its range; the message lists
                the valid keys and ranges.
        """
        values: dict[str, Any] = parse_parameters(argument, cls.parameter_ranges(limits))
        return cls(**values, limits=limits)

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """Return the range of every parameter by its name."""
        sizes = Range(limits.smallest, limits.largest, integer=True)
        return {
            "start": sizes,
            "size": sizes,
            "repair_degree": Range(0.0, 1.0),
            "noise": Range(0.02, 100.0),
            "attractiveness": Range(0.01, 1.0),
            "amplitude": Range(SMALLEST_AMPLITUDE, 1.0),
            "patience": Range(1, 1000, integer=True),
            "improvement": Range(0.0, 10.0),
            "immigrants": Range(0.0, 1.0),
        }

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget best fitness and counts."""
        self._best = np.zeros(num_swarms)
        self._stagnation = np.zeros(num_swarms, dtype=np.int64)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 7) decisions; iteration 0 in an observation begins an episode of that swarm."""
        best, begins = observations[:, self._best_fitness], observations[:, ITERATION] == 0
        improved = self._best - best > self.improvement
        self._best = best
        self._stagnation = np.where(improved | begins, 0, self._stagnation + 1)
        restarts = self._stagnation >= self.patience
        self._stagnation[restarts] = 0
        decided = [self.size, self.repair_degree, self.noise, self.attractiveness, 1.0, self.amplitude, 0.0]
        actions = np.tile(np.array(decided, dtype=np.float64), (len(observations), 1))
        actions[restarts, -1] = self.immigrants
        return actions
