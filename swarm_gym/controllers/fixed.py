"""Controllers that ignore observations: a constant population size, and random decisions."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, SizeLimits

LARGEST = 10_000


class Fixed(Controller):
    """A constant population size without repair: FA-60, FA-80 and FA-100 of the SPSFA paper.

    For a size above the limits, the environment is made with a larger maximum.
    """

    def __init__(self, population_size: int, limits: SizeLimits = SizeLimits()):  # noqa: B008
        if not limits.smallest <= population_size <= LARGEST:
            raise ValueError(
                f"a fixed population size must lie in [{limits.smallest}, {LARGEST}], got {population_size}"
            )
        self.initial_population_size = population_size
        self._limits = limits

    def env_options(self) -> dict[str, Any]:
        """Return the options that the environment of this controller needs."""
        options = super().env_options()
        if self.initial_population_size > self._limits.largest:
            options["max_population_size"] = self.initial_population_size
        return options

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the controller has no state."""

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 2) decisions: the constant size, and phi = 0."""
        return np.tile([float(self.initial_population_size), 0.0], (len(observations), 1))


class Random(Controller):
    """Uniformly random population sizes and phi: the lower end of every comparison."""

    def __init__(self, limits: SizeLimits = SizeLimits()):  # noqa: B008
        self.limits = limits
        self.initial_population_size = limits.clip(80)
        self._generators: list[np.random.Generator] = []

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Seed one generator per swarm."""
        self._generators = [np.random.default_rng(seed + row) for row in range(num_swarms)]

    def act(self, observations: NDArray) -> Floats:  # noqa: ARG002
        """Draw (B, 2) decisions, one row per swarm."""
        draws = np.array([generator.random(2) for generator in self._generators])
        low = [self.limits.smallest, 0.0]
        high = [self.limits.largest, 1.0]
        return low + draws * np.subtract(high, low)
