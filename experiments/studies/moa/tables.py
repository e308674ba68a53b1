"""The tables of the MOA paper, its numbers beside ours and the true optimum."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import ttest_ind

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.studies.moa.published import PUBLISHED, THRESHOLDS
from experiments.tables.cell import MISSING, Entry, number, share
from experiments.tables.document import document_of_suite
from experiments.tables.table import Table
from swarm_gym.comparing.entrants import entrant
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridScenario, make_scenario


def moa_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return two tables: lengths and feasibility (table 1), success and evaluations until then (table 2)."""
    lengths: list[tuple[Entry, ...]] = []
    successes: list[tuple[Entry, ...]] = []
    for scenario in suite.scenarios:
        task = scenario.rpartition(":")[2]
        runs = {controller: outcomes.runs(controller, scenario) for controller in suite.controllers}
        lengths += _length_rows(suite, scenario, task, runs)
        successes += _success_rows(suite, task, runs)
    return [
        Table(
            "moa-lengths",
            f"Table 1. Mean length of the best paths of the feasible runs of {suite.num_seeds}, above the "
            "shortest path at any angle; p of Welch's t-test against the shortest mean length; the paper's "
            "numbers are of other tasks of about these lengths, h says whether its t-test found a difference",
            (
                "task", "shortest path", "method", "feasible", "mean length", "above shortest", "p",
                "paper feasible", "paper length", "paper h",
            ),
            lengths,
        ),
        Table(
            "moa-success",
            "Table 2. Share of runs whose path became shorter than the threshold, and mean evaluations until "
            "then, all of them where a run never succeeds",
            (
                "task", "threshold", "method", "success", "evaluations to success", "paper success",
                "paper evaluations", "evaluations made", "seconds",
            ),
            successes,
        ),
    ]  # fmt: skip


def _length_rows(
    suite: Suite, scenario: str, task: str, runs: dict[str, list[Run]]
) -> list[tuple[Entry, ...]]:
    problem = make_scenario(scenario)
    assert isinstance(problem, GridScenario)
    optimum, _ = shortest_path(problem)
    lengths = {name: _feasible_lengths(found) for name, found in runs.items()}
    reached = [name for name in runs if lengths[name].size]
    shortest = min(reached, key=lambda name: lengths[name].mean()) if reached else None
    rows: list[tuple[Entry, ...]] = []
    for name, found in runs.items():
        own = lengths[name]
        published = PUBLISHED.get((task, entrant(name, suite.optimizer).optimizer))
        mean = own.mean() if own.size else np.nan
        rows.append(
            (
                task,
                number(optimum),
                label(name),
                number(own.size / len(found), ".2f"),
                number(mean),
                share(mean / optimum - 1.0),
                MISSING if shortest in (name, None) else _p_value(own, lengths[str(shortest)]),
                number(published.feasible if published else None, ".2f"),
                number(published.length if published else None),
                number(published.differs if published else None, "d"),
            )
        )
    return rows


def _success_rows(
    suite: Suite,
    task: str,
    runs: dict[str, list[Run]],
) -> list[tuple[Entry, ...]]:
    threshold = THRESHOLDS[task]
    rows: list[tuple[Entry, ...]] = []
    for name, found in runs.items():
        published = PUBLISHED.get((task, entrant(name, suite.optimizer).optimizer))
        spent = np.array([evaluations_to(run, threshold) for run in found])
        success = np.mean([run.course("best_fitness")[-1] < threshold for run in found])
        rows.append(
            (
                task,
                number(threshold, "g"),
                label(name),
                number(success, ".2f"),
                number(spent.mean(), ",.0f"),
                number(published.success if published else None, ".2f"),
                number(published.evaluations if published else None, ",.0f"),
                number(np.mean([run.evaluations for run in found]), ",.0f"),
                number(np.mean([run.seconds for run in found]), ".3f"),
            )
        )
    return rows


def evaluations_to(run: Run, threshold: float) -> float:
    """Return the evaluations up to the end of the iteration in which the best path became shorter.

    Return all evaluations of the run if it never did.
    """
    below = np.flatnonzero(run.course("best_fitness") < threshold)
    return float(run.course("evaluations")[below[0] if below.size else -1])


def _feasible_lengths(runs: Sequence[Run]) -> np.ndarray:
    # The fitness of a feasible path is its length.
    return np.array([run.final_fitness for run in runs if run.final_collision <= FEASIBILITY_TOLERANCE])


def _p_value(own: np.ndarray, shortest: np.ndarray) -> Entry:
    if min(own.size, shortest.size) < 2:
        return MISSING
    return number(ttest_ind(own, shortest, equal_var=False).pvalue, ".2g")


TABLES = {"moa": moa_tables}
DOCUMENTS = {"moa": document_of_suite("docs/moa-paper.md", "moa-paper")}
