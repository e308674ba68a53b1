"""Tables of quality against cost: groups on the front, and the area that a family of them covers."""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import ControllerFamily, Suite
from experiments.statistics import Interval, hypervolume, interval, means, non_dominated
from experiments.tables.cell import number, number_in, percent, share_in
from experiments.tables.table import Row, Table


def front_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the points of all groups, and one of hypervolumes if the suite has families."""
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        samples = [outcomes.sample(group, scenario_set) for group in outcomes.groups]
        points = np.array([(sample.evaluations.mean(), sample.gap.mean()) for sample in samples])
        rows += [
            {
                "scenarios": scenario_set,
                "controller": label(group),
                "mean evaluations": number(sample.evaluations.mean(), ",.0f"),
                "mean gap": share_in(*sample.mean(sample.gap), ".2f"),
                "on the front": "yes" if best else "no",
            }
            for group, sample, best in zip(outcomes.groups, samples, non_dominated(points), strict=True)
        ]
    caption = (
        "Mean evaluations against mean gap [95 % interval]; on the front is what no other controller matches "
        "in both and beats in one"
    )
    return [Table.of("front", caption, rows), *_hypervolume_tables(suite, outcomes)]


def family_hypervolume(
    family: ControllerFamily, outcomes: Outcomes, scenario_set: str, reference: tuple[float, float]
) -> tuple[float, Interval]:
    """Return the hypervolume of the groups of a family that were run, decades of evaluations times gap.

    Args:
        family: the family; at least one of its groups was run.
        outcomes: runs of the suite.
        scenario_set: key of the set of scenarios.
        reference: evaluations and gap.

    Returns:
        The hypervolume of the means, and its 95 % interval.
    """
    samples = [outcomes.sample(group, scenario_set) for group in family.groups if group in outcomes.groups]
    worst = np.log10(reference[0]), reference[1]
    points = [(np.log10(sample.evaluations.mean()), sample.gap.mean()) for sample in samples]
    resampled = []
    for stream, sample in enumerate(samples):
        draws = sample.draws(stream)
        resampled.append((np.log10(means(sample.evaluations, draws)), means(sample.gap, draws)))
    fronts = np.moveaxis(np.array(resampled), 2, 0)  # (resamples, groups, 2)
    return float(hypervolume(np.array(points), worst)), interval(hypervolume(fronts, worst))


def _hypervolume_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    rows: list[Row] = [
        {
            "scenarios": scenario_set,
            "family": family.name,
            "controllers": ", ".join(label(group) for group in family.groups if group in outcomes.groups),
            "hypervolume": number_in(
                *family_hypervolume(family, outcomes, scenario_set, suite.reference), ".4f"
            ),
        }
        for scenario_set in outcomes.sets
        for family in suite.families
        if not outcomes.groups.keys().isdisjoint(family.groups)
    ]
    evaluations, gap = suite.reference
    caption = (
        "Hypervolume of the front of a family, decades of evaluations times gap (larger is better) [95 % "
        f"interval], from the reference point of {evaluations:,.0f} evaluations and a gap of {percent(gap)}"
    )
    return Table.if_any("hypervolume", caption, rows)
