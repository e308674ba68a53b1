"""Tables of runs on maps that change: error over time, and what seeing a change is worth."""

import numpy as np

from experiments.runs.changes import Changes, iterations_to_feasible
from experiments.runs.labels import label
from experiments.runs.measures import MEASURES
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import interval, means
from experiments.studies.dynamic.suites import TOLD
from experiments.tables.cell import MISSING, Entry, number, number_in, share, share_in
from experiments.tables.table import Row, Table

SOON = 10  # iterations after an event within which a path is to be feasible again
PRICE = 1.0

OVER_TIME = (
    "Offline error: mean gap in per cent on the map in force, from the first event to the end. Offline "
    f"objective: that plus evaluations / 100,000, over all training and tuning seeds [95 % interval over "
    "these seeds, scenarios of a set and seeds]. Final gap in per cent. Feasible soon: events after which "
    f"there was a feasible path within {SOON} iterations, whatever the best path by fitness"
)
SEEING = (
    "What seeing a change is worth: the best blind controller of each set gains nothing, the best one that "
    "is told the times of events gains everything, and the others have their share of that gain [95 % "
    "interval over training seeds, scenarios of a set and seeds]. Below 0 is a larger objective than blind. "
    "Where the interval of the whole gain has 0 in it, there are no shares"
)


def over_time_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table with a row for each set of scenarios and group, ordered by objective in each set."""
    objective = MEASURES["offline objective"].of
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        samples = {group: outcomes.sample(group, scenario_set) for group in outcomes.groups}
        values = {group: objective(sample, PRICE) for group, sample in samples.items()}
        rows += [
            {
                "scenarios": scenario_set,
                "controller": label(group),
                "seeds": number(samples[group].num_training_seeds, "d"),
                "offline objective": number_in(*samples[group].mean(values[group]), ".3f"),
                "offline error": number(100.0 * samples[group].find_offline_error().mean(), ".3f"),
                "final gap": number(100.0 * samples[group].gap.mean(), ".3f"),
                "evaluations": number(samples[group].evaluations.mean(), ",.0f"),
                "feasible soon": share(_soon(outcomes, group, samples[group].scenarios)),
            }
            for group in sorted(samples, key=lambda name: float(values[name].mean()))
        ]
    return [Table.of("over-time", OVER_TIME, rows)]


def _soon(outcomes: Outcomes, group: str, scenarios: tuple[str, ...]) -> float:
    """Return the share of events, over all runs of a group, with a feasible path soon; NaN without events."""
    found = [
        iterations_to_feasible(outcomes.runs(controller, scenario), event) <= SOON
        for controller in outcomes.groups[group]
        for scenario in scenarios
        for event in Changes.of(scenario).events
    ]
    return float(np.concatenate(found).mean()) if found else np.nan


def seeing_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a row for each set of scenarios and group that is not blind; none if nothing was told."""
    told = [group for family in suite.families if family.name == TOLD for group in family.groups]
    blind = [group for family in suite.families if family.blind for group in family.groups]
    if not set(told) & set(outcomes.groups) or not set(blind) & set(outcomes.groups):
        return []
    objective = MEASURES["offline objective"].of
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        samples = {group: outcomes.sample(group, scenario_set) for group in outcomes.groups}
        found = {group: float(objective(sample, PRICE).mean()) for group, sample in samples.items()}
        rival, bound = (
            min((group for group in groups if group in found), key=found.__getitem__)
            for groups in (blind, told)
        )
        others = [group for group in found if group not in blind]
        rows += [
            {
                "scenarios": scenario_set,
                "controller": label(group),
                "offline objective": number(found[group], ".3f"),
                "share of the gain": "0 %"
                if group == rival
                else _share(samples[group], samples[rival], samples[bound]),
            }
            for group in (rival, *sorted(others, key=found.__getitem__, reverse=True))
        ]
    return [Table.of("seeing", SEEING, rows)]


def _share(*samples: Sample) -> Entry:
    """Return what a group gains over the blind one, as a share of what the told one gains; in this order."""
    values = [MEASURES["offline objective"].of(sample, PRICE) for sample in samples]
    mine, blind, told = (each.mean() for each in values)
    # One stream of draws for each, since their training seeds are different ones.
    drawn = [
        means(each, sample.draws(stream))
        for stream, (each, sample) in enumerate(zip(values, samples, strict=True))
    ]
    gain = drawn[1] - drawn[2]
    if interval(gain)[0] <= 0.0:
        return MISSING
    if samples[0] is samples[2]:
        return "100 %"
    return share_in((blind - mine) / (blind - told), interval((drawn[1] - drawn[0]) / gain), ".0f")
