"""Seeds and outcomes of the episodes that analyses of controllers run."""

from typing import NamedTuple

import numpy as np

from agents.evaluation.observers import Watched
from experiments.runs.database import ResultsError
from experiments.runs.run import Floats
from swarm_gym.runs.seeds import ANALYSIS


class EpisodeOutcome(NamedTuple):
    """Results of episodes, (scenarios, seeds) each.

    Attributes:
        gap: final optimality gap, (fitness - optimum) / optimum.
        evaluations: calls of the cost function.
        returns: sum of the rewards.
    """

    gap: Floats
    evaluations: Floats
    returns: Floats


def outcome(found: list[Watched]) -> EpisodeOutcome:
    """Return the results of the episodes of every scenario.

    Raises:
        ResultsError: if the optimum of a scenario is unknown.
    """
    gap = np.array([w.gap for w in found])
    if np.isnan(gap).any():
        raise ResultsError(
            "gaps need the optima of all scenarios, and one is unknown; swarm_gym.reference.ensure_optima "
            "computes it"
        )
    return EpisodeOutcome(gap, np.array([w.evaluations for w in found]), np.array([w.returns for w in found]))


def analysis_seeds(number: int) -> range:
    """Return the first `number` seeds of those reserved for analyses, by which no model was selected.

    Raises:
        ResultsError: if there are fewer than two, which have no spread.
    """
    if number < 2:
        raise ResultsError(f"--seeds must be at least 2, got {number}")
    return ANALYSIS[:number]
