"""The table of recovery after events: when, and at what cost, there is a feasible path again."""

from dataclasses import dataclass

import numpy as np

from experiments.runs.changes import Changes, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.tables.cell import Cell, Entry, number, share
from experiments.tables.table import Table

NEVER = "never"  # printed for an infinite number
COLUMNS = (
    "scenarios", "controller", "events", "feasible before", "right after", "at last", "iterations",
    "evaluations",
)  # fmt: skip
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
        names = ("was_feasible", "stayed_feasible", "iterations", "evaluations")
        return cls(*(np.concatenate([getattr(one, name) for one in each]) for name in names))


def recovery_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios with events and group of controllers."""
    rows: list[tuple[Entry, ...]] = []
    for scenario_set, strata in outcomes.sets.items():
        scenarios = tuple(scenario for stratum in strata for scenario in stratum)
        if not any(Changes.of(scenario).events.size for scenario in scenarios):
            continue
        for group in outcomes.groups:
            found = Recovery.of_group(outcomes, group, scenarios)
            rows.append(
                (
                    scenario_set,
                    label(group),
                    number(len(found.iterations), ",d"),
                    share(found.was_feasible.mean()),
                    share(found.stayed_feasible.mean()),
                    share(np.isfinite(found.iterations).mean()),
                    _quartiles(found.iterations),
                    _quartiles(found.evaluations),
                )
            )
    return [Table("recovery", CAPTION, COLUMNS, rows)]


def _quartiles(values: Floats) -> Cell:
    """Return median and quartiles of numbers that may be infinite, each of them one of the numbers."""
    quartiles = np.quantile(values, [0.25, 0.5, 0.75], method="inverted_cdf")
    low, middle, high = (
        f"{{{name}:,.0f}}" if np.isfinite(value) else NEVER
        for name, value in zip(("low", "value", "high"), quartiles, strict=True)
    )
    return Cell.of(f"{middle} [{low}, {high}]", value=quartiles[1], low=quartiles[0], high=quartiles[2])
