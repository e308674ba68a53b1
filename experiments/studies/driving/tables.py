"""The table of swarms that minimise length and nearness, relative to the path of the planner with wishes."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.statistics import mean_difference
from experiments.studies.driving.suites import BASE, DRIVING, L_SHADE
from experiments.tables import Table
from experiments.tables.cell import MISSING, Entry, number, number_in, share
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.document import Document, ResultsFolder
from experiments.tables.headline import blinded
from experiments.tables.table import Row
from swarm_gym import plan
from swarm_gym.problem.geometry.polylines import length_of

Floats = NDArray[np.float64]

WISH = "distance"
PLANNED = "plan with wishes, no swarm"


def driving_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table with a row for each group of controllers, the least objective first."""
    weight = float(suite.options["distance_weight"])
    names = outcomes.scenarios
    planned = {name: planned_costs(name, weight) for name in names}
    sums = np.array([planned[name][1] for name in names])[:, None]
    lengths = np.array([planned[name][0] for name in names])[:, None]
    whole = list(outcomes.sets)[-1]
    samples = {group: outcomes.sample(group, whole) for group in outcomes.groups}
    objectives = {group: 100.0 * np.log(sample.fitness / sums) for group, sample in samples.items()}
    found: list[tuple[float, Row]] = [(0.0, _row_of_planner())]
    for group, sample in samples.items():
        objective = objectives[group]
        row: Row = {
            "controller": label(group),
            "seeds": number(sample.num_training_seeds, "d"),
            "free": share(sample.feasible.mean()),
            **_parts(sample, sums, lengths, weight),
            "objective": number_in(*sample.mean(objective), ".1f"),
            "minus the rival": _minus(group, suite.baseline, RIVAL_STREAM, samples, objectives),
            "minus itself blinded": _minus(group, blinded(group), 0, samples, objectives),
        }
        found.append((float(objective.mean()), row))
    caption = (
        f"Length plus {weight:g} times nearness after {suite.options['max_evaluations']:,} evaluations on "
        f"{len(names)} generated maps, {outcomes.fitness.shape[2]} runs each: share of free best paths; mean "
        "length, nearness and sum of these, in per cent above those of `swarm_gym.plan` with the same wish; "
        "objective: 100 times the mean logarithm of the fitness over the planner's sum, minus that of "
        f"{label(suite.baseline)}, and minus that of the same policies with every input but the clock "
        "replaced by its mean course [95 % intervals over training seeds, maps and runs]. Below 0 is a "
        "smaller sum"
    )
    return [Table.of("driving", caption, [row for _, row in sorted(found, key=lambda one: one[0])])]


@cache
def planned_costs(scenario: str, weight: float) -> tuple[float, float]:
    """Return the length and the sum of the planner's path through a map, for a robot without size."""
    costs = plan(scenario, wishes={WISH: weight}).costs
    return costs["length"], costs["sum"]


def _minus(
    group: str, other: str, stream: int, samples: Mapping[str, Sample], objectives: Mapping[str, Floats]
) -> Entry:
    """Return the objective of a group minus that of another one; none if this is absent or the group."""
    if other == group or other not in samples:
        return MISSING
    draws, theirs = samples[group].draws(), samples[other].draws(stream)
    return number_in(*mean_difference(objectives[group], objectives[other], draws, theirs), "+.1f")


def _row_of_planner() -> Row:
    zero = number(0.0, ".1f")
    return {
        "controller": PLANNED,
        "seeds": MISSING,
        "free": share(1.0),
        "length": zero,
        "nearness": zero,
        "sum": zero,
        "objective": zero,
        "minus the rival": MISSING,
        "minus itself blinded": MISSING,
    }


def _parts(sample: Sample, sums: Floats, lengths: Floats, weight: float) -> dict[str, Entry]:
    """Return the entries of length, nearness and sum, above the planner's in per cent."""
    free = sample.feasible > 0.0
    mine = np.where(free, sample.each(_length), np.nan)
    # What a free path costs besides its length is nearness times the weight.
    parts = {
        "length": (mine, lengths),
        "nearness": ((sample.fitness - mine) / weight, (sums - lengths) / weight),
        "sum": (np.where(free, sample.fitness, np.nan), sums),
    }
    return {name: _above(values, planned, free) for name, (values, planned) in parts.items()}


def _above(values: Floats, planned: Floats, free: NDArray[np.bool_]) -> Entry:
    if not free.any():
        return MISSING
    return number(
        100.0 * (np.nansum(values) / np.broadcast_to(planned, values.shape)[free].sum() - 1.0), ".1f"
    )


def _length(run: Run) -> float:
    return length_of(run.best_path)


def _shown(results: ResultsFolder) -> str:
    """Return the table without the constants that policies correct, which are beside tuned ones."""
    table = results.table("driving")
    rows = [row for row in table.rows if str(row[0]) != label(f"{L_SHADE}+{BASE}")]
    return replace(table, rows=rows).markdown()


TABLES = {"driving": driving_tables}
DOCUMENTS = {
    "driving": (
        Document(
            Path("docs/planning-wishes.md"), f"docs/{DRIVING.name}", "", DRIVING.name, {"driving": _shown}
        ),
    )
}
