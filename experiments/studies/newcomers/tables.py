"""Tables of the study of new members, and the document that shows them."""

from dataclasses import dataclass
from pathlib import Path

from experiments.runs.entrants import entrant
from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import Difference, difference
from experiments.studies.newcomers.blocks import BLOCKS
from experiments.studies.newcomers.corridors import corridor_tables
from experiments.studies.newcomers.suites import (
    BASELINE,
    SMOOTH_MEMBERS,
    UNIFORM_MEMBERS,
)
from experiments.tables.cell import Entry, number, share, share_in
from experiments.tables.claims import Claim, claims_table
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.document import Document
from experiments.tables.gaps import NEAR
from experiments.tables.table import Table

FINE = ".2f"


@dataclass(frozen=True)
class Comparison:
    """A sentence of the document that compares the gaps of two groups, in a form that is checked.

    Attributes:
        text: the sentence. It holds for a scenario if the whole interval of the difference is below 0.
        group: key of the group whose gap is smaller.
        rival: key of the other group.
    """

    text: str
    group: str
    rival: str


# Sentences of the document; those about groups that were not run are left out.
SOURCED = "open-loop:three-cases-sourced/*@1"
COMPARISONS: tuple[Comparison, ...] = (
    Comparison(
        "Open loops that decide sources end closer to the optimum than the baseline.", SOURCED, BASELINE
    ),
    Comparison(
        "They end closer to it than open loops without sources that were tuned with as many steps.",
        SOURCED,
        "open-loop:three-cases-extended-long/*@1",
    ),
    Comparison(
        "They end closer to it than policies that decide size, φ, noise and attractiveness.",
        SOURCED,
        "learned:three-cases-extended/*@2",
    ),
    Comparison(
        "They end closer to it than constant decisions on the same things.",
        SOURCED,
        "open-loop:three-cases-sourced-constant/*@1",
    ),
    Comparison("They end closer to it than the restart rule.", SOURCED, "tuned:three-cases-restart/*"),
    Comparison(
        "Policies that correct such an open loop end closer to it than open loops.",
        "learned:three-cases-sourced/*",
        SOURCED,
    ),
)


def claim_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of the sentences that compare groups, with the scenarios on which each holds."""
    claims = []
    for comparison in COMPARISONS:
        if outcomes.groups.keys() >= {comparison.group, comparison.rival}:
            found = {
                name: compare_groups(outcomes, comparison.group, comparison.rival, name).interval[1] < 0.0
                for name in outcomes.sets
            }
            claims.append(Claim(comparison.text, found))
    return [claims_table("claims", "What is said of gaps, and where it does not hold", claims)]


def compare_groups(outcomes: Outcomes, group: str, rival: str, scenario_set: str) -> Difference:
    """Return the paired comparison of the gaps of two groups on a set of scenarios."""
    mine, theirs = outcomes.sample(group, scenario_set), outcomes.sample(rival, scenario_set)
    return difference(mine.gap, theirs.gap, mine.draws(), theirs.draws(RIVAL_STREAM))


def optimizer_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of first populations, a row for each optimizer and set of scenarios."""
    optimizers = dict.fromkeys(entrant(name, suite.optimizer).optimizer for name in outcomes.controllers)
    rows: list[tuple[Entry, ...]] = []
    for optimizer in optimizers:
        uniform, smooth = (f"{optimizer}+{members}" for members in (UNIFORM_MEMBERS, SMOOTH_MEMBERS))
        if not {uniform, smooth} <= set(outcomes.controllers):
            continue
        for scenario_set in outcomes.sets:
            samples = [outcomes.sample(name, scenario_set) for name in (uniform, smooth)]
            found = compare_groups(outcomes, smooth, uniform, scenario_set)
            rows.append(
                (
                    OPTIMIZER_LABELS.get(optimizer, optimizer),
                    scenario_set,
                    *(share(sample.gap.mean(), FINE) for sample in samples),
                    share_in(found.difference, found.interval, "+.2f"),
                    number(found.improvement, ".2f"),
                    *(share((sample.gap <= NEAR).mean()) for sample in samples),
                    number(samples[1].evaluations.mean() / samples[0].evaluations.mean(), ".2f"),
                )
            )
    columns = (
        "optimizer", "scenarios", "gap, uniform", "gap, smooth", "difference", "improvement",
        "near, uniform", "near, smooth", "evaluations ratio",
    )  # fmt: skip
    caption = (
        "60 members all the time, by the source of the first population: mean gaps; their difference, smooth "
        "minus uniform, paired by scenario and seed (negative: smooth is better) [95 % interval]; share of "
        "pairs in which smooth is better, ties count half; shares of runs within "
        f"{100 * NEAR:.0f} % of the optimum; ratio of the mean evaluations, smooth over uniform"
    )
    return [Table("newcomers-optimizers", caption, columns, rows)] if rows else []


TABLES = {
    "newcomers-claims": claim_tables,
    "newcomers-optimizers": optimizer_tables,
    "corridors": corridor_tables,
}
DOCUMENTS = {
    "newcomers": Document(
        Path("docs/newcomers.md"), "docs/newcomers-study", "newcomers", "newcomers-study", BLOCKS
    )
}
