"""The rule of PSA-CMA-ES: a population size that keeps the distribution's steps from being mere noise.

Source: K. Nishida, Y. Akimoto, "PSA-CMA-ES: CMA-ES with population size adaptation", GECCO 2018, algorithm 1,
with its constants. docs/readings.md says what is left to the optimizer.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from statistics import NormalDist
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import exp
from swarm_gym.controllers.controller import Floats
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.rule import Rule, column
from swarm_gym.features import RESTARTS_SO_FAR
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers.cma_es.cma_es import CmaEs
from swarm_gym.optimizers.cma_es.movement import BETA
from swarm_gym.optimizers.cma_es.rates import write_weights
from swarm_gym.search_features import DIMENSION, MOVEMENT, MOVEMENT_EXPECTED

# Factors of the step size that an extended action allows.
_LEAST_FACTOR, _MOST_FACTOR = CmaEs.decided_parameters()["step_factor"].decided or (1.0, 1.0)
_NO_RESTART = CmaEs.decided_parameters()["restart"].default
# Factors are rounded to so many digits, so that logarithms of the C library leave no trace.
_DIGITS = 9


@dataclass
class MovementSize(Rule):
    """A size of CMA-ES that grows while the steps of the distribution disagree, and falls while they agree.

    Each size has a step size that is best on a sphere. When the size changes, the step size changes by the
    ratio of these. A restart of the optimizer begins with `start` again.

    Attributes:
        start: first and smallest size; the default is CMA-ES's in ten dimensions, 4 + 3 log 10.
        threshold: squared length of the path at which the size stays; alpha in the paper, 1.4.
    """

    observation: str = "distribution"
    action: str = "extended"
    made_for: str | None = CmaEs.name
    start: int = 10
    threshold: float = 1.4
    ranges: ClassVar[Mapping[str, Range]] = {"threshold": Range(0.1, 100.0)}

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget sizes and restarts."""
        self._wanted = np.full(num_swarms, float(self.start))  # not rounded
        self._sizes = np.full(num_swarms, self.start)
        self._restarts = np.zeros(num_swarms)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 4) next sizes, phi, factors of the step size, and no restarts."""
        restarts, movement, expected, dimension = (
            observations[:, column(self.observation, name)]
            for name in (RESTARTS_SO_FAR, MOVEMENT, MOVEMENT_EXPECTED, DIMENSION)
        )
        begins = (observations[:, ITERATION] == 0) | (restarts > self._restarts)
        grown = self._wanted * exp(BETA * (expected - movement / self.threshold))
        within = np.clip(grown, self.start, self.limits.largest)
        self._wanted = np.where(begins, float(self.start), within)
        sizes = np.floor(self._wanted + 0.5).astype(np.int64)
        dimensions = np.maximum(dimension, 1.0).astype(np.int64)
        factors = [
            1.0 if first else best_normalized_step(new, n) / best_normalized_step(old, n)
            for first, new, old, n in zip(
                begins.tolist(), sizes.tolist(), self._sizes.tolist(), dimensions.tolist(), strict=True
            )
        ]
        self._sizes, self._restarts = sizes, restarts.copy()
        decided = np.empty((len(sizes), 4))
        decided[:, 0], decided[:, 1], decided[:, 3] = sizes, self.repair_degree, _NO_RESTART
        decided[:, 2] = np.clip(np.round(factors, _DIGITS), _LEAST_FACTOR, _MOST_FACTOR)
        return decided


@cache
def best_normalized_step(size: int, dimension: int) -> float:
    """Return the normalised step size that is best on a sphere for a population size.

    It is c n mu_w / (n - 1 + c^2 mu_w). Here c is the weighted mean of the expected values of ordered normal
    numbers, by Blom's formula.
    """
    weights = np.empty(size)
    rates = write_weights(weights, dimension)
    ordered = [NormalDist().inv_cdf((i + 0.625) / (size + 0.25)) for i in range(rates.parents)]
    c = -sum(weight * value for weight, value in zip(weights.tolist(), ordered, strict=False))
    return c * dimension * rates.effective / (dimension - 1.0 + c * c * rates.effective)
