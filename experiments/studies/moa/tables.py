"""The tables of the MOA paper, its numbers beside ours and the true optimum."""

from collections.abc import Mapping

import numpy as np
from scipy.stats import ttest_ind

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Run, feasible_lengths
from experiments.runs.suite import Suite
from experiments.studies.moa.published import PUBLISHED, THRESHOLDS, PublishedTask
from experiments.tables.cell import MISSING, Entry, number, share
from experiments.tables.document import document_of_suite
from experiments.tables.table import Row, Table
from swarm_gym.comparing.entrants import entrant
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridScenario, make_scenario


def moa_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return two tables: lengths and feasibility (table 1), success and evaluations until then (table 2)."""
    lengths: list[Row] = []
    successes: list[Row] = []
    for scenario in suite.scenarios:
        runs = {controller: outcomes.runs(controller, scenario) for controller in suite.controllers}
        task = scenario.rpartition(":")[2]
        published = {
            name: PUBLISHED.get((task, entrant(name, suite.optimizer).optimizer), PublishedTask())
            for name in runs
        }
        lengths += _length_rows(scenario, runs, published)
        successes += _success_rows(task, runs, published)
    return [
        Table.of(
            "moa-lengths",
            f"Table 1. Mean length of the best paths of the feasible runs of {suite.num_seeds}, above the "
            "shortest path at any angle; p of Welch's t-test against the shortest mean length; the paper's "
            "numbers are of other tasks of about these lengths, h says whether its t-test found a difference",
            lengths,
        ),
        Table.of(
            "moa-success",
            "Table 2. Share of runs whose path became shorter than the threshold, and mean evaluations until "
            "then, all of them where a run never succeeds",
            successes,
        ),
    ]


def _length_rows(
    scenario: str, runs: Mapping[str, list[Run]], published: Mapping[str, PublishedTask]
) -> list[Row]:
    problem = make_scenario(scenario)
    assert isinstance(problem, GridScenario)
    optimum, _ = shortest_path(problem)
    lengths = {name: feasible_lengths(found) for name, found in runs.items()}
    means = {name: own.mean() if own.size else np.nan for name, own in lengths.items()}
    reached = [name for name in runs if lengths[name].size]
    shortest = min(reached, key=means.__getitem__) if reached else None
    return [
        {
            "task": scenario.rpartition(":")[2],
            "shortest path": number(optimum),
            "method": label(name),
            "feasible": number(lengths[name].size / len(found), ".2f"),
            "mean length": number(means[name]),
            "above shortest": share(means[name] / optimum - 1.0),
            "p": MISSING if shortest in (name, None) else _p_value(lengths[name], lengths[str(shortest)]),
            "paper feasible": number(published[name].feasible, ".2f"),
            "paper length": number(published[name].length),
            "paper h": number(published[name].differs, "d"),
        }
        for name, found in runs.items()
    ]


def _success_rows(
    task: str, runs: Mapping[str, list[Run]], published: Mapping[str, PublishedTask]
) -> list[Row]:
    threshold = THRESHOLDS[task]
    return [
        {
            "task": task,
            "threshold": number(threshold, "g"),
            "method": label(name),
            "success": number(np.mean([run.final_fitness < threshold for run in found]), ".2f"),
            "evaluations to success": number(
                np.mean([evaluations_to(run, threshold) for run in found]), ",.0f"
            ),
            "paper success": number(published[name].success, ".2f"),
            "paper evaluations": number(published[name].evaluations, ",.0f"),
            "evaluations made": number(np.mean([run.evaluations for run in found]), ",.0f"),
            "seconds": number(np.mean([run.seconds for run in found]), ".3f"),
        }
        for name, found in runs.items()
    ]


def evaluations_to(run: Run, threshold: float) -> float:
    """Return the evaluations up to the end of the iteration in which the best path became shorter.

    Return all evaluations of the run if it never did.
    """
    below = np.flatnonzero(run.course("best_fitness") < threshold)
    return float(run.course("evaluations")[below[0]]) if below.size else float(run.evaluations)


def _p_value(own: np.ndarray, shortest: np.ndarray) -> Entry:
    if min(own.size, shortest.size) < 2:
        return MISSING
    return number(ttest_ind(own, shortest, equal_var=False).pvalue, ".2g")


TABLES = {"moa": moa_tables}
DOCUMENTS = {"moa": (document_of_suite("docs/moa-paper.md", "moa-paper"),)}
