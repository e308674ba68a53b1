"""Controllers that do not look: a constant size, and chance."""

import numpy as np
from numpy.typing import NDArray

from agents.controller import Controller, Floats, SizeLimits


class Fixed(Controller):
    """A constant population size without repair: FA-60, FA-80 and FA-100 of the SPSFA paper."""

    def __init__(self, population_size: int, limits: SizeLimits = SizeLimits()):  # noqa: B008
        if not limits.smallest <= population_size <= limits.largest:
            raise ValueError(
                f"a fixed population size must lie in [{limits.smallest}, {limits.largest}], "
                f"got {population_size}"
            )
        self.initial_population_size = population_size

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Nothing to begin."""

    def act(self, observations: NDArray) -> Floats:
        """The same size always, phi = 0."""
        return np.tile([float(self.initial_population_size), 0.0], (len(observations), 1))


class Random(Controller):
    """Uniform over all population sizes and phi: the floor of every comparison."""

    def __init__(self, limits: SizeLimits = SizeLimits()):  # noqa: B008
        self.limits = limits
        self.initial_population_size = limits.clip(80)
        self._generators: list[np.random.Generator] = []

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Seed one generator per swarm."""
        self._generators = [np.random.default_rng(seed + row) for row in range(num_swarms)]

    def act(self, observations: NDArray) -> Floats:  # noqa: ARG002
        """A fresh draw per swarm."""
        draws = np.array([generator.random(2) for generator in self._generators])
        low = [self.limits.smallest, 0.0]
        high = [self.limits.largest, 1.0]
        return low + draws * np.subtract(high, low)
