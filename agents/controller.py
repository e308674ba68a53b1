"""A controller: from what is seen of a swarm to its next population size and repair degree."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SizeLimits:
    """The population sizes that an environment allows; the defaults are the environments'."""

    smallest: int = 2
    largest: int = 200

    def __post_init__(self) -> None:
        if not 1 <= self.smallest <= self.largest:
            raise ValueError(
                f"population sizes must satisfy 1 <= smallest <= largest, got {self.smallest} and "
                f"{self.largest}"
            )

    def clip(self, size: int) -> int:
        """The nearest size that is allowed."""
        return min(max(size, self.smallest), self.largest)


@runtime_checkable
class Controller(Protocol):
    """Decides for many swarms at once; decisions for a swarm do not depend on the others.

    Attributes:
        observation: name of the observation layout that `act` expects.
        initial_population_size: PS(0), to be given to the environment.
    """

    observation: str
    initial_population_size: int

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes of this many swarms; the random decisions of swarm b are seeded with seed + b."""

    def act(self, observations: NDArray) -> Floats:
        """Actions (num_swarms, 2), population size and phi in natural units.

        Args:
            observations: shape (num_swarms, k), in the layout `observation`.
        """
