"""The table that compares kinds of bends, from the runs of several suites.

Runs with different options belong to different suites, so this table cannot be made with the tables of one.
"""

from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path

from experiments.runs.database import Results
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import difference
from experiments.tables.cell import number, share_in
from experiments.tables.table import Row, Table

FINE = ".2f"


def bends_table(outcomes: Mapping[str, Sequence[Outcomes]]) -> Table:
    """Return a table that compares two kinds of bends, a row for each set of scenarios and controller.

    Args:
        outcomes: runs with each kind of bends by its name; of both kinds with the same controllers,
            scenarios and seeds.
    """
    rows: list[Row] = []
    (one, ones), (other, others) = outcomes.items()
    for mine, theirs in zip(ones, others, strict=True):
        for scenario_set, group, first in mine.samples():
            second = theirs.sample(group, scenario_set)
            # The same stream: both have the same scenarios and seeds, and one training seed.
            found = difference(first.gap, second.gap, first.draws(), second.draws())
            rows.append(
                {
                    "scenarios": scenario_set,
                    "controller": label(group),
                    one: share_in(*first.mean(first.gap), FINE),
                    other: share_in(*second.mean(second.gap), FINE),
                    f"{one} - {other}": share_in(found.difference, found.interval, "+.2f"),
                    "improvement": number(found.improvement, ".2f"),
                    f"evaluations, {one}": number(first.evaluations.mean(), ",.0f"),
                    f"evaluations, {other}": number(second.evaluations.mean(), ",.0f"),
                }
            )
    caption = (
        f"Mean gap with {one} and with {other} [95 % intervals], on validation seeds; their difference, "
        f"paired by scenario and seed (negative: {one} are better) [95 % interval]; share of pairs in which "
        f"{one} are better, ties count half; mean evaluations"
    )
    return Table.of("newcomers-bends", caption, rows)


def stored_outcomes(suite: Suite, folder: Path) -> Outcomes:
    """Return the numbers of a suite's runs, from its database in a folder.

    Raises:
        ResultsError: if the database is missing or lacks runs.
    """
    with closing(Results.stored(folder / f"{suite.name}.sqlite")) as results:
        return results.outcomes(suite.controllers, suite.seeds, suite.options, suite.alone)
