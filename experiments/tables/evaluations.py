"""The table of evaluations until the optimum, for bit strings, on which runs are measured by them."""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import mean_difference
from experiments.tables.cell import MISSING, Entry, number, number_in, share, share_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.table import Row, Table
from swarm_gym.comparing.compared_runs import least_evaluations_of


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
    rows = [_row(suite, outcomes, first, *each) for each in outcomes.samples()]
    return [Table.of("evaluations", caption, rows)]


def _row(suite: Suite, outcomes: Outcomes, first: str, scenario_set: str, group: str, sample: Sample) -> Row:
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
