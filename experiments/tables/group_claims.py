"""The table of a suite's comparative sentences: the numbers of each, and where it does not hold."""

import numpy as np

from experiments.runs.claims import GroupClaim
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.run import Floats
from experiments.runs.suite import Suite
from experiments.statistics import Interval, interval, means
from experiments.tables.cell import Cell, Entry, number, verdict
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.gaps import NEAR
from experiments.tables.table import Table

COLUMNS = ("claim", "scenarios", "measure", "controller", "rival or limit", "difference", "holds")
CAPTION = (
    "Sentences that compare, a row for each set of scenarios: mean of the measure; that of the rival, times "
    "the factor that the sentence names, or the limit; their difference [95 % interval over training seeds, "
    "scenarios of a set and seeds]. A sentence holds where the whole interval is below 0. Gaps are in per "
    "cent of the optimum, evaluations in thousands, far is the per cent of the runs that are not within "
    f"{100 * NEAR:.0f} % of the optimum, spread is the mean distance of a gap from the median of its scenario"
)


def group_claim_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the suite's claims about groups that were run; none if there are none."""
    rows = [
        _row(claim, outcomes, scenario_set)
        for claim in suite.claims
        if outcomes.groups.keys() >= {claim.group, *([claim.rival] if claim.rival else [])}
        for scenario_set in outcomes.sets
        if claim.is_about(scenario_set)
    ]
    return [Table("claims", CAPTION, COLUMNS, rows)] if rows else []


def check_claim(claim: GroupClaim, outcomes: Outcomes, scenario_set: str) -> tuple[float, float, Interval]:
    """Return the mean of the group, that of the rival times the factor, and the difference's interval."""
    mine = outcomes.sample(claim.group, scenario_set)
    values = measured(claim, mine)
    resampled = means(values, mine.draws())
    if not claim.rival:
        return float(values.mean()), claim.limit, interval(resampled - claim.limit)
    theirs = outcomes.sample(claim.rival, scenario_set)
    others = claim.factor * measured(claim, theirs)
    resampled = resampled - means(others, theirs.draws(RIVAL_STREAM))
    return float(values.mean()), float(others.mean()), interval(resampled)


def measured(claim: GroupClaim, sample: Sample) -> Floats:
    """Return the claim's measure of every run, (training seeds, scenarios, seeds)."""
    gap, thousands = 100.0 * sample.gap, sample.evaluations / 1000.0
    return {
        "gap": gap,
        "evaluations": thousands,
        "objective": sample.objective(claim.price),
        "spread": abs(gap - np.median(gap, axis=(0, 2), keepdims=True)),
        "far": np.where(sample.gap <= NEAR, 0.0, 100.0),
    }[claim.metric]


def _row(claim: GroupClaim, outcomes: Outcomes, scenario_set: str) -> tuple[Entry, ...]:
    mine, theirs, ends = check_claim(claim, outcomes, scenario_set)
    difference = Cell.of(
        "{value:+.2f} [{low:+.2f}, {high:+.2f}]", value=mine - theirs, low=ends[0], high=ends[1]
    )
    measure = f"objective at price {claim.price:g}" if claim.metric == "objective" else claim.metric
    return (
        claim.sentence,
        scenario_set,
        measure,
        number(mine, ".2f"),
        number(theirs, ".2f"),
        difference,
        verdict(ends[1] < 0.0),
    )
