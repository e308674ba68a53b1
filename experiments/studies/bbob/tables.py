"""The tables of the study of the BBOB functions.

A run is measured by the decimal logarithm of its precision, the best value above the least one. Values below
1e-8 count as 1e-8, as in COCO (N. Hansen et al., "COCO: a platform for comparing continuous optimizers in a
black-box setting", Optimization Methods and Software 36, 2021).
"""

from collections.abc import Iterable, Iterator

import numpy as np

from experiments.runs.groups import set_key
from experiments.runs.measures import LEAST_PRECISION, log_precision
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import Difference, Draws, difference, draw, holm, interval, means
from experiments.studies.bbob.suites import (
    BASELINE,
    BUDGET,
    CONTROLLERS,
    DIMENSION,
    OPTIMIZERS,
    name_of,
)
from experiments.tables.cell import MISSING, Entry, number, number_in, share_in, signed_p
from experiments.tables.table import Row, Table
from swarm_gym.scenarios import BbobScenario, make_scenario

# The groups of the definition of BBOB, see `swarm_gym.scenarios.bbob`.
GROUPS = {
    "separable": range(1, 6),
    "moderate": range(6, 10),
    "ill-conditioned": range(10, 15),
    "multimodal": range(15, 20),
    "weak structure": range(20, 25),
    "all": range(1, 25),
}
TARGETS = np.logspace(2.0, LEAST_PRECISION, 51)  # those of COCO


def group_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the mean logarithm of the precision, with a column for each group of functions."""
    caption = (
        "Mean decimal logarithm of the precision [95 % interval over instances; functions are given], "
        f"{DIMENSION} dimensions, {BUDGET:,} evaluations, by group of BBOB functions: -1 is a distance of "
        "0.1 to the least value. Lower is closer"
    )
    rows = [
        {
            "optimizer": optimizer,
            "size": controller,
            **{group: _mean(outcomes, name, functions) for group, functions in GROUPS.items()},
        }
        for optimizer, controller, name in _entrants(suite, outcomes)
    ]
    return Table.if_any("bbob-groups", caption, rows)


def rule_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table that compares each controller with a constant size of the same optimizer."""
    compared = {
        name: _compare(outcomes, name, name_of(optimizer, BASELINE))
        for optimizer, controller, name in _entrants(suite, outcomes)
        if controller != BASELINE and name_of(optimizer, BASELINE) in outcomes.controllers
    }
    adjusted = dict(zip(compared, holm([found.p_value for found in compared.values()]), strict=True))
    caption = (
        f"Over all functions: share of {len(TARGETS)} targets, precisions 1e2 to 1e{LEAST_PRECISION}, that "
        "runs reach [95 % interval over instances]; mean evaluations; mean logarithm of the precision minus "
        f"its value for {BASELINE} of the same optimizer on the same instance and seed (negative is closer) "
        "[95 % interval]; share of the pairs in which it is closer; p of Wilcoxon's signed-rank test, "
        "two-sided, Holm-corrected over the table, with the sign of its rank sum"
    )
    rows = [
        {
            "optimizer": optimizer,
            "size": controller,
            "targets reached": _solved(outcomes, name),
            "evaluations": number(outcomes.evaluations[outcomes.controllers.index(name)].mean(), ",.0f"),
            **_differences(compared.get(name), adjusted.get(name, np.nan)),
        }
        for optimizer, controller, name in _entrants(suite, outcomes)
    ]
    return Table.if_any("bbob-rules", caption, rows)


def _entrants(suite: Suite, outcomes: Outcomes) -> Iterator[tuple[str, str, str]]:
    """Yield optimizer, controller and name of all entrants that have runs."""
    for optimizer in OPTIMIZERS:
        for controller in CONTROLLERS:
            name = name_of(optimizer, controller)
            if name in suite.controllers and name in outcomes.controllers:
                yield optimizer, controller, name


def _sample(outcomes: Outcomes, name: str, functions: Iterable[int]) -> tuple[Floats, Draws]:
    """Return the gaps of an entrant, (1, scenarios, seeds), on functions, and the draws of its instances."""
    chosen = [k for k, scenario in enumerate(outcomes.scenarios) if _function(scenario) in functions]
    sets = [set_key(outcomes.scenarios[k]) for k in chosen]
    sizes = tuple(sets.count(each) for each in dict.fromkeys(sets))
    gaps = outcomes.gap[outcomes.controllers.index(name), chosen][None]
    return gaps, draw(1, sizes, gaps.shape[2])


def _function(scenario: str) -> int:
    made = make_scenario(scenario)
    assert isinstance(made, BbobScenario)
    return made.number


def _mean(outcomes: Outcomes, name: str, functions: Iterable[int]) -> Entry:
    if not any(_function(scenario) in functions for scenario in outcomes.scenarios):
        return MISSING
    gaps, draws = _sample(outcomes, name, functions)
    values = log_precision(gaps)
    return number_in(float(values.mean()), interval(means(values, draws)), ".2f")


def _solved(outcomes: Outcomes, name: str) -> Entry:
    gaps, draws = _sample(outcomes, name, GROUPS["all"])
    reached = (gaps[..., None] <= TARGETS).mean(axis=-1)
    return share_in(float(reached.mean()), interval(means(reached, draws)))


def _compare(outcomes: Outcomes, name: str, rival: str) -> Difference:
    mine, draws = _sample(outcomes, name, GROUPS["all"])
    theirs, _ = _sample(outcomes, rival, GROUPS["all"])
    return difference(log_precision(mine), log_precision(theirs), draws, draws)


def _differences(compared: Difference | None, p_value: float) -> Row:
    """Return the entries of a comparison with the constant size; none are there for this size itself."""
    minus = f"minus {BASELINE}"
    if compared is None:
        return dict.fromkeys((minus, "closer", "p"), MISSING)
    return {
        minus: number_in(compared.difference, compared.interval, "+.2f"),
        "closer": number(compared.improvement, ".2f"),
        "p": signed_p(p_value, compared.direction),
    }


TABLES = {"bbob-groups": group_tables, "bbob-rules": rule_tables}
