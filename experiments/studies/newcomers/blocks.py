"""The marked blocks of docs/newcomers.md: each shows a table or a figure of the study's suites.

To add one, write the pair of marks into the document and a line into `BLOCKS`.
"""

from functools import partial

from experiments.runs.groups import group_controllers
from experiments.studies.newcomers.bends import bends_table, stored_outcomes
from experiments.studies.newcomers.suites import (
    ABLATION,
    BEND_SUITES,
    FIELDS,
    LOOKED_INTO,
    NEWCOMERS,
    OPTIMIZERS,
)
from experiments.tables.blocks import (
    by_set,
    decisions_name,
    figure,
    gaps,
    made_with,
    value_by_set,
    whole,
)
from experiments.tables.document import Block, ResultsFolder
from experiments.tables.table import wrapped

FIGURES = "results/newcomers"  # seen from the document
GAP_COLUMNS = (
    "scenarios", "controller", "mean gap", "inter-quartile mean", "median", "max", "feasible",
    "mean evaluations",
)  # fmt: skip


def _bends(results: ResultsFolder) -> str:
    """Return the comparison of both kinds of bends, from the databases of their suites."""
    outcomes = {
        kind: [stored_outcomes(suite, results.path) for suite in suites]
        for kind, suites in BEND_SUITES.items()
    }
    return bends_table(outcomes).markdown()


def _bends_made_with(results: ResultsFolder) -> str:
    lines = [
        f"* `{suite.name}`: {made_with(suite.name, results)}"
        for pair in BEND_SUITES.values()
        for suite in pair
    ]
    return "\n".join(line.strip() for line in lines)


def _gaps(suite: str, results: ResultsFolder) -> str:
    """Return quality and cost by set of scenarios, below the caption of the whole table."""
    caption = results.table(f"{suite}/gaps").caption
    return f"{wrapped(caption)}.\n\n{gaps(suite, results, GAP_COLUMNS)}"


def _by_set(suite: str, name: str, results: ResultsFolder) -> str:
    """Return a table by set of scenarios, below the caption of the whole table."""
    table = results.table(f"{suite}/{name}")
    return f"{wrapped(table.caption)}.\n\n{by_set(table)}"


def _decisions(results: ResultsFolder) -> str:
    """Return the figures of the decisions of groups, as far as these were run and decide anything."""
    run = group_controllers(NEWCOMERS.controllers)
    shown = [group for group in LOOKED_INTO if group in run]
    return "\n\n".join(
        figure(FIGURES, NEWCOMERS.name, decisions_name(group), f"decisions of {group}", results)
        for group in shown
        if (results.path / NEWCOMERS.name / f"figure-{decisions_name(group)}.svg").exists()
    )


def _suite_blocks(suite: str) -> dict[str, Block]:
    """Return the blocks that every suite with gaps has."""
    return {
        f"{suite}-made-with": partial(made_with, suite),
        f"{suite}-gaps": partial(_gaps, suite),
        f"{suite}-near-optimum": partial(whole, suite, "near-optimum"),
        f"{suite}-differences": partial(_by_set, suite, "differences"),
        f"{suite}-claims": partial(whole, suite, "claims"),
        f"{suite}-duels": partial(_by_set, suite, "duels"),
        f"{suite}-hypervolume": partial(
            value_by_set, suite, "hypervolume", ("family", "controllers"), "hypervolume"
        ),
        f"{suite}-front": partial(
            figure, FIGURES, suite, "front", "mean gap against mean evaluations of every controller"
        ),
        f"{suite}-profiles": partial(
            figure, FIGURES, suite, "profiles", "share of runs within a gap, by the gap"
        ),
    }


BLOCKS: dict[str, Block] = {
    "first-populations": partial(
        figure, FIGURES, NEWCOMERS.name, "first-populations", "first populations by their source"
    ),
    "bends": _bends,
    "bends-made-with": _bends_made_with,
    **_suite_blocks(NEWCOMERS.name),
    "decisions": _decisions,
    "corridors": partial(_by_set, NEWCOMERS.name, "corridors"),
    "corridor-paths": partial(whole, NEWCOMERS.name, "corridor-paths"),
    "corridors-figure": partial(
        figure, FIGURES, NEWCOMERS.name, "corridors", "the best path of each corridor in which most runs end"
    ),
    **_suite_blocks(FIELDS.name),
    "ablation-gaps": partial(_gaps, ABLATION.name),
    "ablation-near-optimum": partial(whole, ABLATION.name, "near-optimum"),
    "ablation-claims": partial(whole, ABLATION.name, "claims"),
    "ablation-made-with": partial(made_with, ABLATION.name),
    "optimizers": partial(whole, OPTIMIZERS.name, "newcomers-optimizers"),
    "optimizers-made-with": partial(made_with, OPTIMIZERS.name),
}
