"""The table of what seeing a change is worth: shares of what a controller gains that is told of events."""

from experiments.runs.labels import label
from experiments.runs.measures import MEASURES
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import interval, means
from experiments.studies.dynamic.over_time import PRICE
from experiments.tables.cell import Entry, number, share_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.table import Table

TOLD = "told the times of events"  # name of the family that is the upper bound
COLUMNS = ("scenarios", "controller", "offline objective", "share of the gain")
CAPTION = (
    "What seeing a change is worth: the best blind controller of each set gains nothing, the best one that "
    "is told the times of events gains everything, and the others have their share of that gain [95 % "
    "interval over training seeds, scenarios of a set and seeds]. Below 0 is a larger objective than blind"
)


def seeing_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a row for each set of scenarios and group that is not blind; none if nothing was told."""
    told = [group for family in suite.families if family.name == TOLD for group in family.groups]
    blind = [group for family in suite.families if family.blind for group in family.groups]
    if not set(told) & set(outcomes.groups) or not set(blind) & set(outcomes.groups):
        return []
    rows: list[tuple[Entry, ...]] = []
    for scenario_set in outcomes.sets:
        found = {group: _objective(outcomes, group, scenario_set, 0) for group in outcomes.groups}
        worst = _best(blind, found)
        bound = _best(told, found)
        rows.append((scenario_set, label(worst), number(found[worst][0], ".3f"), "0 %"))
        others = [group for group in found if group not in blind]
        for group in sorted(others, key=lambda name: found[name][0], reverse=True):
            rows.append(
                (
                    scenario_set,
                    label(group),
                    number(found[group][0], ".3f"),
                    "100 %" if group == bound else _share(outcomes, scenario_set, group, worst, bound),
                )
            )
    return [Table("seeing", CAPTION, COLUMNS, rows)]


def _best(groups: list[str], found: dict[str, tuple[float, Floats]]) -> str:
    return min((group for group in groups if group in found), key=lambda name: found[name][0])


def _objective(outcomes: Outcomes, group: str, scenario_set: str, stream: int) -> tuple[float, Floats]:
    """Return the mean offline objective of a group, and those of resamples."""
    sample = outcomes.sample(group, scenario_set)
    values = MEASURES["offline objective"].of(sample, PRICE)
    return float(values.mean()), means(values, sample.draws(stream))


def _share(outcomes: Outcomes, scenario_set: str, group: str, blind: str, told: str) -> Entry:
    """Return what a group gains over the blind one, as a share of what the told one gains."""
    (mine, my_draws), (theirs, their_draws), (bound, bound_draws) = (
        _objective(outcomes, name, scenario_set, stream)
        for stream, name in enumerate((group, blind, told), start=RIVAL_STREAM - 1)
    )
    resampled = (their_draws - my_draws) / (their_draws - bound_draws)
    return share_in((theirs - mine) / (theirs - bound), interval(resampled), ".0f")
