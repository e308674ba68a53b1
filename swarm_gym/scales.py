"""Scales: how the decisions of an action are written as its numbers."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import applied, as_numpy, at_least, floats
from swarm_gym.compiler.elementary import exp, log
from swarm_gym.errors import SettingError
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

# Largest factor between the size that a paced action asks for and the size at which the budget lasts.
PACE_SPREAD = 6.0
_LOG_PACE_SPREAD = 1.791759469228055  # not computed: the last digit would be that of the C library


class Scale(ABC):
    """The scale on which one decision is written as a number of an action.

    Attributes:
        low: smallest number of the action.
        high: largest number of the action.
    """

    low: float
    high: float

    @abstractmethod
    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:
        """Return the numbers (B,) that ask for these values (B,); they may exceed `low` and `high`."""

    @abstractmethod
    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:
        """Return the values (B,) that these numbers (B,) ask for."""


@dataclass(frozen=True)
class AsItIs(Scale):
    """The scale of a number in its own unit."""

    low: float
    high: float

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        return values

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        return numbers


@dataclass(frozen=True)
class WithoutEffect(Scale):
    """The scale of a decision that an optimizer does not have: every number in [-1, 1] stands for 0."""

    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        return np.zeros(len(values))

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        return 0.0 * numbers


@dataclass(frozen=True)
class Linear(Scale):
    """The scale that maps [smallest, largest] linearly to [-1, 1]."""

    smallest: float
    largest: float
    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        return 2.0 * (values - self.smallest) / (self.largest - self.smallest) - 1.0

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        return self.smallest + (self.largest - self.smallest) * (numbers + 1.0) / 2.0


@dataclass(frozen=True)
class Logarithmic(Scale):
    """The scale that maps the logarithm of [smallest, largest], both positive, to [-1, 1]."""

    smallest: float
    largest: float
    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        lowest, highest = self._ends
        spread = max(highest - lowest, 1e-9)
        positive = np.maximum(values, self.smallest)  # the default of a parameter may be 0
        return 2.0 * (log(positive) - lowest) / spread - 1.0

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: D102
        return self.smallest * exp(self._ratio * ((numbers + 1.0) / 2.0), simulation.xp)

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """The logarithms of the smallest and the largest value."""
        lowest, highest = log([self.smallest, self.largest]).tolist()
        return lowest, highest

    @cached_property
    def _ratio(self) -> float:
        """The logarithm of the largest value over the smallest."""
        return float(log(self.largest / self.smallest))


@dataclass(frozen=True)
class Centred(Scale):
    """The scale that maps the logarithm of [smallest, largest], both positive, to [-1, 1], and centre to 0.

    It is linear on either side of 0. Networks begin with outputs near 0, and so with values near the centre.

    Raises:
        SettingError: if the centre is not between the other two.
    """

    smallest: float
    centre: float
    largest: float
    low: float = -1.0
    high: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.smallest <= self.centre <= self.largest:
            raise SettingError(
                f"a centred scale needs 0 < smallest <= centre <= largest, got {self.smallest:g}, "
                f"{self.centre:g}, {self.largest:g}"
            )

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        below, above = self._spreads
        distances = log(np.maximum(values, self.smallest) / self.centre)
        return np.where(distances < 0.0, distances / max(below, 1e-9), distances / max(above, 1e-9))

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: D102
        below, above = self._spreads
        xp = simulation.xp
        return self.centre * exp(xp.where(numbers < 0.0, below * numbers, above * numbers), xp)

    @cached_property
    def _spreads(self) -> tuple[float, float]:
        """The logarithms of centre over smallest, and of largest over centre."""
        below, above = log([self.centre / self.smallest, self.largest / self.centre]).tolist()
        return below, above


@dataclass(frozen=True)
class Kinked(Scale):
    """The scale that maps [smallest, largest] to [-1, 1], and centre to 0, linearly on either side of it.

    Raises:
        SettingError: if the centre is not between the other two.
    """

    smallest: float
    centre: float
    largest: float
    low: float = -1.0
    high: float = 1.0

    def __post_init__(self) -> None:
        if not self.smallest < self.centre < self.largest:
            raise SettingError(
                f"a kinked scale needs smallest < centre < largest, got {self.smallest:g}, {self.centre:g}, "
                f"{self.largest:g}"
            )

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        distances = values - self.centre
        below, above = self.centre - self.smallest, self.largest - self.centre
        return np.where(distances < 0.0, distances / below, distances / above)

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: D102
        below, above = self.centre - self.smallest, self.largest - self.centre
        return self.centre + simulation.xp.where(numbers < 0.0, below * numbers, above * numbers)


@dataclass(frozen=True)
class FourthPower(Scale):
    """The scale on which a number a in [-1, 1] asks for ((a + 1) / 2)^4, so that 0 asks for 1 / 16.

    It is for shares such as phi, most values of which ruin a swarm that is not ready for them.
    """

    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        return 2.0 * np.sqrt(np.sqrt(values)) - 1.0

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        root = (numbers + 1.0) / 2.0
        return (root * root) * (root * root)


@dataclass(frozen=True)
class Paced(Scale):
    """The scale of population sizes relative to the one at which the evaluation budget would just last.

    A number a in [-1, 1] asks for PACE_SPREAD^a times that size. The budget is never exceeded, and
    evaluations that are not spent now remain for later iterations.
    """

    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: D102
        if simulation is None:
            raise SettingError(
                "paced actions depend on the remaining evaluations: encode them with a simulation"
            )
        return log(values / as_numpy(self._lasting(simulation))) / _LOG_PACE_SPREAD

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: D102
        return self._lasting(simulation) * exp(_LOG_PACE_SPREAD * numbers, simulation.xp)

    def _lasting(self, simulation: Simulation) -> Floats:
        """Return (B,) sizes at which the evaluations that are left last to the end of the episode."""
        swarms, xp = simulation.swarms, simulation.xp
        iterations_left = at_least(xp, simulation.settings.iterations - simulation.iteration, 1)
        pace = floats(xp, swarms.budget - swarms.evaluations) / iterations_left
        return applied(simulation.optimizer.affordable_size, xp, pace)
