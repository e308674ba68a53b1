"""A rule of CMA-ES that ends runs which fall behind the best so far, and sees what its first run met.

A restarted run on a function with many optima often ends in one that is worse than the best so far. The
optimizer restarts a run when it has stalled, that is at the full precision of such an optimum. The rule
restarts it once the best fitness has not improved for some generations and the step size is small. A run that
improves the best goes on, so the precision of a final gap does not suffer.

A first run that ends soon has met a smooth basin, as on the peaks of Gallagher: many small runs follow. A
first run that ends late has crossed a rugged landscape, as that of Rastrigin, which small runs cannot: later
runs keep its size. This is a rule of this project.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import log
from swarm_gym.controllers.controller import Floats
from swarm_gym.controllers.parameters import Range
from swarm_gym.controllers.rule import Rule, column
from swarm_gym.features import LOG_TEN, RESTARTS_SO_FAR, SHARE_SPENT
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers.cma_es.cma_es import CmaEs
from swarm_gym.search_features import LOG_STEP, LONGEST_WAIT, STEP_DECADES, WAIT, scaled_wait

_NO_RESTART = CmaEs.decided_parameters()["restart"].default
_RESTART = 1.0


@dataclass
class EarlyRestarts(Rule):
    """Sizes of CMA-ES for the first run and for later ones, and restarts of runs that fall behind.

    Attributes:
        start: size of the first run.
        later: size of later runs, where the first one was short.
        short: largest share of the evaluation budget that a short first run spends. Without a budget, each
            first run is short.
        wait: generations without an improvement of the best fitness after which a run may end.
        step: largest step size at which such a run ends, relative to that of its beginning.
    """

    observation: str = "search+restarts"
    action: str = "extended"
    made_for: str | None = CmaEs.name
    start: int = 42
    later: int = 10
    short: float = 0.35
    wait: int = LONGEST_WAIT
    step: float = 0.03
    sizes: ClassVar[tuple[str, ...]] = ("start", "later")
    ranges: ClassVar[Mapping[str, Range]] = {
        "short": Range(0.0, 1.0),
        "wait": Range(1, LONGEST_WAIT, integer=True),
        "step": Range(1e-12, 1.0),
    }

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget sizes and restarts."""
        self._size = np.full(num_swarms, float(self.start))
        self._restarted = np.zeros(num_swarms, dtype=np.bool_)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, 4) next sizes, phi, factors of the step size, which are 1, and restarts."""
        wait, step, spent, restarts = (
            observations[:, column(self.observation, name)].astype(np.float64)
            for name in (WAIT, LOG_STEP, SHARE_SPENT, RESTARTS_SO_FAR)
        )
        begins = observations[:, ITERATION] == 0
        small = step <= float(log(self.step)) / (STEP_DECADES * LOG_TEN)
        behind = (wait >= scaled_wait(self.wait - 0.5)) & small & ~begins
        restarted = ~begins & ((restarts > 0.0) | behind)
        ends_first = restarted & ~(self._restarted & ~begins)
        size = np.where(begins, float(self.start), self._size)
        self._size = np.where(ends_first & (spent <= self.short), float(self.later), size)
        self._restarted = restarted
        decided = np.ones((len(observations), 4))
        decided[:, 0], decided[:, 1] = self._size, self.repair_degree
        decided[:, 3] = np.where(behind, _RESTART, _NO_RESTART)
        return decided
