"""The table of runs on maps that change: error over time, cost, and feasible paths soon after events."""

import numpy as np

from experiments.runs.changes import Changes, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.measures import MEASURES
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.tables.cell import number, number_in, share
from experiments.tables.table import Row, Table

SOON = 10  # iterations after an event within which a path is to be feasible again
PRICE = 1.0

CAPTION = (
    "Offline error: mean gap in per cent on the map in force, from the first event to the end. Offline "
    f"objective: that plus evaluations / 100,000, over all training and tuning seeds [95 % interval over "
    "these seeds, scenarios of a set and seeds]. Final gap in per cent. Feasible soon: events after which "
    f"there was a feasible path within {SOON} iterations, whatever the best path by fitness"
)


def over_time_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios and group, ordered by objective in each set."""
    objective = MEASURES["offline objective"].of
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        samples = {group: outcomes.sample(group, scenario_set) for group in outcomes.groups}
        values = {group: objective(sample, PRICE) for group, sample in samples.items()}
        rows += [
            {
                "scenarios": scenario_set,
                "controller": label(group),
                "seeds": number(samples[group].num_training_seeds, "d"),
                "offline objective": number_in(*samples[group].mean(values[group]), ".3f"),
                "offline error": number(100.0 * samples[group].find_offline_error().mean(), ".3f"),
                "final gap": number(100.0 * samples[group].gap.mean(), ".3f"),
                "evaluations": number(samples[group].evaluations.mean(), ",.0f"),
                "feasible soon": share(_soon(outcomes, group, samples[group].scenarios)),
            }
            for group in sorted(samples, key=lambda name: float(values[name].mean()))
        ]
    return [Table.of("over-time", CAPTION, rows)]


def _soon(outcomes: Outcomes, group: str, scenarios: tuple[str, ...]) -> float:
    """Return the share of events, over all runs of a group, with a feasible path soon; NaN without events."""
    found = [
        iterations_to_feasible(outcomes.runs(controller, scenario), event) <= SOON
        for controller in outcomes.groups[group]
        for scenario in scenarios
        for event in Changes.of(scenario).events
    ]
    return float(np.concatenate(found).mean()) if found else np.nan
