"""Actions: how a controller states the next population size and repair degree."""

from abc import ABC, abstractmethod
from functools import cached_property
from typing import ClassVar

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.errors import ActionError
from swarm_gym.settings import Settings

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class Action(ABC):
    """A layout of actions over the population sizes that the settings allow."""

    name: ClassVar[str]

    def __init__(self, settings: Settings):
        self.smallest = settings.min_population_size
        self.largest = settings.max_population_size

    @cached_property
    @abstractmethod
    def space(self) -> Box:
        """The space of one swarm's action, shape (2,)."""

    @abstractmethod
    def encode(self, sizes: Floats, repair_degrees: Floats) -> NDArray:
        """Actions (B, 2) that ask for these population sizes and phi, each (B,)."""

    @abstractmethod
    def _decode(self, actions: Floats) -> tuple[Floats, Floats]:
        """Real-valued population sizes and phi, each (B,), of valid actions (B, 2)."""

    def decode(self, actions: object, chosen: NDArray[np.bool_]) -> tuple[Integers, Floats]:
        """Population sizes, rounded to nearest, and phi, each (B,), of actions (B, 2).

        Only the chosen rows, (B,), have to be valid.

        Raises:
            ActionError: for a wrong type or shape, a number that is not finite or out of bounds.
        """
        space = self.space
        try:
            given = np.asarray(actions)
        except ValueError as error:
            raise ActionError(f"an action must be numbers, got {actions!r}") from error
        if given.dtype.kind not in "fiu":
            raise ActionError(f"an action must be numbers, got {given.dtype} ({_shorten(actions)})")
        if given.shape != (len(chosen), *space.shape):
            raise ActionError(
                f"an action must have shape {space.shape}, one per swarm, {len(chosen)} in all; "
                f"got {given.shape}"
            )
        values = given.astype(np.float64)
        valid = (values >= space.low) & (values <= space.high)  # not a number is neither
        if not valid.all():
            wrong = chosen & ~valid.all(axis=1)
            if wrong.any():
                row = int(np.argmax(wrong))
                raise ActionError(
                    f"action {values[row].tolist()} of swarm {row} is not in the {self.name!r} action "
                    f"space [{space.low.tolist()}, {space.high.tolist()}] (population size, repair degree)"
                )
            values = np.where(chosen[:, None], values, space.low)
        sizes, repair_degrees = self._decode(values)
        within = np.minimum(np.maximum(sizes, self.smallest), self.largest)
        return (
            np.floor(within + 0.5).astype(np.int64),
            np.minimum(np.maximum(repair_degrees, 0.0), 1.0),
        )


class Natural(Action):
    """(population size, phi) as they are; float64."""

    name = "natural"

    @cached_property
    def space(self) -> Box:  # noqa: D102
        return Box(np.array([self.smallest, 0.0]), np.array([self.largest, 1.0]), dtype=np.float64)

    def encode(self, sizes: Floats, repair_degrees: Floats) -> NDArray:  # noqa: D102
        return np.stack([sizes, repair_degrees], axis=1)

    def _decode(self, actions: Floats) -> tuple[Floats, Floats]:
        return actions[:, 0], actions[:, 1]


class Normalised(Action):
    """Logarithm of the population size, and phi, both scaled to [-1, 1]; float32, for networks."""

    name = "normalised"

    @cached_property
    def space(self) -> Box:  # noqa: D102
        return Box(-1.0, 1.0, (2,), dtype=np.float32)

    def encode(self, sizes: Floats, repair_degrees: Floats) -> NDArray:  # noqa: D102
        low, high = np.log(self.smallest), np.log(self.largest)
        spread = max(high - low, 1e-9)
        share = (np.log(sizes) - low) / spread
        return np.stack([2.0 * share - 1.0, 2.0 * repair_degrees - 1.0], axis=1).astype(np.float32)

    def _decode(self, actions: Floats) -> tuple[Floats, Floats]:
        share, repair_degrees = ((actions + 1.0) / 2.0).T
        return self.smallest * (self.largest / self.smallest) ** share, repair_degrees


ACTIONS: dict[str, type[Action]] = {cls.name: cls for cls in (Natural, Normalised)}


def make_action(settings: Settings) -> Action:
    """The action layout that the settings name.

    Raises:
        UnknownNameError: if there is none of that name.
    """
    return look_up("action layout", settings.action, ACTIONS)(settings)


def _shorten(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
