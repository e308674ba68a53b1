"""Actions: what the numbers of a controller ask for, in one of the layouts of `swarm_gym.action_layouts`."""

from functools import cached_property
from typing import Any, NoReturn

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.action_layouts import (
    ACTIONS,
    Layout,
    includes,
    layout_of,
    scale_of_parameter,
    scale_of_repair,
    scale_of_size,
    scale_of_source,
)
from swarm_gym.arrays import (
    Constant,
    as_numpy,
    at_least,
    at_most,
    floats,
    integers,
    with_columns,
)
from swarm_gym.compiler.rows import plain_decisions, rows_within
from swarm_gym.errors import ActionError, SettingError, shown
from swarm_gym.optimizers import get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.scales import AsItIs, Scale
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation
from swarm_gym.sources import SOURCE_DECISIONS, SOURCE_RANGES

__all__ = ["ACTIONS", "Action", "Layout", "includes", "layout_of", "make_action", "require_same_decisions"]

Floats = NDArray[np.float64]

# Smallest and largest values of decisions on new members, each (3,).
_LEAST_OF_SOURCES, _MOST_OF_SOURCES = map(
    Constant, np.transpose([SOURCE_RANGES[name] for name in SOURCE_DECISIONS])
)


class Action:
    """A layout of actions, for one environment.

    Attributes:
        name: name of the layout, as in the option `action`.
        optimizer: optimizer whose parameters an extended layout decides.
        labels: decision that each number stands for.
        scales: scale of each number.
        space: space of one swarm's action, shape (number of decisions,).
    """

    def __init__(
        self,
        name: str,
        settings: Settings,
        scales: dict[str, Scale],
        parameters: dict[str, float],
        sources: tuple[float, ...],
        dtype: type[np.floating],
        optimizer: type[Optimizer],
    ):
        self.name, self.optimizer = name, optimizer
        self.labels = tuple(scales)
        self.scales = tuple(scales.values())
        self._parameters, self._defaults = list(parameters), [*parameters.values(), *sources]
        fields = optimizer.parameter_class._fields  # type: ignore[attr-defined]
        self._columns = [fields.index(name) for name in parameters]
        self._dtype = dtype
        self._smallest, self._largest = settings.min_population_size, settings.max_population_size
        # Whether actions are a size and a repair degree as they are.
        self._is_plain = len(self.scales) == 2 and all(isinstance(scale, AsItIs) for scale in self.scales)

    @cached_property
    def _low(self) -> Constant:
        return Constant(self.space.low)

    @cached_property
    def _high(self) -> Constant:
        return Constant(self.space.high)

    @cached_property
    def space(self) -> Box:  # noqa: D102
        low = np.array([scale.low for scale in self.scales], dtype=self._dtype)
        high = np.array([scale.high for scale in self.scales], dtype=self._dtype)
        return Box(low, high, dtype=self._dtype)

    def encode(self, decided: Floats, simulation: Simulation | None = None) -> NDArray:
        """Return the actions (B, k) that come closest to asking for these decisions.

        Args:
            decided: (B, k) values in the layout `sourced`, `extended` or `natural`; decisions that these lack
                keep their defaults.
            simulation: simulation of the B swarms, which paced layouts need.

        Raises:
            ActionError: if there are more decisions than the layout has numbers.
            SettingError: if a paced layout is encoded without a simulation.
        """
        missing = len(self.scales) - decided.shape[1]
        if missing < 0:
            raise ActionError(
                f"got {decided.shape[1]} decisions, but the action layout {self.name!r} has only "
                f"{len(self.scales)} numbers ({', '.join(self.labels)})"
            )
        wanted = self.completed(decided)
        numbers = [
            scale.encode(values, simulation) for scale, values in zip(self.scales, wanted.T, strict=True)
        ]
        space = self.space
        return np.clip(np.stack(numbers, axis=1), space.low, space.high).astype(self._dtype)

    def completed(self, decided: Floats) -> Floats:
        """Return decisions (B, k) in natural units, given the first ones; the others keep their defaults."""
        missing = len(self.scales) - decided.shape[1]
        kept = self._defaults[len(self._defaults) - missing :]
        return np.concatenate([decided, np.tile(kept, (len(decided), 1))], axis=1)

    def decode(self, actions: object, chosen: NDArray[np.bool_], simulation: Simulation) -> Decisions:
        """Return the decisions that actions (B, k) ask for; sizes are rounded to the nearest integer.

        Only the chosen rows, (B,), have to be valid.

        Raises:
            ActionError: for a wrong type or shape, or a number that is not finite or out of bounds.
        """
        numbers, valid = self.read(actions, simulation)
        wrong = chosen & ~valid
        if wrong.any():
            self.refuse(numbers, wrong)
        return self.decide(numbers, chosen, simulation)

    def read(self, actions: object, simulation: Simulation) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the numbers of actions, (B, k) float64, and which rows are in the action space, (B,).

        Args:
            actions: (B, k) numbers: what NumPy makes an array of, or an array of the simulation's library.
            simulation: simulation of the B swarms.

        Raises:
            ActionError: for a wrong type or shape.
        """
        xp, device, shape = simulation.xp, simulation.device, self.space.shape
        given = self._as_array(actions, simulation)
        if given.shape != (simulation.num_swarms, *shape):
            raise ActionError(
                f"an action must have shape {shape} ({', '.join(self.labels)}), one per swarm, "
                f"{simulation.num_swarms} in all; got {tuple(given.shape)}"
            )
        numbers = floats(xp, given)
        low, high = self._low.on(xp, device), self._high.on(xp, device)
        if xp is np:
            return numbers, rows_within(numbers, low, high)
        within = (numbers >= low) & (numbers <= high)  # False for NaN
        return numbers, xp.all(within, axis=1)

    def refuse(self, numbers: Floats, wrong: NDArray[np.bool_]) -> NoReturn:
        """Raise an error about the first row that is wrong.

        Args:
            numbers: (B, k) numbers of actions.
            wrong: (B,) rows that are not in the space, at least one.

        Raises:
            ActionError: naming the swarm, the decision, its bounds and the number.
        """
        row = int(np.argmax(as_numpy(wrong)))
        action, space = as_numpy(numbers[row]), self.space
        number = int(np.argmin((action >= space.low) & (action <= space.high)))
        low, high = float(space.low[number]), float(space.high[number])
        raise ActionError(
            f"action {action.tolist()} of swarm {row} is not in the {self.name!r} action space "
            f"({', '.join(self.labels)}): {self.labels[number]} must lie in [{low:g}, {high:g}], got "
            f"{float(action[number])}"
        )

    def decide(self, numbers: Floats, chosen: NDArray[np.bool_], simulation: Simulation) -> Decisions:
        """Return the decisions that numbers of actions, (B, k), ask for, see `decode`.

        Rows that are not chosen may hold anything.
        """
        xp = simulation.xp
        if xp is np and self._is_plain:
            sizes, degrees = plain_decisions(numbers, chosen, self._smallest, self._largest)
            return Decisions(sizes, degrees, simulation.parameters, simulation.sources)
        if not (xp is np and chosen.all()):
            numbers = xp.where(chosen[:, None], numbers, self._low.on(xp, simulation.device))
        return self.carry_out(self.values(numbers, simulation), simulation)

    def values(self, numbers: Floats, simulation: Simulation) -> list[Floats]:
        """Return what numbers of actions, (B, k), ask for: k arrays (B,) in natural units, not rounded."""
        return [
            scale.decode(column, simulation) for scale, column in zip(self.scales, numbers.T, strict=True)
        ]

    def carry_out(self, decided: list[Floats], simulation: Simulation) -> Decisions:
        """Return decisions within their bounds, given k arrays (B,) of values in natural units."""
        xp, device = simulation.xp, simulation.device
        within = at_most(xp, at_least(xp, decided[0], self._smallest), self._largest)
        parameters, sources = simulation.parameters, simulation.sources
        first_source = 2 + len(self._parameters)
        if self._parameters:
            new = dict(zip(self._columns, decided[2:first_source], strict=True))
            parameters = with_columns(xp, parameters, new)
        if len(decided) > first_source:
            least, most = _LEAST_OF_SOURCES.on(xp, device), _MOST_OF_SOURCES.on(xp, device)
            # Scales round: a number of -1 or 1 may stand for slightly more than its bound.
            sources = xp.clip(xp.stack(decided[first_source:], axis=1), least, most)
        return Decisions(
            integers(xp, xp.floor(within + 0.5)),
            at_most(xp, at_least(xp, decided[1], 0.0), 1.0),
            parameters,
            sources,
        )

    def _as_array(self, actions: object, simulation: Simulation) -> NDArray:
        """Return actions as an array of numbers, of the simulation's library and on its device.

        Raises:
            ActionError: if they are no numbers.
        """
        xp = simulation.xp
        given: Any = actions
        if xp is np or not isinstance(actions, type(simulation.iteration)):
            try:
                given = np.asarray(actions)
            except Exception as error:  # an object that converts itself to an array can raise anything
                raise ActionError(f"an action must be numbers, got {shown(actions)}") from error
            if given.dtype.kind not in "fiu":
                raise ActionError(f"an action must be numbers, got {given.dtype} ({shown(actions)})")
            if given.dtype == np.longdouble:
                with np.errstate(over="ignore"):  # becomes infinite, which is no action
                    given = given.astype(np.float64)
            return simulation.place(given)
        if not xp.isdtype(given.dtype, ("real floating", "integral")):
            name = str(given.dtype).removeprefix("torch.")
            raise ActionError(f"an action must be numbers, got {name} ({shown(actions)})")
        return xp.asarray(given, device=simulation.device)


def make_action(settings: Settings, optimizer: type[Optimizer]) -> Action:
    """Return the layout of actions that the settings name, for an optimizer.

    Raises:
        UnknownNameError: if there is no layout of that name.
        SettingError: if the layout needs an evaluation budget that is not set, parameters that the
            optimizer does not have, or sources that the encoding does not have; or if the controller was
            made for an optimizer with other decisions.
    """
    layout = layout_of(settings.action)
    require_same_decisions(settings.made_for, settings.action, optimizer)
    if layout.size == "paced" and settings.max_evaluations is None:
        raise SettingError(f"action {settings.action!r} needs an evaluation budget: set max_evaluations")
    scales = {
        "population size": scale_of_size(layout, settings),
        "repair degree": scale_of_repair(layout, optimizer),
    }
    decided = optimizer.decided_parameters() if layout.extended else {}
    if layout.extended and not layout.sourced and not decided:
        raise SettingError(
            f"action {settings.action!r}: optimizer {optimizer.name!r} has no parameters to decide; choose a "
            "layout that is not extended"
        )
    for name, parameter in decided.items():
        if parameter.decided is not None:
            scales[name] = scale_of_parameter(layout, name, parameter)
    sources: tuple[float, ...] = ()
    if layout.sourced:
        settings.require_sources(f"action {settings.action!r}")
        sources = settings.new_members.decisions
        for name in SOURCE_DECISIONS:
            scales[name.replace("_", " ")] = scale_of_source(layout, name)
    dtype = np.float64 if layout.size == "natural" else np.float32
    values = optimizer.parameter_values(settings.knobs)
    parameters = {name: getattr(values, name) for name in decided}
    return Action(settings.action, settings, scales, parameters, sources, dtype, optimizer)


def require_same_decisions(made_for: str | None, action: str, optimizer: type[Optimizer]) -> None:
    """Raise an error if the optimizer that a controller was made for has other decisions than this one.

    Args:
        made_for: name of the optimizer that the controller was made for; None is any.
        action: name of the action layout in which it decides.
        optimizer: optimizer that it shall control.

    Raises:
        UnknownNameError: if there is no optimizer of that name.
        SettingError: if an extended layout has other parameters, or other ranges of them; both are named.
    """
    if made_for is None:
        return
    theirs = get_optimizer(made_for)
    if not layout_of(action).extended or _ranges(theirs) == _ranges(optimizer):
        return
    raise SettingError(
        f"action {action!r}: the controller was made for {made_for}, whose decisions are "
        f"{_listed(theirs)}; those of {optimizer.name} are {_listed(optimizer)}"
    )


def _ranges(optimizer: type[Optimizer]) -> dict[str, tuple[float, float] | None]:
    """Return the ranges of the parameters that an extended action decides, by name and in order."""
    return {name: parameter.decided for name, parameter in optimizer.decided_parameters().items()}


def _listed(optimizer: type[Optimizer]) -> str:
    return ", ".join(f"{name} in {span}" for name, span in _ranges(optimizer).items()) or "size and phi only"
