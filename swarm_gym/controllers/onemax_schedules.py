"""Schedules of the (1 + (lambda, lambda)) genetic algorithm over the share of zeros, f / n.

| name | decides | tuned for |
|---|---|---|
| `share:lambda` | lambda | the least expected runtimes at n = 100, 200 and 500 |
| `share:four` | lambda_m, lambda_c, alpha and beta | the same |

The logarithm of each decision is linear between knots, which are evenly spaced in log2(n / zeros). Above the
last knot, both lambda grow by the square root of n / zeros, as in theory, and alpha and beta stay.
`python -m experiments.onemax --tune-schedules` tunes them again by CMA-ES; no run is simulated.
"""

import json
import math
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.compiler.elementary import exp, interpolate, log
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.onemax_rules import LARGEST, OneMaxRule

Floats = NDArray[np.float64]

FILE = "onemax_schedules.json"
FIRST, SPACING, NUM_KNOTS = 1.0, 0.75, 12  # in log2(n / zeros): from half of the ones to 1 zero of 600
LAST = FIRST + SPACING * (NUM_KNOTS - 1)
GROWTH = np.array([0.5, 0.5, 0.0, 0.0])  # slopes above the last knot, of lambda_m, lambda_c, alpha and beta


@dataclass
class ShareSchedule(OneMaxRule):
    """A schedule of lambda, or of all four parameters, over log2(n / zeros).

    Attributes:
        knots: (1, NUM_KNOTS) or (4, NUM_KNOTS) binary logarithms of the decisions at the knots.
    """

    knots: Floats = field(default_factory=lambda: np.zeros((1, NUM_KNOTS)))

    def __post_init__(self) -> None:
        self.knots = np.asarray(self.knots, dtype=np.float64)
        if self.knots.shape not in ((1, NUM_KNOTS), (4, NUM_KNOTS)) or not np.isfinite(self.knots).all():
            raise ValueError(
                f"knots: expected finite numbers of shape (1, {NUM_KNOTS}) for lambda, or (4, {NUM_KNOTS}) "
                f"for all four parameters, got shape {self.knots.shape}"
            )
        self.action = "natural" if len(self.knots) == 1 else "extended"

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:  # noqa: ARG003
        """Return the schedule that ships under this name, e.g. `lambda`.

        Raises:
            UnknownNameError: if no schedule of that name ships.
        """
        return cls(np.array(look_up("schedule", argument, _packaged())))

    def identity(self) -> object:
        """Return the values at the knots."""
        return "ShareSchedule", self.knots.tolist()

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        place = log(lengths / (lengths - ones)) / math.log(2.0)
        at = FIRST + SPACING * np.arange(NUM_KNOTS)
        beyond = np.maximum(place - LAST, 0.0)
        found = [
            exp(math.log(2.0) * (interpolate(place, at, row) + slope * beyond))
            for row, slope in zip(self.knots, GROWTH, strict=False)
        ]
        whole = [np.clip(np.floor(one + 0.5), 1.0, LARGEST) for one in found[:2]]
        return (*whole, *found[2:])


@cache
def _packaged() -> dict[str, list[list[float]]]:
    text = resources.files("swarm_gym.controllers").joinpath("data", FILE).read_text(encoding="utf-8")
    return dict(json.loads(text))
