"""How far the runs of each group end from the optimum, and at what cost."""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import interval, means, summarise_group
from experiments.tables.table import Table, percent, percent_interval

NEAR = 0.01  # of the optimum
FINE = ".2f"  # per cent; controllers differ by little


def gap_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Optimality gap, feasibility and cost, a row per set of scenarios and group of controllers."""
    rows = []
    for scenario_set in outcomes.sets:
        for group in outcomes.groups:
            sample = outcomes.sample(group, scenario_set)
            found = summarise_group(sample.gap, sample.draws())
            rows.append(
                (
                    scenario_set,
                    label(group),
                    str(sample.gap.size),
                    str(sample.num_training_seeds),
                    f"{percent(found.mean, FINE)} {percent_interval(found.interval, FINE)}",
                    f"{percent(found.inter_quartile_mean, FINE)} "
                    f"{percent_interval(found.inter_quartile_interval, FINE)}",
                    percent(found.median, FINE),
                    percent(found.minimum, FINE),
                    percent(found.maximum, FINE),
                    percent(found.deviation, FINE),
                    percent(sample.feasible.mean()),
                    f"{sample.evaluations.mean():,.0f}",
                    f"{sample.seconds.mean():.3f}",
                )
            )
    return [
        Table(
            "gaps",
            "Optimality gap, (final fitness - optimum) / optimum, of all runs of all training seeds, with "
            "95 % bootstrap intervals over training seeds, scenarios of a set and seeds; cost per run",
            (
                "scenarios", "controller", "runs", "training seeds", "mean gap", "inter-quartile mean",
                "median", "min", "max", "std", "feasible", "mean evaluations", "mean seconds",
            ),
            rows,
        )
    ]  # fmt: skip


def near_optimum_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """The share of runs that end within 1 % of the optimum, a row per group and a column per set."""
    rows = []
    for group in outcomes.groups:
        cells = []
        for scenario_set in outcomes.sets:
            sample = outcomes.sample(group, scenario_set)
            near = (sample.gap <= NEAR).astype(np.float64)
            cells.append(f"{percent(near.mean())} {percent_interval(interval(means(near, sample.draws())))}")
        rows.append((label(group), *cells))
    return [
        Table(
            "near-optimum",
            f"Share of runs within {100 * NEAR:.0f} % of the optimum [95 % interval]",
            ("controller", *outcomes.sets),
            rows,
        )
    ]
