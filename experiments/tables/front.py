"""Quality against cost: which groups are on the front, and how much a family of them covers."""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Family, Suite
from experiments.statistics import Interval, hypervolume, interval, means, non_dominated
from experiments.tables.table import Table, percent, percent_interval


def front_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """The points of all groups, and the hypervolumes of the suite's families if it has any."""
    rows = []
    for scenario_set in outcomes.sets:
        samples = [outcomes.sample(group, scenario_set) for group in outcomes.groups]
        points = np.array([(sample.evaluations.mean(), sample.gap.mean()) for sample in samples])
        for group, sample, point, best in zip(
            outcomes.groups, samples, points, non_dominated(points), strict=True
        ):
            ends = interval(means(sample.gap, sample.draws()))
            rows.append(
                (
                    scenario_set,
                    label(group),
                    f"{point[0]:,.0f}",
                    f"{percent(point[1], '.2f')} {percent_interval(ends, '.2f')}",
                    "yes" if best else "no",
                )
            )
    table = Table(
        "front",
        "Mean evaluations against mean gap [95 % interval]; on the front is what no other controller matches "
        "in both and beats in one",
        ("scenarios", "controller", "mean evaluations", "mean gap", "on the front"),
        rows,
    )
    return [table, *_hypervolume_tables(suite, outcomes)]


def family_hypervolume(
    family: Family, outcomes: Outcomes, scenario_set: str, reference: tuple[float, float]
) -> tuple[float, Interval]:
    """Hypervolume of the groups of a family that were run, decades of evaluations times gap.

    Args:
        family: the family; at least one of its groups was run.
        outcomes: of the suite.
        scenario_set: key of the set.
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
    present = [family for family in suite.families if not outcomes.groups.keys().isdisjoint(family.groups)]
    rows = []
    for scenario_set in outcomes.sets:
        for family in present:
            found, ends = family_hypervolume(family, outcomes, scenario_set, suite.reference)
            members = ", ".join(label(group) for group in family.groups if group in outcomes.groups)
            rows.append((scenario_set, family.name, members, f"{found:.4f} [{ends[0]:.4f}, {ends[1]:.4f}]"))
    evaluations, gap = suite.reference
    table = Table(
        "hypervolume",
        "Hypervolume of the front of a family, decades of evaluations times gap (larger is better) [95 % "
        f"interval], from the reference point of {evaluations:,.0f} evaluations and a gap of {percent(gap)}",
        ("scenarios", "family", "controllers", "hypervolume"),
        rows,
    )
    return [table] if rows else []
