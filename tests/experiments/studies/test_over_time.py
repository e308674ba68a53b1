"""The table of runs on maps that change."""

import dataclasses

import numpy as np
import pytest

from experiments.runs.suite import ControllerFamily
from experiments.studies.dynamic.over_time import over_time_tables, seeing_tables
from experiments.studies.dynamic.suites import DYNAMIC, TOLD
from helpers.stored_runs import cells_of, outcomes_of, stored_run
from swarm_gym.reference import known_optimum
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for

GATE, STILL = "dynamic:case3-gate@4", "case1"
POOR, GOOD = "fixed:60", "learned:a/0"


def run_with(scenario, before, after, feasible):
    """Return a run of 6 iterations with these gaps before and after an event, feasible (1) or not by row."""
    optima = [known_optimum(problem) for problem in problems_for(Settings(scenario=scenario))]
    best = [optima[0] * (1.0 + before)] * 4 + [optima[-1] * (1.0 + after)] * 3
    courses = {"best_fitness": np.array(best), "feasible_fitness": np.where(feasible, 310.0, np.nan)}
    return stored_run((POOR, scenario, 0), courses, final_fitness=best[-1])


RUNS = {
    (POOR, GATE): [
        run_with(GATE, 0.0, 0.2, [1, 1, 1, 1, 0, 0, 0]),
        run_with(GATE, 0.0, 0.4, [1, 1, 1, 1, 0, 0, 1]),
    ],
    (GOOD, GATE): [run_with(GATE, 0.3, 0.1, [0] * 6 + [1]), run_with(GATE, 0.3, 0.1, [1] * 7)],
    (POOR, STILL): [run_with(STILL, 0.2, 0.2, [1] * 7)] * 2,
    (GOOD, STILL): [run_with(STILL, 0.1, 0.1, [1] * 7)] * 2,
}


@pytest.fixture
def rows():
    gaps = {key: [0.2, 0.4] for key in RUNS}
    outcomes = outcomes_of(gaps, lambda controller, scenario: RUNS[controller, scenario])
    suite = dataclasses.replace(DYNAMIC, controllers=(POOR, GOOD))
    return cells_of(over_time_tables(suite, outcomes), "over-time")


def test_errors_count_from_the_event_and_rows_are_ordered_by_objective(rows):
    good, poor = rows[:2]
    assert (good["scenarios"], good["controller"]) == ("dynamic:case3-gate", "learned a")
    assert (good["offline error"], poor["offline error"]) == ("10.000", "30.000")
    # Evaluations are 1000 and 2000, in the order of the controllers.
    assert good["offline objective"].startswith("10.020 [")
    assert poor["offline objective"].startswith("30.010 [")
    assert poor["final gap"] == "30.000"


def test_feasibility_is_counted_by_event(rows):
    good, poor = rows[:2]
    assert good["feasible soon"] == "100.0 %"
    assert poor["feasible soon"] == "50.0 %"


def test_scenarios_without_events_have_no_feasibility_after_one(rows):
    still = [row for row in rows if row["scenarios"] == STILL]
    assert {row["feasible soon"] for row in still} == {"–"}
    assert [row["scenarios"] for row in rows[-2:]] == ["all", "all"]


BLIND, SEEING, BOUND = "fixed:80", "learned:b/0", "learned:c/0"
SHOWN = tuple(
    ControllerFamily(*one)
    for one in (("blind", (POOR, BLIND), True), ("learned", (SEEING,)), (TOLD, (BOUND,)))
)


def test_a_share_is_of_the_gain_over_the_best_blind_one():
    """Made-up errors: 30 and 20 per cent for the blind ones, 12 for the one that sees, 10 for the bound."""
    error = {POOR: 0.3, BLIND: 0.2, SEEING: 0.12, BOUND: 0.1}

    def load(controller, scenario):
        return [run_with(scenario, 0.0, error[controller] + 0.01 * k, [0] * 7) for k in (-1, 0, 1)]

    outcomes = outcomes_of({(name, GATE): [0.2] * 3 for name in error}, load)
    suite = dataclasses.replace(DYNAMIC, controllers=tuple(error), families=SHOWN)
    rows = cells_of(seeing_tables(suite, outcomes), "seeing")
    assert [(row["controller"], row["share of the gain"].partition(" [")[0]) for row in rows] == [
        ("FA-80", "0 %"), ("learned b", "80 %"), ("learned c", "100 %"),
    ]  # fmt: skip
    low, high = rows[1]["share of the gain"].partition("[")[2].rstrip("]").split(", ")
    assert float(low) <= 80 <= float(high)
    assert seeing_tables(dataclasses.replace(suite, families=SHOWN[:2]), outcomes) == []
