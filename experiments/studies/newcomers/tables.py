"""Tables of the study of new members, and the document that shows them."""

from pathlib import Path

from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.measures import NEAR
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import difference
from experiments.studies.newcomers.blocks import BLOCKS
from experiments.studies.newcomers.corridors import corridor_tables
from experiments.studies.newcomers.suites import SMOOTH_MEMBERS, UNIFORM_MEMBERS
from experiments.tables.cell import Entry, number, share, share_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.document import Document
from experiments.tables.table import Table
from swarm_gym.comparing.entrants import entrant

FINE = ".2f"


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
            first, second = samples
            found = difference(second.gap, first.gap, second.draws(), first.draws(RIVAL_STREAM))
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
    "newcomers-optimizers": optimizer_tables,
    "corridors": corridor_tables,
}
DOCUMENTS = {
    "newcomers": Document(
        Path("docs/newcomers.md"), "docs/newcomers-study", "newcomers", "newcomers-study", BLOCKS
    )
}
