"""Tables of optimality gaps: how far the runs of each group end from the optimum, and at what cost."""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.measures import NEAR
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import interval, means, summarise_group
from experiments.tables.cell import Entry, number, share, share_in
from experiments.tables.table import Table

FINE = ".2f"  # per cent; controllers differ by little


def gap_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of gap, feasibility and cost, a row per set of scenarios and group of controllers."""
    rows: list[tuple[Entry, ...]] = []
    for scenario_set in outcomes.sets:
        for group in outcomes.groups:
            sample = outcomes.sample(group, scenario_set)
            found = summarise_group(sample.gap, sample.draws())
            rows.append(
                (
                    scenario_set,
                    label(group),
                    number(sample.gap.size, "d"),
                    number(sample.num_training_seeds, "d"),
                    share_in(found.mean, found.interval, FINE),
                    share_in(found.inter_quartile_mean, found.inter_quartile_interval, FINE),
                    share(found.median, FINE),
                    share(found.minimum, FINE),
                    share(found.maximum, FINE),
                    share(found.deviation, FINE),
                    share(sample.feasible.mean()),
                    number(sample.evaluations.mean(), ",.0f"),
                    number(sample.seconds.mean(), ".3f"),
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
    """Return a table of the share of runs within 1 % of the optimum, a row per group, a column per set."""
    rows: list[tuple[Entry, ...]] = []
    for group in outcomes.groups:
        cells = []
        for scenario_set in outcomes.sets:
            sample = outcomes.sample(group, scenario_set)
            near = (sample.gap <= NEAR).astype(np.float64)
            cells.append(share_in(near.mean(), interval(means(near, sample.draws()))))
        rows.append((label(group), *cells))
    return [
        Table(
            "near-optimum",
            f"Share of runs within {100 * NEAR:.0f} % of the optimum [95 % interval]",
            ("controller", *outcomes.sets),
            rows,
        )
    ]
