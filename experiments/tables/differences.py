"""Every group against the baseline on the same scenarios and seeds."""

from experiments.labels import label
from experiments.outcomes import Outcomes
from experiments.statistics import difference, holm
from experiments.suites import Suite
from experiments.tables.table import Table, percent, percent_interval

BASELINE_STREAM = 1  # of draws, so that training seeds of the baseline are drawn independently

SIGNED = "+.2f"  # per cent


def difference_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Paired differences of the gap; p-values are corrected over the whole table.

    There is none where the suite is run without its baseline.
    """
    if suite.baseline not in outcomes.groups:
        return []
    compared = []
    for scenario_set in outcomes.sets:
        baseline = outcomes.sample(suite.baseline, scenario_set)
        for group in outcomes.groups:
            if group != suite.baseline:
                sample = outcomes.sample(group, scenario_set)
                found = difference(sample.gap, baseline.gap, sample.draws(), baseline.draws(BASELINE_STREAM))
                cost = sample.evaluations.mean() / baseline.evaluations.mean()
                compared.append((scenario_set, group, found, cost))
    adjusted = holm([found.p_value for _, _, found, _ in compared])
    rows = [
        (
            scenario_set,
            label(group),
            f"{percent(found.difference, SIGNED)} {percent_interval(found.interval, SIGNED)}",
            percent(found.relative_change, "+.1f"),
            f"{cost:.2f}",
            f"{found.superiority:.2f}",
            f"{found.improvement:.2f}",
            f"{p_value:.2g}",
        )
        for (scenario_set, group, found, cost), p_value in zip(compared, adjusted, strict=True)
    ]
    return [
        Table(
            "differences",
            f"Paired with {label(suite.baseline)} on the same scenarios and seeds: mean difference of the "
            "gap in per cent of the optimum (negative is better) [95 % interval over training seeds, "
            "scenarios of a set and seeds], change of the mean gap, ratio of the mean evaluations, A12 over "
            "all runs, probability of improvement on the same scenario and seed, Wilcoxon signed-rank "
            "p-value of the means over training seeds after Holm's correction",
            (
                "scenarios", "controller", "difference", "change of mean gap", "evaluations ratio", "A12",
                "improvement", "p",
            ),
            rows,
        )
    ]  # fmt: skip
