"""The tables of maps that change, among them that of robots that drive, and the document that shows them."""

from functools import cache

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run, arrives
from experiments.runs.suite import Suite
from experiments.statistics import interval, mean_of_present, means
from experiments.studies.dynamic.over_time import over_time_tables
from experiments.studies.dynamic.recovery import recovery_tables
from experiments.studies.dynamic.seeing import seeing_tables
from experiments.tables.cell import MISSING, Entry, number, number_in, share_in
from experiments.tables.document import document_of_suite
from experiments.tables.table import Table
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import FunctionScenario, Point, make_scenario, worlds_of

COLUMNS = ("scenarios", "controller", "runs", "arrived", "driven", "evaluations")
CAPTION = (
    "Robots that drive while an obstacle appears: share that arrives without a collision; length that "
    "these have driven, in per cent above the shortest way from the start on the changed map; evaluations "
    "[95 % intervals over training seeds, scenarios of a set and seeds]"
)


def robot_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios and group of controllers, most arrivals first."""
    rows: list[tuple[Entry, ...]] = []
    for scenario_set in outcomes.sets:
        found: list[tuple[float, tuple[Entry, ...]]] = []
        for group in outcomes.groups:
            sample = outcomes.sample(group, scenario_set)
            detours = np.array(
                [
                    [_detours(outcomes.runs(controller, scenario), scenario) for scenario in sample.scenarios]
                    for controller in outcomes.groups[group]
                ]
            )
            arrived, draws = np.isfinite(detours).astype(np.float64), sample.draws()
            driven: Entry = MISSING
            if arrived.any():
                driven = share_in(mean_of_present(detours), interval(means(detours, draws)), "+.2f")
            entries = (
                number(detours.size, ",d"),
                share_in(arrived.mean(), interval(means(arrived, draws))),
                driven,
                number_in(sample.evaluations.mean(), interval(means(sample.evaluations, draws)), ",.0f"),
            )
            found.append((float(arrived.mean()), (scenario_set, label(group), *entries)))
        rows += [entries for _, entries in sorted(found, key=lambda one: -one[0])]
    return [Table("robots", CAPTION, COLUMNS, rows)]


def _detours(runs: list[Run], scenario: str) -> Floats:
    """Return the detours of runs as in the reward `detour`, (runs,); NaN for robots that have not arrived."""
    target, shortest = _target_and_shortest(scenario)
    found = np.full(len(runs), np.nan)
    for k, run in enumerate(runs):
        if arrives(run, target):
            found[k] = length_of(run.trajectory) / shortest - 1.0
    return found


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
DOCUMENTS = {"dynamic": document_of_suite("docs/dynamic.md", "dynamic-study")}
