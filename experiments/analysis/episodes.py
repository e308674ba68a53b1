"""What analyses of controllers share: seeds that no model was selected by, and how episodes ended."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.evaluation.observers import Watched
from agents.runs.seeds import ANALYSIS
from experiments.runs.database import ResultsError

Floats = NDArray[np.float64]


class Outcome(NamedTuple):
    """How episodes ended, (scenarios, seeds) each."""

    gap: Floats
    evaluations: Floats
    returns: Floats


def outcome(found: list[Watched]) -> Outcome:
    """How the episodes of every scenario ended.

    Raises:
        ResultsError: where an optimum is not known.
    """
    gap = np.array([w.gap for w in found])
    if np.isnan(gap).any():
        raise ResultsError("gaps need the optima of all scenarios; see swarm_gym.reference.ensure_optima")
    return Outcome(gap, np.array([w.evaluations for w in found]), np.array([w.returns for w in found]))


def analysis_seeds(number: int) -> range:
    """The first of the seeds for analyses, this many.

    Raises:
        ResultsError: for fewer than two, which have no spread.
    """
    if number < 2:
        raise ResultsError(f"--seeds must be at least 2, got {number}")
    return ANALYSIS[:number]
