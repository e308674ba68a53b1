"""Base class of hand-made rules: parameters with ranges, their text in names, and PS(0)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar, Self

from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.parameters import Range, parse_parameters
from swarm_gym.observation import make_observation

SHARE_DONE = "share of the iterations done"
BEST_FITNESS = "log(best fitness / lower bound)"


@dataclass
class Rule(Controller):
    """A rule whose parameters are fields with ranges.

    Attributes:
        start: PS(0); the default is clipped to the limits.
        repair_degree: phi in [0, 1] of every iteration.
        limits: population sizes that the environment allows.
        sizes: names of the parameters that are population sizes.
        ranges: ranges of the other parameters that the class adds to its base class.

    Raises:
        SettingError: for a parameter outside its range, see `parameter_ranges`.
    """

    start: int = 100
    repair_degree: float = 0.0
    limits: SizeLimits = field(default_factory=SizeLimits)
    sizes: ClassVar[tuple[str, ...]] = ("start",)
    ranges: ClassVar[Mapping[str, Range]] = {"repair_degree": Range(0.0, 1.0)}

    def __post_init__(self) -> None:
        for name in self.sizes:
            if getattr(self, name) == getattr(type(self), name):
                setattr(self, name, self.limits.clip(getattr(self, name)))
        for name, span in self.parameter_ranges(self.limits).items():
            span.require(name, getattr(self, name))
        self.initial_population_size = self.start
        self.reset(0)

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:
        """Return the rule with parameters such as `start=120,repair_degree=0.2`; empty text is the defaults.

        Raises:
            SettingError: for an unknown key, a repeated key or a value outside its range; the message lists
                the valid keys and ranges.
        """
        values: dict[str, Any] = parse_parameters(argument, cls.parameter_ranges(limits))
        return cls(**values, limits=limits)

    def identity(self) -> object:
        """Return the name of the rule, its parameters, and the population sizes that it may choose."""
        parameters = {name: getattr(self, name) for name in self.parameter_ranges(self.limits)}
        return type(self).__name__, parameters, self.limits.identity()

    @classmethod
    def parameter_ranges(cls, limits: SizeLimits) -> dict[str, Range]:
        """Return the range of every parameter by its name, base classes first."""
        sizes = {name: Range(limits.smallest, limits.largest, integer=True) for name in cls.sizes}
        own = [vars(one).get("ranges", {}) for one in reversed(cls.__mro__)]
        return {**sizes, **{name: span for ranges in own for name, span in ranges.items()}}


@cache
def column(layout: str, feature: str) -> int:
    """Return the index of a feature in an observation layout."""
    return [one.name for one in make_observation(layout).features].index(feature)
