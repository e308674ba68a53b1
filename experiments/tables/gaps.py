"""Tables of how far the runs of each group end from the optimum, and at what cost.

On bit strings all runs reach the optimum, and evaluations until then measure them.
"""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.measures import NEAR
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import mean_difference, summarise_group
from experiments.tables.cell import MISSING, Entry, number, number_in, share, share_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.table import Row, Table
from swarm_gym.comparing.compared_runs import least_evaluations_of

FINE = ".2f"  # per cent; controllers differ by little


def gap_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of gap, feasibility and cost, a row per set of scenarios and group of controllers."""
    caption = (
        "Optimality gap, (final fitness - optimum) / optimum, of all runs of all training seeds, with "
        "95 % bootstrap intervals over training seeds, scenarios of a set and seeds; cost per run"
    )
    return [Table.of("gaps", caption, (_gap_row(*each) for each in outcomes.samples()))]


def _gap_row(scenario_set: str, group: str, sample: Sample) -> Row:
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


def evaluation_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of evaluations, a row per set of scenarios and group; none for other scenarios."""
    if least_evaluations_of(outcomes.scenarios, outcomes.options) is None:
        return []
    first = next(iter(outcomes.groups))
    caption = (
        "Evaluations until all bits are set, over all training seeds, with 95 % bootstrap intervals over "
        "training seeds, scenarios of a set and seeds; above the optimum: above the expected evaluations of "
        "the optimal control of lambda up to 64; minus: the mean difference to "
        f"{label(first)} on the same seeds"
    )
    rows = [_evaluation_row(suite, outcomes, first, *each) for each in outcomes.samples()]
    return [Table.of("evaluations", caption, rows)]


def _evaluation_row(
    suite: Suite, outcomes: Outcomes, first: str, scenario_set: str, group: str, sample: Sample
) -> Row:
    solved = sample.fitness == 0.0
    rival = outcomes.sample(first, scenario_set)
    minus: Entry = MISSING
    if group != first:
        draws = sample.draws(), rival.draws(RIVAL_STREAM)
        minus = number_in(*mean_difference(sample.evaluations, rival.evaluations, *draws), "+,.1f")
    above: Entry = MISSING
    least = least_evaluations_of(sample.scenarios, suite.options)
    if solved.all() and least is not None and not np.isnan(least).any():
        above = share_in(*sample.mean(sample.evaluations / least[:, None] - 1.0), "+.2f")
    return {
        "scenarios": scenario_set,
        "controller": label(group),
        "runs": number(sample.fitness.size, "d"),
        "evaluations": number_in(*sample.mean(sample.evaluations), ",.1f"),
        f"minus {label(first)}": minus,
        "above the optimum": above,
        "solved": share(solved.mean(), ".0f"),
    }
