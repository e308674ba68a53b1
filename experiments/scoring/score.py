"""A row of scores: the result of one controller on one set of scenarios, and the runs that it comes from."""

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from experiments.runs.episode import controller_of
from experiments.scoring.suites import ScoredSet, ScoredSuite
from swarm_gym.comparing.entrants import entrant
from swarm_gym.comparing.optima import optima_of, refuse_unknown_optima
from swarm_gym.population import Swarms
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import gap_to_optimum
from swarm_gym.rollout import run_swarms, swarms_for


@dataclass(frozen=True)
class Score:
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


def score(
    name: str, digest: str, scored: ScoredSuite, ran: Callable[[int], Any] = lambda _: None
) -> list[Score]:
    """Run an entrant on all sets of scenarios of a suite, in this process, and return its scores.

    The seeds of a scenario run side by side, which gives the same bits as one after the other.

    Args:
        name: name of the entrant.
        digest: digest of its controller.
        scored: the suite.
        ran: function that is called with the number of runs that have ended since the last call.

    Raises:
        ScenarioError: if the optimum of a scenario is unknown.
    """
    return [_score_on(name, digest, scored, chosen, ran) for chosen in scored.sets.values()]


def _score_on(
    name: str, digest: str, scored: ScoredSuite, chosen: ScoredSet, ran: Callable[[int], Any]
) -> Score:
    fitness: list[float] = []
    evaluations: list[int] = []
    feasible: list[bool] = []
    gaps: list[float] = []
    for scenario in chosen.scenarios:
        final = _run(name, scenario, scored)
        fitness += final.best_fitness.tolist()
        evaluations += final.evaluations.tolist()
        feasible += (final.best_collision <= FEASIBILITY_TOLERANCE).tolist()
        gaps += gap_to_optimum(final.best_fitness, _optimum(scenario, scored)).tolist()
        ran(len(final.best_fitness))
    return Score(
        controller=name,
        environment=scored.environment(entrant(name, scored.suite.optimizer).optimizer),
        scenario_set=chosen.name,
        first_seed=chosen.first_seed,
        num_seeds=chosen.num_seeds,
        gap=mean(gaps),
        evaluations=mean(evaluations),
        feasible=mean(feasible),
        digest=digest,
        runs_digest=digest_of_runs(fitness, evaluations),
        fitness_of_runs=tuple(fitness),
        evaluations_of_runs=tuple(evaluations),
    )


def _run(name: str, scenario: str, scored: ScoredSuite) -> Swarms:
    """Return the swarms of an entrant at the end of its runs on a scenario, one for each seed."""
    runs, seeds = entrant(name, scored.suite.optimizer), scored.suite.seeds[scenario]
    controller = controller_of(runs.controller)
    options = {**scored.suite.options, **runs.options, "num_threads": 1}
    swarms = swarms_for(controller, len(seeds), runs.optimizer, scenario=scenario, **options)
    run_swarms(controller, swarms, seeds)
    return swarms.simulation.swarms


def mean(values: Sequence[float]) -> float:
    """Return the mean of numbers; the sum is rounded once, so that no order of summation changes it."""
    return math.fsum(values) / len(values)


def _optimum(scenario: str, scored: ScoredSuite) -> float:
    return _optima(scored.suite.scenarios, tuple(sorted(scored.suite.options.items())))[scenario]


@cache
def _optima(scenarios: tuple[str, ...], options: tuple[tuple[str, Any], ...]) -> dict[str, float]:
    found = optima_of(scenarios, dict(options))
    refuse_unknown_optima(scenarios, found)
    return dict(zip(scenarios, found.tolist(), strict=True))
