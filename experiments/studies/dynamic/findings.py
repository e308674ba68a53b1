"""Findings on the page of maps that change, and the table of its strongest controllers."""

from dataclasses import replace

from experiments.runs.groups import EVERY_SET
from experiments.studies.dynamic.suites import (
    CHOSEN_PERIODIC,
    CHOSEN_REACTION,
    DYNAMIC,
    DYNAMIC_FIELDS,
    DYNAMIC_ROBOTS,
    LONG_LOOP,
    LONG_REACTING,
)
from experiments.tables.block_contents import Finding, rows_of
from experiments.tables.document import ResultsFolder
from experiments.tables.reshape import join, select
from experiments.tables.table import Table

ON_CASES, ON_FIELDS = (DYNAMIC.name, EVERY_SET, "Cases"), (DYNAMIC_FIELDS.name, EVERY_SET, "Fields")
ON_MOVING = (DYNAMIC_FIELDS.name, "dynamic-fields:moving", "Moving obstacles")
ON_BLOCKS = (DYNAMIC.name, "dynamic:case2-block", "case2-block")
BOTH = (ON_CASES, ON_FIELDS)

SMALLER = "Policies by PPO have a smaller objective over time than"
# What holds first; what does not hold follows.
FINDINGS = (
    Finding(f"{SMALLER} the blind loop tuned for long.", (*BOTH, ON_MOVING)),
    Finding(
        f"{SMALLER} the best on validation of the rules with immigrants at fixed intervals.",
        (*BOTH, ON_MOVING),
    ),
    Finding(
        f"{SMALLER} the best on validation of the rules with immigrants after a jump of E(P).",
        (*BOTH, ON_MOVING),
    ),
    Finding(f"{SMALLER} policies trained on maps that stay.", BOTH),
    Finding(f"{SMALLER} the same policies blinded.", BOTH),
    Finding(
        "The reacting loop tuned for long has a smaller objective over time than the blind loop tuned for "
        "long.",
        (*BOTH, ON_MOVING),
    ),
    Finding(f"{SMALLER} the reacting loop that they correct.", (*BOTH, ON_MOVING, ON_BLOCKS)),
    Finding(
        "Policies that are told the times of events have a smaller objective over time than those that see.",
        BOTH,
    ),
    Finding(
        "Policies by PPO have at most 70 % of the objective over time of the blind loop tuned for long.", BOTH
    ),
    Finding(
        "Policies by PPO have at most 70 % of the objective over time of the best on validation of the rules "
        "with immigrants at fixed intervals.",
        BOTH,
    ),
)
# Keys of the groups that the page's table shows.
STRONGEST = (
    "learned:dynamic-told/*", "learned:dynamic/*", LONG_REACTING, CHOSEN_PERIODIC, LONG_LOOP, CHOSEN_REACTION,
    "learned:three-cases-sourced-ppo/*", "blinded:dynamic/*", "restart", "spsfa-tip",
)  # fmt: skip
CAPTION = (
    "The strongest controllers of each kind. Objective on the cases and on the fields: mean gap in per cent "
    "on the map in force since the first event, plus evaluations / 100,000 [95 % interval over training "
    "seeds, scenarios of a set and seeds]. Soon: events after which there was a feasible path within 10 "
    "iterations. Robots: share that arrives without a collision"
)


def strongest(results: ResultsFolder) -> str:
    """Return objective and cost of the strongest controllers over all cases and over all fields."""
    cases = _over_time(results, DYNAMIC.name, "cases")
    fields = _over_time(results, DYNAMIC_FIELDS.name, "fields")
    robots = rows_of(results.table(f"{DYNAMIC_ROBOTS.name}/robots"), STRONGEST, EVERY_SET)
    robots = replace(select(robots, ("controller", "arrived")), columns=("controller", "robots"))
    for column in fields.columns[1:]:
        cases = join(cases, fields, ("controller",), column)
    return replace(join(cases, robots, ("controller",), "robots"), caption=CAPTION).markdown()


def _over_time(results: ResultsFolder, suite: str, name: str) -> Table:
    """Return the columns of a suite that the table shows, headed by a name for its scenarios."""
    table = rows_of(results.table(f"{suite}/over-time"), STRONGEST, EVERY_SET)
    table = select(table, ("controller", "offline objective", "evaluations", "feasible soon"))
    return replace(table, columns=("controller", name, f"{name}: evaluations", f"{name}: soon"))
