"""Actions: how a controller states the next population size and repair degree, and further decisions.

A layout is a list of decisions, each one number of the action: population size, repair degree and, in the
extended layouts, those parameters of the optimizer that may change at every iteration.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.errors import ActionError, SettingError, shown
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import replaced
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation

Floats = NDArray[np.float64]

# How far a paced action can depart from the size at which the budget would last: by this factor.
PACE_SPREAD = 6.0


class Scale(ABC):
    """How one decision is written as a number of an action."""

    low: float
    high: float

    @abstractmethod
    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:
        """Numbers (B,) that ask for these values (B,), up to the bounds of the action."""

    @abstractmethod
    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:
        """Values (B,) that these numbers (B,) ask for."""


@dataclass(frozen=True)
class AsItIs(Scale):
    """A number in its own unit."""

    low: float
    high: float

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        return values

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        return numbers


@dataclass(frozen=True)
class Linear(Scale):
    """[smallest, largest] scaled to [-1, 1]."""

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
    """The logarithm of [smallest, largest], both positive, scaled to [-1, 1]."""

    smallest: float
    largest: float
    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: ARG002, D102
        spread = max(np.log(self.largest) - np.log(self.smallest), 1e-9)
        positive = np.maximum(values, self.smallest)  # a parameter may be 0 where no action decides it
        return 2.0 * (np.log(positive) - np.log(self.smallest)) / spread - 1.0

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: ARG002, D102
        return self.smallest * (self.largest / self.smallest) ** ((numbers + 1.0) / 2.0)


@dataclass(frozen=True)
class Paced(Scale):
    """The population size relative to the one at which the evaluation budget would just last.

    A number a in [-1, 1] asks for PACE_SPREAD^a times that size. The budget is never exceeded, and what is
    not spent now is there for later iterations.
    """

    low: float = -1.0
    high: float = 1.0

    def encode(self, values: Floats, simulation: Simulation | None) -> Floats:  # noqa: D102
        if simulation is None:
            raise SettingError("paced actions depend on the evaluations that are left")
        return np.log(values / self._lasting(simulation)) / np.log(PACE_SPREAD)

    def decode(self, numbers: Floats, simulation: Simulation) -> Floats:  # noqa: D102
        return self._lasting(simulation) * PACE_SPREAD**numbers

    def _lasting(self, simulation: Simulation) -> Floats:
        return simulation.optimizer.affordable_size(simulation.pace())


class Action:
    """A layout of actions.

    Attributes:
        name: of the layout.
        labels: what each number decides.
        scales: how each number is read.
        space: of one swarm's action, shape (number of decisions,).
    """

    def __init__(
        self,
        name: str,
        settings: Settings,
        scales: dict[str, Scale],
        defaults: dict[str, float],
        dtype: type[np.floating],
    ):
        self.name = name
        self.labels = tuple(scales)
        self.scales = tuple(scales.values())
        self._parameters, self._defaults = list(defaults), list(defaults.values())
        self._dtype = dtype
        self._smallest, self._largest = settings.min_population_size, settings.max_population_size

    @cached_property
    def space(self) -> Box:  # noqa: D102
        low = np.array([scale.low for scale in self.scales], dtype=self._dtype)
        high = np.array([scale.high for scale in self.scales], dtype=self._dtype)
        return Box(low, high, dtype=self._dtype)

    def encode(self, decided: Floats, simulation: Simulation | None = None) -> NDArray:
        """Actions (B, k) that come nearest to asking for what is decided; paced ones need the simulation.

        Args:
            decided: (B, k) in the layout `extended`, or (B, 2) in `natural`: then the optimizer's parameters
                stay as they are.
            simulation: of the B swarms.

        Raises:
            ActionError: if more is decided than the layout has numbers for.
        """
        missing = len(self.scales) - decided.shape[1]
        if missing < 0:
            raise ActionError(
                f"{decided.shape[1]} decisions cannot be said in the layout {self.name!r} "
                f"({', '.join(self.labels)})"
            )
        wanted = np.concatenate([decided, np.tile(self._defaults, (len(decided), 1))[:, :missing]], axis=1)
        numbers = [
            scale.encode(values, simulation) for scale, values in zip(self.scales, wanted.T, strict=True)
        ]
        space = self.space
        return np.clip(np.stack(numbers, axis=1), space.low, space.high).astype(self._dtype)

    def decode(self, actions: object, chosen: NDArray[np.bool_], simulation: Simulation) -> Decisions:
        """What actions (B, k) ask for; sizes are rounded to nearest.

        Only the chosen rows, (B,), have to be valid.

        Raises:
            ActionError: for a wrong type or shape, a number that is not finite or out of bounds.
        """
        values = self._read(actions, chosen)
        decided = [
            scale.decode(column, simulation) for scale, column in zip(self.scales, values.T, strict=True)
        ]
        within = np.minimum(np.maximum(decided[0], self._smallest), self._largest)
        parameters = simulation.parameters
        if self._parameters:
            new = dict(zip(self._parameters, decided[2:], strict=True))
            parameters = replaced(simulation.optimizer.parameter_class, parameters, new)
        return Decisions(
            np.floor(within + 0.5).astype(np.int64), np.minimum(np.maximum(decided[1], 0.0), 1.0), parameters
        )

    def _read(self, actions: object, chosen: NDArray[np.bool_]) -> Floats:
        space = self.space
        try:
            given = np.asarray(actions)
        except Exception as error:  # of an object that makes an array of itself, anything may come
            raise ActionError(f"an action must be numbers, got {shown(actions)}") from error
        if given.dtype.kind not in "fiu":
            raise ActionError(f"an action must be numbers, got {given.dtype} ({shown(actions)})")
        if given.shape != (len(chosen), *space.shape):
            raise ActionError(
                f"an action must have shape {space.shape} ({', '.join(self.labels)}), one per swarm, "
                f"{len(chosen)} in all; got {given.shape}"
            )
        with np.errstate(over="ignore"):  # infinite then, and refused
            values = given.astype(np.float64)
        valid = (values >= space.low) & (values <= space.high)  # not a number is neither
        if not valid.all():
            wrong = chosen & ~valid.all(axis=1)
            if wrong.any():
                row = int(np.argmax(wrong))
                raise ActionError(
                    f"action {values[row].tolist()} of swarm {row} is not in the {self.name!r} action "
                    f"space [{space.low.tolist()}, {space.high.tolist()}] ({', '.join(self.labels)})"
                )
            values = np.where(chosen[:, None], values, space.low)
        return values


@dataclass(frozen=True)
class Layout:
    """What a layout of actions is made of; `make_action` fills in the settings.

    Attributes:
        size: `natural` (members), `logarithmic` or `paced` (both in [-1, 1]).
        extended: whether the optimizer's own parameters are decided too.
    """

    size: str
    extended: bool


# natural: units as they are, float64. normalised and paced: [-1, 1], float32, for networks.
ACTIONS: dict[str, Layout] = {
    "natural": Layout("natural", False),
    "normalised": Layout("logarithmic", False),
    "paced": Layout("paced", False),
    "extended": Layout("natural", True),
    "extended-normalised": Layout("logarithmic", True),
    "extended-paced": Layout("paced", True),
}


def make_action(settings: Settings, optimizer: type[Optimizer]) -> Action:
    """The action layout that the settings name, for an optimizer.

    Raises:
        UnknownNameError: if there is none of that name.
        SettingError: if the layout asks for what the settings or the optimizer lack.
    """
    layout = look_up("action layout", settings.action, ACTIONS)
    if layout.size == "paced" and settings.max_evaluations is None:
        raise SettingError(f"action {settings.action!r} needs an evaluation budget: set max_evaluations")
    natural = layout.size == "natural"
    smallest, largest = settings.min_population_size, settings.max_population_size
    sizes: dict[str, Scale] = {
        "natural": AsItIs(smallest, largest),
        "logarithmic": Logarithmic(smallest, largest),
        "paced": Paced(),
    }
    scales = {
        "population size": sizes[layout.size],
        "repair degree": AsItIs(0.0, 1.0) if natural else Linear(0.0, 1.0),
    }
    decided = optimizer.decided_parameters() if layout.extended else {}
    if layout.extended and not decided:
        raise SettingError(f"action {settings.action!r}: optimizer {optimizer.name!r} decides nothing more")
    for name, parameter in decided.items():
        if parameter.decided is not None:
            scales[name] = AsItIs(*parameter.decided) if natural else Logarithmic(*parameter.decided)
    dtype = np.float64 if natural else np.float32
    values = optimizer.parameter_values(settings.knobs)
    return Action(settings.action, settings, scales, {name: getattr(values, name) for name in decided}, dtype)
