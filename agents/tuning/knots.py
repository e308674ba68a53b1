"""The space of open loops: decisions at knots as a point of the unit cube.

Every decision has its range; sizes and the optimizer's parameters are logarithmic in it, phi is a square
root, as `swarm_gym.controllers.open_loop` interpolates them. A constant is an open loop of one knot.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.tuning.config import TuneConfig
from swarm_gym.checks import require_integer
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.settings import Settings

Floats = NDArray[np.float64]

# Start of the search: rounded results of short searches on the three cases with price 0.5.
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
}
BESIDE_THE_WALLS = 0.02  # CMA-ES samples badly from a mean on a bound


class Decided(NamedTuple):
    """Decisions of an open loop at its knots.

    Attributes:
        sizes: population sizes.
        repair_degrees: phi.
        knobs: parameters of the optimizer by name.
    """

    sizes: list[float]
    repair_degrees: list[float]
    knobs: dict[str, list[float]]


class KnotSpace:
    """The decisions at the knots of a configuration as points in [0, 1]^(decisions x knots).

    Raises:
        SettingError: for knots or an action that an open loop cannot have.
    """

    def __init__(self, config: TuneConfig):
        smallest, largest = config.limits.smallest, config.limits.largest
        require_integer("initial_population_size", config.initial_population_size, smallest, largest)
        self._initial_population_size = config.initial_population_size
        self._knots = _checked_knots(config.knots)
        self._limits = config.limits
        self._ranges = _logarithmic_ranges(config.action, config.limits, get_optimizer(config.optimizer))

    @property
    def start(self) -> Floats:
        """Start of the search, inside the cube; a constant starts at the mean over the iterations."""
        optimizer_defaults = {name: default for name, (_, _, default) in self._ranges.items()}
        known = START["extended" if len(self._ranges) > 1 else "natural"]
        rows = []
        for name in ("population size", "repair degree", *list(self._ranges)[1:]):
            values = known.get(name, [optimizer_defaults.get(name, 0.0)] * len(START_ITERATIONS))
            scaled = np.interp(np.arange(100), START_ITERATIONS, self._scale(name, np.array(values)))
            rows.append(scaled[self._knots] if len(self._knots) > 1 else [scaled.mean()])
        return np.clip(np.concatenate(rows), BESIDE_THE_WALLS, 1.0 - BESIDE_THE_WALLS)

    def decode(self, point: Floats) -> Decided:
        """Return the decisions of a point."""
        size, repair_degree, *others = np.clip(point, 0.0, 1.0).reshape(-1, len(self._knots))
        positive = {}
        for (name, (low, high, _)), row in zip(self._ranges.items(), [size, *others], strict=True):
            positive[name] = np.clip(low * (high / low) ** row, low, high).tolist()
        return Decided(positive.pop("population size"), (repair_degree**2).tolist(), positive)

    def controller(self, point: Floats) -> OpenLoop:
        """Return the open loop of a point."""
        return OpenLoop(self._initial_population_size, self._knots, *self.decode(point), self._limits)

    def _scale(self, name: str, values: Floats) -> Floats:
        if name == "repair degree":
            return np.sqrt(values)
        low, high, _ = self._ranges[name]
        return np.log(np.clip(values, low, high) / low) / np.log(high / low)


def _logarithmic_ranges(
    action: str, limits: SizeLimits, optimizer: type[Optimizer]
) -> dict[str, tuple[float, float, float]]:
    """Return low, high and default of every decision but phi, by name."""
    if action not in START:
        raise SettingError(f"action: an open loop decides in one of {', '.join(START)}, got {action!r}")
    if limits.smallest == limits.largest:
        raise SettingError(f"there is one population size only, {limits.smallest}: nothing to tune")
    ranges = {"population size": (float(limits.smallest), float(limits.largest), 60.0)}
    if action == "extended":
        for name, parameter in optimizer.decided_parameters().items():
            if parameter.decided is not None:
                ranges[name] = (*parameter.decided, parameter.default)
        if len(ranges) == 1:
            raise SettingError(f"action 'extended': optimizer {optimizer.name!r} decides nothing more")
    return ranges


def _checked_knots(knots: tuple[int, ...]) -> list[int]:
    for knot in knots:
        require_integer("knots", knot, 0, Settings.iterations - 1)
    if not knots or knots[0] != 0 or (np.diff(knots) <= 0).any():
        raise SettingError(f"knots must begin with 0 and increase, got {knots}")
    return list(knots)
