"""The hand-designed schedule of the SPSFA paper.

Source: J. Li, H. Fan, Y. Hou, "A firefly algorithm with self-adaptive population size for global path
planning of mobile robot", IEEE Access 8 (2020), section III, eq. 8-11 and 17. Rounding, floor and cap of the
population size and PS(0) are not printed; see docs/readings.md.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from agents.controller import Controller, Floats, SizeLimits


@dataclass
class SelfAdaptiveSchedule(Controller):
    """SPSFA: grow while the population collides worse than at first, then shrink with E(P).

    Attributes:
        treats_infeasible_paths: whether phi is decided too (SPSFA-TIP), or is 0 (SPSFA).
        growth: omega of the up rule.
        decay: eta of the down rule.
        low_deviation: T_low; phi is used only where the standard deviation of the collision is no larger.
        initial_population_size: PS(0).
        limits: the sizes that the environment allows.
    """

    treats_infeasible_paths: bool = False
    growth: float = 1000.0
    decay: float = 0.2
    low_deviation: float = 20.0
    initial_population_size: int = 80
    limits: SizeLimits = field(default_factory=SizeLimits)

    def __post_init__(self) -> None:
        self.initial_population_size = self.limits.clip(self.initial_population_size)
        self.reset(0)

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget E_init, the sizes and PS_max."""
        self._first = np.zeros(num_swarms)  # E_init
        self._size = np.zeros(num_swarms)
        self._largest = np.zeros(num_swarms)  # PS_max

    def act(self, observations: NDArray) -> Floats:
        """Next sizes and phi; an observation of iteration 0 begins an episode of that swarm."""
        current, _, deviation, iteration = observations.T
        begin = iteration == 0
        self._first = np.where(begin, current, self._first)
        self._size = np.where(begin, self.initial_population_size, self._next_size(current))
        self._largest = np.where(begin, self._size, np.maximum(self._largest, self._size))
        repair = np.clip(2.0 * self._largest / self._size**2, 0.0, 1.0)  # eq. 17
        gated = begin | (deviation > self.low_deviation) | (not self.treats_infeasible_paths)
        return np.stack([self._size, np.where(gated, 0.0, repair)], axis=1)

    def _next_size(self, current: Floats) -> Floats:
        # Divisions by zero belong to episodes that are just beginning, or are replaced below.
        with np.errstate(divide="ignore", invalid="ignore"):
            up = self._size + self.growth / self._size  # eq. 9
            down = self._largest * (current / self._first) ** self.decay  # eq. 10, 11
        down = np.where(self._first > 0.0, down, self._size)  # no first collision: nothing to relate to
        size = np.floor(np.where(current > self._first, up, down) + 0.5)
        return np.clip(size, self.limits.smallest, self.limits.largest)
