"""What an optimizer offers to the simulation that drives it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_number
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Table


@dataclass(frozen=True)
class Knob:
    """A numeric parameter of an optimizer.

    Attributes:
        default: its value where nothing else is said.
        low: the least value it may take.
        high: the largest.
        symbol: the paper's letter.
        meaning: what it is, with its unit.
        decided: the range, both positive, that an extended action decides within at every iteration; None
            leaves the parameter as it is through an episode.
    """

    default: float
    low: float
    high: float
    symbol: str
    meaning: str
    decided: tuple[float, float] | None = None


class Optimizer(ABC):
    """Names and parameters around the two compiled calls of an optimizer.

    All arrays have a leading swarm axis of length B. Both calls change `swarms` in place, and leave
    E(P), mean and standard deviation of the collision and the feasible share in `swarms.summary`.
    """

    name: ClassVar[str]
    knobs: ClassVar[dict[str, Knob]]

    @staticmethod
    @abstractmethod
    def initialise(
        swarms: Swarms,
        tables: Table,
        chosen: NDArray[np.bool_],
        sizes: NDArray[np.int64],
        mean_weight: float,
    ) -> None:
        """Draw and evaluate first populations of the given sizes for the chosen swarms."""

    @staticmethod
    @abstractmethod
    def step(
        swarms: Swarms,
        tables: Table,
        chosen: NDArray[np.bool_],
        sizes: NDArray[np.int64],
        repair_degrees: NDArray[np.float64],
        knobs: NDArray[np.float64],
        mean_weight: float,
        parallel: bool,
    ) -> None:
        """Resize the chosen swarms and advance them by one iteration.

        Args:
            swarms: the state.
            tables: stacked problems.
            chosen: (B,) which swarms take part.
            sizes: (B,) population sizes of this iteration.
            repair_degrees: (B,) phi in [0, 1]; 0 is no repair.
            knobs: (B, number of knobs) parameters in the order of `knobs`.
            mean_weight: k of eq. 7.
            parallel: spread the swarms over threads.
        """

    @staticmethod
    @abstractmethod
    def affordable_size(evaluations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Real-valued population sizes, (B,), whose iterations take about that many evaluations, (B,)."""

    @classmethod
    def decided_knobs(cls) -> dict[int, Knob]:
        """The parameters that extended actions decide, by their place in `knobs`."""
        return {place: knob for place, knob in enumerate(cls.knobs.values()) if knob.decided is not None}

    @classmethod
    def knob_values(cls, chosen: dict[str, float]) -> NDArray[np.float64]:
        """Parameters in order, the chosen ones in place of their defaults.

        Raises:
            SettingError: if a value is not a number in its range.
        """
        values = []
        for name, knob in cls.knobs.items():
            value = chosen.get(name, knob.default)
            require_number(name, value, knob.low, knob.high)
            values.append(float(value))
        return np.array(values)
