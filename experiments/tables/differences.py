"""Tables of paired differences: with the baseline, of chosen pairs, and of objectives at price 1."""

from collections.abc import Sequence

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import difference, holm, mean_difference
from experiments.tables.cell import (
    MISSING,
    SIGNS,
    Cell,
    Entry,
    number,
    number_in,
    share,
    share_in,
    signed_p,
    superiority_cell,
)
from experiments.tables.table import Row, Table

RIVAL = "rival"  # head of a column
RIVAL_STREAM = 1  # of draws, so that training seeds of the other group are drawn independently

WHAT = (
    "mean difference of the gap in per cent of the optimum (negative is better) [95 % interval over "
    "training seeds, scenarios of a set and seeds], change of the mean gap, ratio of the mean evaluations, "
    "A12 over all runs, probability of improvement on the same scenario and seed, Wilcoxon signed-rank "
    f"p-value of the means over training seeds after Holm's correction. {SIGNS}"
)


def difference_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of every group against the baseline; p-values are corrected over the whole table.

    There is no table where the suite is run without its baseline, or with nothing else.
    """
    if suite.baseline not in outcomes.groups:
        return []
    pairs = [(group, suite.baseline) for group in outcomes.groups if group != suite.baseline]
    caption = f"Paired with {label(suite.baseline)} on the same scenarios and seeds: {WHAT}"
    rows = [
        {head: entry for head, entry in row.items() if head != RIVAL} for row in _compare(outcomes, pairs)
    ]
    return Table.if_any("differences", caption, rows)


def paired_comparison_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the pairs that the suite names, as far as they were run."""
    pairs = [pair for pair in suite.pairs if outcomes.groups.keys() >= set(pair)]
    caption = f"Paired with a rival of its own on the same scenarios and seeds: {WHAT}"
    return [Table.of("duels", caption, _compare(outcomes, pairs))] if pairs else []


def _compare(outcomes: Outcomes, pairs: Sequence[tuple[str, str]]) -> list[Row]:
    """Return a row for every pair on every set of scenarios."""
    compared = []
    for scenario_set in outcomes.sets:
        for group, other in pairs:
            sample, rival = outcomes.sample(group, scenario_set), outcomes.sample(other, scenario_set)
            found = difference(sample.gap, rival.gap, sample.draws(), rival.draws(RIVAL_STREAM))
            cost = sample.evaluations.mean() / rival.evaluations.mean()
            compared.append((scenario_set, group, other, found, cost))
    adjusted = holm([found.p_value for *_, found, _ in compared])
    return [
        {
            "scenarios": scenario_set,
            "controller": label(group),
            RIVAL: label(other),
            "difference": share_in(found.difference, found.interval, "+.2f"),
            "change of mean gap": share(found.relative_change, "+.1f"),
            "evaluations ratio": number(cost, ".2f"),
            "A12": superiority_cell(found.superiority, found.difference),
            "improvement": number(found.improvement, ".2f"),
            "p": signed_p(p_value, found.direction),
        }
        for (scenario_set, group, other, found, cost), p_value in zip(compared, adjusted, strict=True)
    ]


PRICE = 1.0  # of 100,000 evaluations, in per cent of the optimum


def mean_objective(sample: Sample) -> float:
    """Return the mean objective of runs at price 1."""
    return float(sample.objective(PRICE).mean())


def minus(mine: Sample, theirs: Sample) -> Cell:
    """Return the difference of two objectives at price 1, with its interval."""
    ours, others = mine.objective(PRICE), theirs.objective(PRICE)
    difference, ends = mean_difference(ours, others, mine.draws(), theirs.draws(RIVAL_STREAM))
    return number_in(difference, ends, "+.2f")


def difference_of(outcomes: Outcomes, mine: str, theirs: str, scenario_set: str) -> Entry:
    """Return the difference of the objectives of two groups, or the sign for one that was not run."""
    if not outcomes.groups.keys() >= {mine, theirs}:
        return MISSING
    return minus(outcomes.sample(mine, scenario_set), outcomes.sample(theirs, scenario_set))
