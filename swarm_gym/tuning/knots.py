"""The space of open loops: decisions at knots as a point of the unit cube.

Every decision has its range; sizes, amplitudes and the optimizer's parameters are logarithmic in it, phi and
the share of immigrants are square roots, as `swarm_gym.controllers.open_loop` interpolates them. With the
action `sourced`, the size and source of the first population are three more coordinates. A constant is an
open loop of one knot.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_integer
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.controllers.parameters import Number, Range, parse_parameters
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.sources import GUIDED, SOURCE_DECISIONS, SOURCE_RANGES, Source
from swarm_gym.tuning.config import TuneConfig

Floats = NDArray[np.float64]

# Start of the search: rounded results of short searches on the three cases with price 0.5; with sources, of
# 7.3 million steps with price 1 that began at `open-loop:three-cases-extended@0.1`.
START_ITERATIONS = [0, 3, 8, 15, 40, 99]
START: dict[str, dict[str, list[float]]] = {
    "natural": {
        "population size": [165, 75, 46, 43, 30, 10],
        "repair degree": [0.0, 0.1, 0.2, 0.3, 0.4, 0.4],
    },
    "extended": {
        "population size": [68, 32, 16, 6, 13, 15],
        "repair degree": [0.0, 0.4, 0.3, 0.1, 0.5, 0.65],
        "noise": [0.3, 0.5, 12, 13, 20, 0.3],
        "attractiveness": [0.15, 0.15, 0.2, 0.15, 0.6, 0.8],
    },
    "sourced": {
        "population size": [39, 63, 10, 8, 38, 7],
        "repair degree": [0.63, 0.01, 0.13, 0.62, 0.42, 0.18],
        "noise": [0.29, 0.39, 0.67, 0.064, 3.3, 0.18],
        "attractiveness": [0.045, 0.76, 0.13, 0.41, 0.82, 0.52],
        "smooth_share": [0.81, 0.72, 0.71, 0.64, 0.92, 0.86],
        "amplitude": [0.56, 0.67, 0.29, 0.55, 0.59, 0.077],
        "immigrants": [0.14, 0.22, 0.31, 0.12, 0.59, 0.33],
    },
}
# Names of the decisions about the first population.
FIRST_SIZE, FIRST_SHARE, FIRST_AMPLITUDE = "first size", "first smooth share", "first amplitude"
BESIDE_THE_WALLS = 0.02  # CMA-ES samples badly from a mean on a bound


@dataclass(frozen=True)
class Axis:
    """The range of a decision, and its scale: what part of [0, 1] stands for which value.

    Attributes:
        low: smallest value; above 0 if the scale is logarithmic.
        high: largest value.
        default: value at which a search starts if nothing better is known.
        scale: `logarithmic`, `root` (the square root is linear) or `linear`.
    """

    low: float
    high: float
    default: float
    scale: str = "logarithmic"

    def encode(self, values: Floats) -> Floats:
        """Return the places in [0, 1] of values."""
        values = np.clip(values, self.low, self.high)
        if self.scale == "logarithmic":
            return np.log(values / self.low) / np.log(self.high / self.low)
        share = (values - self.low) / (self.high - self.low)
        return np.sqrt(share) if self.scale == "root" else share

    def decode(self, places: Floats) -> Floats:
        """Return the values at places in [0, 1]."""
        if self.scale == "logarithmic":
            return np.clip(self.low * (self.high / self.low) ** places, self.low, self.high)
        share = places**2 if self.scale == "root" else places
        return self.low + (self.high - self.low) * share


@dataclass
class KnotSpace:
    """The decisions at the knots of a configuration as points in [0, 1]^n.

    The first coordinates are for every decision at all knots, decision by decision. The last ones are
    for the first population, if it is decided. Decisions that are held have no coordinates.

    Raises:
        SettingError: for knots or an action that an open loop cannot have, or a decision that cannot be held.
    """

    config: TuneConfig
    _knots: list[int] = field(init=False)
    _axes: dict[str, Axis] = field(init=False)
    _first_axes: dict[str, Axis] = field(init=False)
    _held: dict[str, Number] = field(init=False)

    def __post_init__(self) -> None:
        config = self.config
        smallest, largest = config.limits.smallest, config.limits.largest
        require_integer("initial_population_size", config.initial_population_size, smallest, largest)
        first_source = Source(config.initial_smooth_share, config.initial_amplitude)
        self._knots = _checked_knots(config.knots, config.iterations)
        self._optimizer = get_optimizer(config.optimizer)
        self._axes = _axes_of(config.action, config.limits, self._optimizer)
        self._first_axes = {}
        if config.action != "sourced":
            _refuse_first_source(config)
        else:
            first_size = config.initial_population_size
            if (loop := self._start_loop) is not None and loop.first_source is not None:
                first_size, first_source = loop.initial_population_size, loop.first_source
            self._first_axes = {
                FIRST_SIZE: Axis(float(smallest), float(config.first_limits.largest), first_size),
                FIRST_SHARE: Axis(*SOURCE_RANGES["smooth_share"], first_source.smooth_share, "linear"),
                FIRST_AMPLITUDE: Axis(*SOURCE_RANGES["amplitude"], first_source.amplitude),
            }
        self._held = _read_held(config.held, {**self._axes, **self._first_axes})
        if config.source == GUIDED and self._first_axes:
            share = self._held.setdefault(FIRST_SHARE, 1.0)  # members lie around planned ways
            if share != 1.0:
                raise SettingError(
                    f"held {FIRST_SHARE}={share:g}: first members with source {GUIDED!r} lie around planned "
                    "ways; expected 1, or another source"
                )

    @property
    def start(self) -> Floats:
        """Start of the search, inside the cube; a constant starts at the mean over the iterations."""
        known = self._known()
        rows = []
        for name, axis in self._searched(self._axes).items():
            places = axis.encode(known.get(name, np.full(self.config.iterations, axis.default)))
            rows.append(places[self._knots] if len(self._knots) > 1 else [places.mean()])
        first = self._searched(self._first_axes).values()
        rows.append([float(axis.encode(np.array(axis.default))) for axis in first])
        return np.clip(np.concatenate(rows), BESIDE_THE_WALLS, 1.0 - BESIDE_THE_WALLS)

    @cached_property
    def _start_loop(self) -> OpenLoop | None:
        """The open loop at which the search starts, if one is named."""
        if self.config.start == "none":
            return None
        controller = make_controller(self.config.start, self.config.limits)
        if not isinstance(controller, OpenLoop):
            raise SettingError(
                f"start must be none or an open loop, e.g. open-loop:three-cases, got {self.config.start!r}"
            )
        return controller

    def _known(self) -> dict[str, Floats]:
        """Return where the search starts: decisions at every iteration, by name."""
        if self._start_loop is None:
            iterations = np.arange(self.config.iterations)
            return {
                name: axis.decode(np.interp(iterations, START_ITERATIONS, axis.encode(np.array(values))))
                for name, values in START[self.config.action].items()
                if (axis := self._axes.get(name))
            }
        controller = self._start_loop
        parameters = self._optimizer.decided_parameters()
        known = {"population size", "repair degree", *parameters, *SOURCE_DECISIONS}
        if unknown := [name for name in controller.names if name not in known]:
            raise SettingError(
                f"start {self.config.start!r} decides {', '.join(unknown)}, but the parameters of optimizer "
                f"{self._optimizer.name!r} are {', '.join(parameters)}; choose an open loop for it"
            )
        rows = np.minimum(np.arange(self.config.iterations), len(controller.decisions) - 1)
        return dict(zip(controller.names, controller.decisions[rows].T, strict=True))

    def decode(self, point: Floats) -> Knots:
        """Return the decisions of a point at the knots."""
        point = np.clip(point, 0.0, 1.0)
        axes, first_axes = self._searched(self._axes), self._searched(self._first_axes)
        rows = point[: len(axes) * len(self._knots)].reshape(-1, len(self._knots))
        found = {
            name: axis.decode(row).tolist() for (name, axis), row in zip(axes.items(), rows, strict=True)
        }
        held = {name: [float(value)] * len(self._knots) for name, value in self._held.items()}
        values = {name: found[name] if name in found else held[name] for name in self._axes}
        sources = {name: values.pop(name) for name in SOURCE_DECISIONS if name in values}
        sizes, repair_degrees = values.pop("population size"), values.pop("repair degree")
        places = zip(first_axes.items(), point[rows.size :], strict=True)
        first = {**self._held, **{name: float(axis.decode(place)) for (name, axis), place in places}}
        size = int(np.floor(first.get(FIRST_SIZE, self.config.initial_population_size) + 0.5))
        source = Source(first[FIRST_SHARE], first[FIRST_AMPLITUDE]) if self._first_axes else None
        return Knots(size, self._knots, sizes, repair_degrees, values, sources, source, self.config.optimizer)

    def _searched(self, axes: dict[str, Axis]) -> dict[str, Axis]:
        """Return the axes of the decisions that are not held."""
        return {name: axis for name, axis in axes.items() if name not in self._held}

    def controller(self, point: Floats) -> OpenLoop:
        """Return the open loop of a point."""
        return OpenLoop(self.decode(point), self.config.limits)


def _axes_of(action: str, limits: SizeLimits, optimizer: type[Optimizer]) -> dict[str, Axis]:
    """Return the axes of all decisions of an action by name, in the order of its numbers."""
    if action not in START:
        raise SettingError(f"action: an open loop decides in one of {', '.join(START)}, got {action!r}")
    if limits.smallest == limits.largest:
        raise SettingError(f"there is one population size only, {limits.smallest}: nothing to tune")
    axes = {
        "population size": Axis(float(limits.smallest), float(limits.largest), 60.0),
        "repair degree": Axis(0.0, 1.0, 0.0, "root"),
    }
    if action == "natural":
        return axes
    for name, parameter in optimizer.decided_parameters().items():
        if parameter.decided is not None:
            axes[name] = Axis(*parameter.decided, parameter.default)
    if action == "extended" and len(axes) == 2:
        raise SettingError(f"action 'extended': optimizer {optimizer.name!r} decides nothing more")
    if action == "sourced":
        axes["smooth_share"] = Axis(*SOURCE_RANGES["smooth_share"], 1.0, "linear")
        axes["amplitude"] = Axis(*SOURCE_RANGES["amplitude"], 0.4)
        axes["immigrants"] = Axis(*SOURCE_RANGES["immigrants"], 0.0, "root")
    return axes


def _read_held(held: tuple[str, ...], axes: dict[str, Axis]) -> dict[str, Number]:
    """Return the values of decisions that are held, such as `immigrants=0`, by name."""
    ranges = {name.replace(" ", "_"): Range(axis.low, axis.high) for name, axis in axes.items()}
    values = parse_parameters(",".join(held), ranges)
    return {name: values[known] for name in axes if (known := name.replace(" ", "_")) in values}


def _refuse_first_source(config: TuneConfig) -> None:
    """Raise an error for a source of the first population where the search does not decide it."""
    for name in ("initial_smooth_share", "initial_amplitude"):
        if (given := getattr(config, name)) != getattr(TuneConfig, name):
            raise SettingError(f"{name} needs action 'sourced', got {given!r} with action {config.action!r}")


def _checked_knots(knots: tuple[int, ...], iterations: int) -> list[int]:
    for knot in knots:
        require_integer("knots", knot, 0, iterations - 1)
    if not knots or knots[0] != 0 or (np.diff(knots) <= 0).any():
        raise SettingError(f"knots must begin with 0 and increase, got {knots}")
    return list(knots)
