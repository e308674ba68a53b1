"""Rows of scores: the result of one controller on one set of scenarios, exported from a results database."""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from agents.backends.local import LocalBackend
from experiments.runs.database import Results
from experiments.runs.outcomes import Outcomes
from experiments.runs.runner import store_missing
from experiments.scoring.suites import ScoredSet, ScoredSuite
from swarm_gym.comparing.entrants import entrant
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import gap_to_optimum


@dataclass(frozen=True)
class ScoreRow:
    """The score of a controller on a set of scenarios; the fields are the columns of a file of scores.

    Attributes:
        controller: name of the entrant.
        environment: id of the environment and its options.
        scenario_set: name of the set of scenarios.
        first_seed: first seed of the first scenario.
        num_seeds: number of seeds of each scenario.
        gap: mean optimality gap at the end of the runs, as a share of the optimum.
        evaluations: mean number of calls of the cost function.
        feasible: share of runs whose best path is feasible.
        digest: SHA-256 of the policy's file, or of the data of another controller.
        runs_digest: SHA-256 of the numbers of all runs, see `digest_of_runs`.
        fitness_of_runs: best fitness of every run, in map units; scenario by scenario, seed by seed.
        evaluations_of_runs: calls of the cost function of every run, in the same order.
    """

    controller: str
    environment: str
    scenario_set: str
    first_seed: int
    num_seeds: int
    gap: float
    evaluations: float
    feasible: float
    digest: str
    runs_digest: str
    fitness_of_runs: tuple[float, ...]
    evaluations_of_runs: tuple[int, ...]

    @property
    def place(self) -> tuple[str, str]:
        """Environment and set of scenarios, which tell the rows of a policy apart."""
        return self.environment, self.scenario_set


def digest_of_runs(fitness: Sequence[float], evaluations: Sequence[int]) -> str:
    """Return the SHA-256 of the best fitness of all runs as float64, then of their evaluations as int64.

    Both are little-endian. Equal digests prove that every run gave the same bits.
    """
    content = np.array(fitness, dtype="<f8").tobytes() + np.array(evaluations, dtype="<i8").tobytes()
    return hashlib.sha256(content).hexdigest()


def export(digests: Mapping[str, str], scored: ScoredSuite, results: Results) -> list[ScoreRow]:
    """Return the rows of entrants from their stored runs, one for each set of scenarios.

    Args:
        digests: digests of the controllers by names of the entrants.
        scored: the suite.
        results: database that has the runs.

    Raises:
        ResultsError: if a run is missing.
        ScenarioError: if the optimum of a scenario is unknown.
    """
    outcomes = results.outcomes(tuple(digests), scored.experiment.seeds)
    return [
        _row(name, digest, scored, chosen, outcomes)
        for name, digest in digests.items()
        for chosen in scored.sets.values()
    ]


def measure(
    digests: Mapping[str, str], scored: ScoredSuite, ran: Callable[[int], Any] = lambda _: None
) -> list[ScoreRow]:
    """Run entrants in this process, keep their runs in memory alone, and return their rows.

    Args:
        digests: digests of the controllers by names of the entrants.
        scored: the suite.
        ran: function that is called with the number of runs that have ended since the last call.

    Raises:
        ScenarioError: if the optimum of a scenario is unknown.
    """
    with closing(Results.in_memory()) as results:
        for count in store_missing(scored.part(tuple(digests)), results, LocalBackend(1)):
            ran(count)
        return export(digests, scored, results)


def mean(values: Sequence[float]) -> float:
    """Return the mean of numbers; the sum is rounded once, so that no order of summation changes it."""
    return math.fsum(values) / len(values)


def _row(name: str, digest: str, scored: ScoredSuite, chosen: ScoredSet, outcomes: Outcomes) -> ScoreRow:
    found = [outcomes.of(name, scenario) for scenario in chosen.scenarios]
    optima = [scored.optima[scenario] for scenario in chosen.scenarios]
    fitness = np.concatenate([one.fitness for one in found]).tolist()
    evaluations = np.concatenate([one.evaluations for one in found]).astype(int).tolist()
    feasible = np.concatenate([one.collision <= FEASIBILITY_TOLERANCE for one in found]).tolist()
    gaps = [gap_to_optimum(one.fitness, optimum) for one, optimum in zip(found, optima, strict=True)]
    return ScoreRow(
        controller=name,
        environment=scored.environment(entrant(name, scored.experiment.optimizer).optimizer),
        scenario_set=chosen.name,
        first_seed=chosen.first_seed,
        num_seeds=chosen.num_seeds,
        gap=mean(np.concatenate(gaps).tolist()),
        evaluations=mean(evaluations),
        feasible=mean(feasible),
        digest=digest,
        runs_digest=digest_of_runs(fitness, evaluations),
        fitness_of_runs=tuple(fitness),
        evaluations_of_runs=tuple(evaluations),
    )
