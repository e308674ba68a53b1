"""The table of recovery after an obstacle appears: when, and at what cost, a path is feasible again."""

from dataclasses import dataclass

import numpy as np

from experiments.runs.changes import best_collisions, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.statistics import mean_interval
from experiments.studies.dynamic.over_time import GRAZING, over_time_tables
from experiments.studies.dynamic.seeing import seeing_tables
from experiments.tables.cell import Cell, Entry, number, share_in
from experiments.tables.document import document_of_suite
from experiments.tables.table import Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import make_scenario, worlds_of

NEVER = "never"  # printed for an infinite number


@dataclass(frozen=True)
class Recovery:
    """Recovery of runs from one event; arrays (runs,).

    Attributes:
        was_feasible: whether the best path was feasible when the event came.
        stayed_feasible: whether the best path was feasible right after that.
        iterations: iterations from the event to the next feasible best path; infinite without one.
        evaluations: evaluations from the event to the next feasible best path; infinite without one.
    """

    was_feasible: Floats
    stayed_feasible: Floats
    iterations: Floats
    evaluations: Floats

    @classmethod
    def of(cls, runs: list[Run], event: int, tolerance: float) -> "Recovery":
        """Return the recovery that the traces of runs show, with an event after that iteration.

        A path is feasible if its degree of collision is at most the tolerance, in map units.
        """
        collisions = best_collisions(runs)
        spent = np.array([run.course("evaluations") for run in runs])
        # The row of an iteration in the trace shows the event that follows this iteration.
        before, after = collisions[:, event - 1], collisions[:, event]
        iterations = iterations_to_feasible(collisions, event, tolerance)
        found = np.isfinite(iterations)
        then = event + np.where(found, iterations, 0).astype(int)
        return cls(
            (before <= tolerance).astype(np.float64),
            (after <= tolerance).astype(np.float64),
            iterations,
            np.where(found, spent[np.arange(len(runs)), then] - spent[:, event], np.inf),
        )


def recovery_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table with a row per scenario with one event and group of controllers."""
    rows: list[tuple[Entry, ...]] = []
    for scenario in suite.scenarios:
        _, (event, _) = worlds_of(make_scenario(scenario))
        column = outcomes.scenarios.index(scenario)
        for group, controllers in outcomes.groups.items():
            runs = [run for controller in controllers for run in outcomes.runs(controller, scenario)]
            at = [outcomes.controllers.index(controller) for controller in controllers]
            gaps = outcomes.gap[at, column].ravel()
            cells = [
                cell
                for tolerance in (FEASIBILITY_TOLERANCE, GRAZING)
                for cell in _cells(Recovery.of(runs, event, tolerance))
            ]
            rows.append(
                (
                    scenario,
                    label(group),
                    number(len(runs), "d"),
                    *cells,
                    share_in(gaps.mean(), mean_interval(gaps), ".2f"),
                    number(np.mean([run.evaluations for run in runs]), ",.0f"),
                )
            )
    columns = (
        "scenario", "controller", "runs",
        "feasible before, after, at last", "iterations", "evaluations",
        "grazing before, after, at last", "iterations", "evaluations",
        "final gap", "evaluations in all",
    )  # fmt: skip
    return [
        Table(
            "recovery",
            "An obstacle closes the corridor that the population has settled in: runs whose best path was "
            "feasible before that, right after it, and at some time until the end; iterations and "
            "evaluations from there to a feasible path, median [quartiles] of all runs; the same of paths "
            f"with a degree of collision up to {GRAZING:g}, which graze obstacles; mean final gap to the "
            "optimum of the changed map [95 % interval]",
            columns,
            rows,
        )
    ]


def _cells(found: Recovery) -> tuple[Cell, ...]:
    feasible = Cell.of(
        "{before:%.0f} %, {after:%.0f} %, {last:%.0f} %",
        before=found.was_feasible.mean(),
        after=found.stayed_feasible.mean(),
        last=np.isfinite(found.iterations).mean(),
    )
    return feasible, _quartiles(found.iterations), _quartiles(found.evaluations)


def _quartiles(values: Floats) -> Cell:
    """Return median and quartiles of numbers that may be infinite, each of them one of the numbers."""
    quartiles = np.quantile(values, [0.25, 0.5, 0.75], method="inverted_cdf")
    low, middle, high = (
        f"{{{name}:,.0f}}" if np.isfinite(value) else NEVER
        for name, value in zip(("low", "value", "high"), quartiles, strict=True)
    )
    return Cell.of(f"{middle} [{low}, {high}]", value=quartiles[1], low=quartiles[0], high=quartiles[2])


TABLES = {"recovery": recovery_tables, "over-time": over_time_tables, "seeing": seeing_tables}
DOCUMENTS = {"dynamic": document_of_suite("docs/dynamic.md", "dynamic")}
