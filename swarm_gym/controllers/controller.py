"""A controller: from what is seen of a swarm to its next population size and repair degree."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

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


class Controller(ABC):
    """Decides for many swarms at once; decisions for a swarm do not depend on the others.

    Attributes:
        observation: name of the observation layout that `act` expects.
        action: name of the action layout that `act` answers in.
        initial_population_size: PS(0), to be given to the environment.
        max_evaluations: evaluation budget of an episode, where the controller needs one.
        price: what evaluations cost, where the controller sees it.
        corrects: its base, if it corrects another controller; `observation` begins with the layout of that.
    """

    observation: str = "paper"
    action: str = "natural"
    initial_population_size: int
    max_evaluations: int | None = None
    price: float | None = None
    corrects: "Controller | None" = None

    @abstractmethod
    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes of this many swarms; the random decisions of swarm b are seeded with seed + b."""

    @abstractmethod
    def act(self, observations: NDArray) -> NDArray:
        """Actions (num_swarms, number of decisions), in the layout `action`.

        Args:
            observations: shape (num_swarms, k), in the layout `observation`.
        """

    def env_options(self) -> dict[str, Any]:
        """What the environment has to be made with for this controller."""
        options: dict[str, Any] = {
            "observation": self.observation,
            "action": self.action,
            "initial_population_size": self.initial_population_size,
        }
        if self.max_evaluations is not None:
            options["max_evaluations"] = self.max_evaluations
        if self.price is not None:
            options["price"] = self.price
        return options


def require_fitting(controller: Controller, max_evaluations: int | None) -> None:
    """Refuse a controller that is to decide in episodes made for another one, but needs others.

    Args:
        controller: what is to decide.
        max_evaluations: budget of these episodes; None is no budget.

    Raises:
        ValueError: if it was made for another budget, or for a price that it sees.
    """
    if controller.max_evaluations not in (None, max_evaluations):
        raise ValueError(
            f"it needs episodes with max_evaluations {controller.max_evaluations}, but these have "
            f"{max_evaluations or 'no budget'}"
        )
    if controller.price is not None:
        raise ValueError(f"it is told a price, {controller.price:g}, that these episodes need not have")
