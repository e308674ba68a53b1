"""The tables of maps that change, and the marked blocks of the page that shows them and of its appendix."""

from functools import cache, partial
from pathlib import Path

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Run, arrives
from experiments.runs.suite import Suite
from experiments.statistics import interval, mean_of_present, means
from experiments.studies.dynamic.findings import FINDINGS, strongest
from experiments.studies.dynamic.over_time import over_time_tables, seeing_tables
from experiments.studies.dynamic.recovery import recovery_tables
from experiments.studies.dynamic.suites import DYNAMIC, DYNAMIC_FIELDS, DYNAMIC_ROBOTS
from experiments.tables.block_contents import figure, findings, texts
from experiments.tables.cell import MISSING, number, number_in, share_in
from experiments.tables.document import Block, Document
from experiments.tables.table import Row, Table
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import FunctionScenario, Point, make_scenario, worlds_of

CAPTION = (
    "Robots that drive while an obstacle appears: share that arrives without a collision; length that "
    "these have driven, in per cent above the shortest way from the start on the changed map; evaluations "
    "[95 % intervals over training seeds, scenarios of a set and seeds]"
)
EVENTS_TEXT = "the three cases with the obstacles that appear, and the shortest ways before and after"
RECOVERY_TEXT = "best fitness on the map in force"


def robot_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios and group of controllers, most arrivals first."""
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        found: list[tuple[float, Row]] = []
        for group in outcomes.groups:
            sample = outcomes.sample(group, scenario_set)
            detours = sample.each(_detour)
            arrived = np.isfinite(detours).astype(np.float64)
            driven = mean_of_present(detours), interval(means(detours, sample.draws()))
            row: Row = {
                "scenarios": scenario_set,
                "controller": label(group),
                "runs": number(detours.size, ",d"),
                "arrived": share_in(*sample.mean(arrived)),
                "driven": share_in(*driven, "+.2f") if arrived.any() else MISSING,
                "evaluations": number_in(*sample.mean(sample.evaluations), ",.0f"),
            }
            found.append((float(arrived.mean()), row))
        rows += [row for _, row in sorted(found, key=lambda one: -one[0])]
    return [Table.of("robots", CAPTION, rows)]


def _detour(run: Run) -> float:
    """Return the detour of a run as in the reward `detour`; NaN for a robot that has not arrived."""
    target, shortest = _target_and_shortest(run.scenario)
    return length_of(run.trajectory) / shortest - 1.0 if arrives(run, target) else np.nan


@cache
def _target_and_shortest(scenario: str) -> tuple[Point, float]:
    *_, (_, changed) = worlds_of(make_scenario(scenario))
    assert not isinstance(changed, FunctionScenario)
    return changed.target, shortest_path(changed)[0]


TABLES = {
    "recovery": recovery_tables,
    "over-time": over_time_tables,
    "seeing": seeing_tables,
    "robots": robot_tables,
}
RESULTS, COLLECTION = "docs/dynamic-study", "dynamic-study"
BLOCKS: dict[str, Block] = {
    "findings": partial(findings, FINDINGS),
    "strongest": strongest,
    "events": partial(figure, "results/dynamic-study", DYNAMIC.name, "events", EVENTS_TEXT),
    "recovery": partial(figure, "results/dynamic-study", DYNAMIC.name, "recovery", RECOVERY_TEXT),
}
# The appendix shows whole tables by the names of their files.
SHOWN = (
    *(
        f"{suite.name}/{name}"
        for suite in (DYNAMIC, DYNAMIC_FIELDS)
        for name in ("over-time", "seeing", "claims", "recovery", "made-with")
    ),
    *(f"{DYNAMIC_ROBOTS.name}/{name}" for name in ("robots", "made-with")),
)
TABLE_BLOCKS: dict[str, Block] = texts(SHOWN)
DOCUMENTS = {
    "dynamic": (
        Document(Path("docs/dynamic.md"), RESULTS, "dynamic-study", COLLECTION, BLOCKS),
        Document(Path("docs/dynamic-tables.md"), RESULTS, "", COLLECTION, TABLE_BLOCKS),
    )
}
