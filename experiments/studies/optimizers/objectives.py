"""The objective at price 1 of groups of entrants, and differences of two of them."""

from experiments.runs.outcomes import Outcomes, Sample
from experiments.statistics import mean_difference
from experiments.tables.cell import MISSING, Cell, Entry, number_in
from experiments.tables.differences import RIVAL_STREAM

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
