"""Linear reduction of the population size.

Source: R. Tanabe, A. S. Fukunaga, "Improving the search performance of SHADE using linear population size
reduction", IEEE CEC 2014 (L-SHADE). There the size falls with the share of the evaluations that is spent; an
episode here has a number of iterations instead of a number of evaluations, so it falls with the share of the
iterations done. Who leaves the population is the environment's rule, not the worst in fitness.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Floats
from swarm_gym.controllers.size_rule import SHARE_DONE, SizeRule, column


@dataclass
class LinearReduction(SizeRule):
    """From `start` to `smallest`, in proportion to the iterations done."""

    observation: str = "scaled"

    def _next_size(self, observations: Floats, begin: NDArray[np.bool_]) -> Floats:  # noqa: ARG002
        # Seen in single precision: rounded to what it stands for, so that halves are rounded as they should.
        share = np.round(observations[:, column(self.observation, SHARE_DONE)], 6)
        return self.start + (self.smallest - self.start) * share
