"""The table of runs on maps that change: error over time, cost, and feasibility soon after events."""

import numpy as np

from experiments.runs.changes import Changes, best_collisions, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.measures import MEASURES
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import interval, means
from experiments.tables.cell import Entry, number, number_in, share
from experiments.tables.table import Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE

SOON = 10  # iterations after an event within which a path is to be feasible again
# Degree of collision, in map units, of a path that only grazes obstacles. On maps of circles and polygons the
# best paths do, since a little collision costs less than a detour.
GRAZING = 1.0
PRICE = 1.0
COLUMNS = (
    "scenarios", "controller", "seeds", "offline objective", "offline error", "final gap", "evaluations",
    "feasible soon", "grazing soon",
)  # fmt: skip
CAPTION = (
    "Offline error: mean gap in per cent on the map in force, from the first event to the end. Offline "
    f"objective: that plus evaluations / 100,000, over all training and tuning seeds [95 % interval over "
    "these seeds, scenarios of a set and seeds]. Final gap in per cent. Feasible soon: events after which "
    f"the best path was feasible within {SOON} iterations; grazing soon: the same with a degree of collision "
    f"up to {GRAZING:g}"
)


def over_time_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios and group, ordered by objective in each set."""
    objective = MEASURES["offline objective"].of
    rows: list[tuple[Entry, ...]] = []
    for scenario_set in outcomes.sets:
        samples = {group: outcomes.sample(group, scenario_set) for group in outcomes.groups}
        values = {group: objective(sample, PRICE) for group, sample in samples.items()}
        for group in sorted(samples, key=lambda name: float(values[name].mean())):
            sample = samples[group]
            resampled = means(values[group], sample.draws())
            rows.append(
                (
                    scenario_set,
                    label(group),
                    number(sample.num_training_seeds, "d"),
                    number_in(values[group].mean(), interval(resampled), ".3f"),
                    number(100.0 * sample.find_offline_error().mean(), ".3f"),
                    number(100.0 * sample.gap.mean(), ".3f"),
                    number(sample.evaluations.mean(), ",.0f"),
                    *map(share, _soon(outcomes, group, sample.scenarios)),
                )
            )
    return [Table("over-time", CAPTION, COLUMNS, rows)]


def _soon(outcomes: Outcomes, group: str, scenarios: tuple[str, ...]) -> tuple[float, float]:
    """Return the shares of events, over all runs of a group, with a feasible and with a grazing path soon."""
    found: list[list[Floats]] = []
    for controller in outcomes.groups[group]:
        for scenario in scenarios:
            collisions = best_collisions(outcomes.runs(controller, scenario))
            found += [
                [iterations_to_feasible(collisions, event, t) for t in (FEASIBILITY_TOLERANCE, GRAZING)]
                for event in Changes.of(scenario).events
            ]
    if not found:
        return np.nan, np.nan
    feasible, grazing = (np.concatenate(at) <= SOON for at in zip(*found, strict=True))
    return float(feasible.mean()), float(grazing.mean())
