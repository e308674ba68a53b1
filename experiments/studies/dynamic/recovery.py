"""The table of recovery after events: when, and at what cost, there is a feasible path again."""

from dataclasses import dataclass, fields

import numpy as np

from experiments.runs.changes import Changes, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.tables.cell import Cell, number, share
from experiments.tables.table import Row, Table

NEVER = "never"  # printed for an infinite number

CAPTION = (
    "Recovery from events: shares of the events before which, right after which and after which at some "
    "time there was a feasible path; iterations and evaluations from the event to a feasible path, median "
    "[quartiles] over events and runs"
)


@dataclass(frozen=True)
class Recovery:
    """Recovery from events, arrays (events,) with one entry for each event of each run.

    Attributes:
        was_feasible: whether there was a feasible path before the event.
        stayed_feasible: whether there was one right after it.
        iterations: iterations from the event to the next feasible path; infinite without one.
        evaluations: evaluations from the event to the next feasible path; infinite without one.
    """

    was_feasible: Floats
    stayed_feasible: Floats
    iterations: Floats
    evaluations: Floats

    @classmethod
    def of(cls, runs: list[Run], event: int) -> "Recovery":
        """Return the recovery of runs from one event, which follows that iteration."""
        feasible = np.isfinite([run.course("feasible_fitness") for run in runs])
        spent = np.array([run.course("evaluations") for run in runs])
        iterations = iterations_to_feasible(runs, event)
        found = np.isfinite(iterations)
        # The row of an iteration in the trace shows the event that follows this iteration.
        then = event + np.where(found, iterations, 0).astype(int)
        return cls(
            feasible[:, event - 1].astype(np.float64),
            feasible[:, event].astype(np.float64),
            iterations,
            np.where(found, spent[np.arange(len(runs)), then] - spent[:, event], np.inf),
        )

    @classmethod
    def of_group(cls, outcomes: Outcomes, group: str, scenarios: tuple[str, ...]) -> "Recovery":
        """Return the recovery of all runs of a group from all events of scenarios."""
        each = [
            cls.of(outcomes.runs(controller, scenario), event)
            for controller in outcomes.groups[group]
            for scenario in scenarios
            for event in Changes.of(scenario).events
        ]
        names = [field.name for field in fields(cls)]
        return cls(*(np.concatenate([getattr(one, name) for one in each]) for name in names))


def recovery_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios with events and group of controllers, if any."""
    rows: list[Row] = []
    for scenario_set, group, sample in outcomes.samples():
        if not any(Changes.of(scenario).events.size for scenario in sample.scenarios):
            continue
        found = Recovery.of_group(outcomes, group, sample.scenarios)
        rows.append(
            {
                "scenarios": scenario_set,
                "controller": label(group),
                "events": number(len(found.iterations), ",d"),
                "feasible before": share(found.was_feasible.mean()),
                "right after": share(found.stayed_feasible.mean()),
                "at last": share(np.isfinite(found.iterations).mean()),
                "iterations": _quartiles(found.iterations),
                "evaluations": _quartiles(found.evaluations),
            }
        )
    return Table.if_any("recovery", CAPTION, rows)


def _quartiles(values: Floats) -> Cell:
    """Return median and quartiles of numbers that may be infinite, each of them one of the numbers."""
    quartiles = np.quantile(values, [0.25, 0.5, 0.75], method="inverted_cdf")
    low, middle, high = (
        f"{{{name}:,.0f}}" if np.isfinite(value) else NEVER
        for name, value in zip(("low", "value", "high"), quartiles, strict=True)
    )
    return Cell.of(f"{middle} [{low}, {high}]", value=quartiles[1], low=quartiles[0], high=quartiles[2])
