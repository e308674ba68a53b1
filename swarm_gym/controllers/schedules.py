"""The hand-designed schedule of the SPSFA paper.

Source: J. Li, H. Fan, Y. Hou, "A firefly algorithm with self-adaptive population size for global path
planning of mobile robot", IEEE Access 8 (2020), section III, eq. 8-11 and 17. Rounding, floor and cap of the
population size and PS(0) are not printed; see docs/readings.md.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import power
from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.parameters import Number, Range, format_parameters, parse_parameters


@dataclass
class SelfAdaptiveSchedule(Controller):
    """The schedule SPSFA: sizes grow while E(P) exceeds its first value, then shrink with E(P).

    Attributes:
        treats_infeasible_paths: True decides phi too (SPSFA-TIP); False is phi = 0 (SPSFA).
        growth: omega of the growing rule, eq. 9.
        decay: eta of the shrinking rule, eq. 10 and 11.
        low_deviation: T_low; phi is 0 where the standard deviation of the collision is larger.
        initial_population_size: PS(0); the default is clipped to the limits.
        smallest: smallest population size; None takes the limit. This parameter is not in the paper.
        repair_factor: factor on phi of eq. 17, before phi is clipped to [0, 1]; 1 is the paper's rule.
        limits: population sizes that the environment allows.

    Raises:
        SettingError: for a parameter outside its range, see `parameter_ranges`.
    """

    treats_infeasible_paths: bool = False
    growth: float = 1000.0
    decay: float = 0.2
    low_deviation: float = 20.0
    initial_population_size: int = 80
    smallest: int | None = None
    repair_factor: float = 1.0
    limits: SizeLimits = field(default_factory=SizeLimits)

    def __post_init__(self) -> None:
        if self.initial_population_size == SelfAdaptiveSchedule.initial_population_size:
            self.initial_population_size = self.limits.clip(self.initial_population_size)
        for name, span in parameter_ranges(self.limits).items():
            value = getattr(self, name)
            if not (name == "smallest" and value is None):
                span.require(name, value)
                setattr(self, name, int(value) if span.integer else float(value))  # NumPy's numbers too
        self.reset(0)

    @classmethod
    def from_argument(
        cls, argument: str, limits: SizeLimits, treats_infeasible_paths: bool
    ) -> "SelfAdaptiveSchedule":
        """Return the schedule with parameters such as `growth=500,decay=0.1`; empty text is the paper's.

        Raises:
            SettingError: for an unknown key, a repeated key or a value outside its range; the message lists
                the valid keys and ranges.
        """
        values: dict[str, Any] = parse_parameters(argument, parameter_ranges(limits))
        return cls(treats_infeasible_paths, **values, limits=limits)

    @property
    def name(self) -> str:
        """The name for `make_controller`: the family, and all parameters that differ from the defaults."""
        family = "spsfa-tip" if self.treats_infeasible_paths else "spsfa"
        changed = {
            name: getattr(self, name)
            for name, default in _defaults(self.limits).items()
            if getattr(self, name) != default
        }
        return str(ControllerName(family, parameters=format_parameters(changed) if changed else None))

    def identity(self) -> object:
        """Return all parameters, and the population sizes that the environment allows."""
        parameters = {name: getattr(self, name) for name in parameter_ranges(self.limits)}
        return "spsfa", self.treats_infeasible_paths, parameters, self.limits.identity()

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget E_init, the population sizes and PS_max."""
        self._first = np.zeros(num_swarms)  # E_init
        self._size = np.zeros(num_swarms)
        self._largest = np.zeros(num_swarms)  # PS_max

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 2) next sizes and phi; iteration 0 in an observation begins an episode of that swarm."""
        current, _, deviation, iteration = observations.T
        begin = iteration == 0
        self._first = np.where(begin, current, self._first)
        self._size = np.where(begin, self.initial_population_size, self._next_size(current))
        self._largest = np.where(begin, self._size, np.maximum(self._largest, self._size))
        repair = np.clip(self.repair_factor * 2.0 * self._largest / self._size**2, 0.0, 1.0)  # eq. 17
        gated = begin | (deviation > self.low_deviation) | (not self.treats_infeasible_paths)
        return np.stack([self._size, np.where(gated, 0.0, repair)], axis=1)

    def _next_size(self, current: Floats) -> Floats:
        # Divisions by zero occur where an episode begins, or their results are replaced below.
        with np.errstate(divide="ignore", invalid="ignore"):
            up = self._size + self.growth / self._size  # eq. 9
            down = self._largest * power(current / self._first, self.decay)  # eq. 10, 11
        down = np.where(self._first > 0.0, down, self._size)  # no first collision: nothing to relate to
        size = np.floor(np.where(current > self._first, up, down) + 0.5)
        smallest = self.limits.smallest if self.smallest is None else self.smallest
        return np.clip(size, smallest, self.limits.largest)


def parameter_ranges(limits: SizeLimits) -> dict[str, Range]:
    """Return the range of every parameter; ranges of real numbers only exclude absurd values."""
    sizes = Range(limits.smallest, limits.largest, integer=True)
    return {
        "growth": Range(0.0, 1e6),
        "decay": Range(0.0, 100.0),
        "low_deviation": Range(0.0, 1e6),
        "initial_population_size": sizes,
        "smallest": sizes,
        "repair_factor": Range(0.0, 1e6),
    }


def _defaults(limits: SizeLimits) -> dict[str, Number | None]:
    """Return the default of every parameter, given these limits."""
    found = {name: getattr(SelfAdaptiveSchedule, name) for name in parameter_ranges(limits)}
    found["initial_population_size"] = limits.clip(found["initial_population_size"])
    return found
