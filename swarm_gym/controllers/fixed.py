"""Controllers that ignore observations: a constant population size, and random decisions.

`fixed:60` is the paper's FA-60. `fixed:60,smooth_share=1,amplitude=0.3` begins with smooth members, see
`swarm_gym.sources`.
"""

from dataclasses import fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, NeededOptions, SizeLimits
from swarm_gym.controllers.parameters import Range, parse_parameters
from swarm_gym.errors import SettingError, shown
from swarm_gym.sources import SOURCE_RANGES, Source

LARGEST = 10_000
FIRST_SOURCE = {one.name: Range(*SOURCE_RANGES[one.name]) for one in fields(Source)}


class Fixed(Controller):
    """A constant population size without repair: FA-60, FA-80 and FA-100 of the SPSFA paper.

    For a size above the limits, the environment is made with a larger maximum.

    Args:
        population_size: size of every iteration, PS(0) included.
        limits: population sizes that the environment allows.
        source: source of the members, which a swarm of constant size needs for the first population alone;
            None is the environment's own.
    """

    def __init__(
        self,
        population_size: int,
        limits: SizeLimits = SizeLimits(),  # noqa: B008
        source: Source | None = None,
    ):
        if not limits.smallest <= population_size <= LARGEST:
            raise ValueError(
                f"a fixed population size must lie in [{limits.smallest}, {LARGEST}], got {population_size}"
            )
        self.initial_population_size = population_size
        self.first_source = source
        self._limits = limits

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:
        """Return the controller of `60`, or of a size and its source: `60,smooth_share=1,amplitude=0.3`.

        Raises:
            ValueError: if the text does not begin with a population size.
            SettingError: for a key or value that a source cannot have; the message lists the valid ones.
        """
        size, _, rest = argument.partition(",")
        if not size.isdecimal():
            raise ValueError(
                f"controller {shown(f'fixed:{argument}')}: expected a population size, e.g. fixed:60 or "
                "fixed:60,smooth_share=1"
            )
        given = parse_parameters(rest, FIRST_SOURCE) if rest else {}
        source = Source(**given) if rest else None
        if source is not None and "amplitude" in given and source.smooth_share == 0.0:
            raise SettingError(
                f"controller {shown(f'fixed:{argument}')}: amplitude has no effect with uniform members; "
                "remove it, or give smooth_share above 0, too"
            )
        return cls(int(size), limits, source)

    def env_options(self) -> NeededOptions:
        """Return the options that the environment of this controller needs."""
        options = super().env_options()
        if self.initial_population_size > self._limits.largest:
            options["max_population_size"] = self.initial_population_size
        return options

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the controller has no state."""

    def identity(self) -> object:
        """Return the size, and the source of the first population."""
        source = self.first_source
        return "fixed", int(self.initial_population_size), source.identity() if source else None

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 2) decisions: the constant size, and phi = 0."""
        return np.tile([float(self.initial_population_size), 0.0], (len(observations), 1))


class Random(Controller):
    """Uniformly random population sizes and phi: the lower end of every comparison."""

    draws_numbers = True

    def __init__(self, limits: SizeLimits = SizeLimits()):  # noqa: B008
        self.limits = limits
        self.initial_population_size = limits.clip(80)
        self._generators: list[np.random.Generator] = []

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Seed one generator per swarm."""
        self._generators = [np.random.default_rng(seed + row) for row in range(num_swarms)]

    def identity(self) -> object:
        """Return the population sizes that it draws from."""
        return "random", self.limits.identity()

    def act(self, observations: NDArray) -> Floats:  # noqa: ARG002
        """Draw (B, 2) decisions, one row per swarm."""
        draws = np.array([generator.random(2) for generator in self._generators])
        low = [self.limits.smallest, 0.0]
        high = [self.limits.largest, 1.0]
        return low + draws * np.subtract(high, low)
