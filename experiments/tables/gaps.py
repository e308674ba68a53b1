"""Tables of optimality gaps: how far the runs of each group end from the optimum, and at what cost."""

from experiments.runs.labels import label
from experiments.runs.measures import NEAR
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import summarise_group
from experiments.tables.cell import Entry, number, share, share_in
from experiments.tables.table import Row, Table

FINE = ".2f"  # per cent; controllers differ by little


def gap_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of gap, feasibility and cost, a row per set of scenarios and group of controllers."""
    caption = (
        "Optimality gap, (final fitness - optimum) / optimum, of all runs of all training seeds, with "
        "95 % bootstrap intervals over training seeds, scenarios of a set and seeds; cost per run"
    )
    return [Table.of("gaps", caption, (_row(*each) for each in outcomes.samples()))]


def _row(scenario_set: str, group: str, sample: Sample) -> Row:
    found = summarise_group(sample.gap, sample.draws())
    return {
        "scenarios": scenario_set,
        "controller": label(group),
        "runs": number(sample.gap.size, "d"),
        "training seeds": number(sample.num_training_seeds, "d"),
        "mean gap": share_in(found.mean, found.interval, FINE),
        "inter-quartile mean": share_in(found.inter_quartile_mean, found.inter_quartile_interval, FINE),
        "median": share(found.median, FINE),
        "min": share(found.minimum, FINE),
        "max": share(found.maximum, FINE),
        "std": share(found.deviation, FINE),
        "feasible": share(sample.feasible.mean()),
        "mean evaluations": number(sample.evaluations.mean(), ",.0f"),
        "mean seconds": number(sample.seconds.mean(), ".3f"),
    }


def near_optimum_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of the share of runs within 1 % of the optimum, a row per group, a column per set."""
    rows: dict[str, dict[str, Entry]] = {group: {"controller": label(group)} for group in outcomes.groups}
    for scenario_set, group, sample in outcomes.samples():
        rows[group][scenario_set] = share_in(*sample.mean((sample.gap <= NEAR).astype(float)))
    caption = f"Share of runs within {100 * NEAR:.0f} % of the optimum [95 % interval]"
    return [Table.of("near-optimum", caption, rows.values())]
