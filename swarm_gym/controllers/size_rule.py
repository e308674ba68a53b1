"""What hand-designed rules of the population size from the literature have in common.

They were written for other optimizers and decide the size alone: phi is a constant here, 0 where a rule is
taken as it was published.
"""

from abc import abstractmethod
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.parameters import Range, parse_parameters
from swarm_gym.observation import make_observation


@dataclass
class SizeRule(Controller):
    """A rule of the population size, with a constant phi.

    Attributes:
        start: PS(0), and the size of iteration 1; the default gives way to the limits.
        smallest: floor of the sizes after that; the default gives way to the limits.
        repair_degree: phi in [0, 1] of every iteration.
        limits: the sizes that the environment allows.

    Raises:
        SettingError: for a parameter outside its range, see `parameter_ranges`.
    """

    start: int = 100
    smallest: int = 10
    repair_degree: float = 0.0
    limits: SizeLimits = field(default_factory=SizeLimits)

    def __post_init__(self) -> None:
        for name in ("start", "smallest"):
            if getattr(self, name) == getattr(type(self), name):
                setattr(self, name, self.limits.clip(getattr(self, name)))
        for name, span in self.parameter_ranges(self.limits).items():
            span.require(name, getattr(self, name))
        self.initial_population_size = self.start
        self.reset(0)

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:
        """The rule with parameters as `start=120,smallest=10`; empty is the defaults.

        Raises:
            SettingError: for an unknown or doubled key or a value out of its range; the message lists both.
        """
        values: dict[str, Any] = parse_parameters(argument, cls.parameter_ranges(limits))
        return cls(**values, limits=limits)

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """What the parameters may be."""
        sizes = Range(limits.smallest, limits.largest, integer=True)
        return {"start": sizes, "smallest": sizes, "repair_degree": Range(0.0, 1.0)}

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget the sizes."""
        self._size = np.zeros(num_swarms)

    def act(self, observations: NDArray) -> Floats:
        """Next sizes and phi; an observation of iteration 0 begins an episode of that swarm."""
        begin = observations[:, column(self.observation, SHARE_DONE)] == 0
        size = np.floor(self._next_size(observations.astype(np.float64), begin) + 0.5)
        self._size = np.where(begin, self.start, np.clip(size, self.smallest, self.limits.largest))
        return np.stack([self._size, np.full(len(self._size), self.repair_degree)], axis=1)

    @abstractmethod
    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:
        """Real-valued sizes, (B,), from those in `_size`; where an episode begins, only the memory counts."""


SHARE_DONE = "share of the iterations done"
BEST_FITNESS = "log(best fitness / lower bound)"
DIVERSITY = "log(1 + diversity) / 8"


def column(layout: str, feature: str) -> int:
    """The place of a feature in an observation layout."""
    return [one.name for one in make_observation(layout).features].index(feature)
