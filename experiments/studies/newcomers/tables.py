"""Tables of the study of new members, and the marked blocks of its page and of the page's appendix.

To add a block, write the pair of marks into docs/newcomers.md or docs/newcomers-tables.md, and a line into
`BLOCKS` or `TABLE_BLOCKS`.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

from experiments.runs.groups import EVERY_SET, group_controllers
from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.measures import NEAR
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import difference
from experiments.studies.newcomers.bends import bends_table, stored_outcomes
from experiments.studies.newcomers.corridors import corridor_tables
from experiments.studies.newcomers.findings import FINDINGS, STRONGEST
from experiments.studies.newcomers.suites import (
    ABLATION,
    BEND_SUITES,
    FIELDS,
    LOOKED_INTO,
    NEWCOMERS,
    OPTIMIZERS,
    SMOOTH_MEMBERS,
    UNIFORM_MEMBERS,
)
from experiments.tables.block_contents import (
    by_set,
    decisions_name,
    figure,
    findings,
    gaps,
    made_with,
    rows_of,
    value_by_set,
    whole,
)
from experiments.tables.cell import number, share, share_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.reshape import join, select
from experiments.tables.table import Row, Table, wrapped
from swarm_gym.comparing.entrants import entrant

FIGURES = "results/newcomers"  # seen from the document
TABLE_FIGURES = "results/newcomers-tables"
ON_THE_PAGE = "learned:three-cases-sourced-ppo/*"  # the group whose decisions the page itself shows
STRONGEST_CAPTION = (
    "The strongest controllers of each kind on the three cases, with the baseline and the paper's rules: "
    "mean gap and median gap in per cent of the optimum [95 % interval over training seeds, scenarios of a "
    "set and seeds]; runs within 1 % of the optimum; runs whose best path is free of collision, before any "
    "repair; mean evaluations of a run"
)
GAP_COLUMNS = (
    "scenarios", "controller", "mean gap", "inter-quartile mean", "median", "max", "feasible",
    "mean evaluations",
)  # fmt: skip
STRONGEST_COLUMNS = ("controller", "mean gap", "median", "within 1 %", "feasible", "mean evaluations")


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


def _strongest(results: ResultsFolder) -> str:
    """Return quality and cost of the strongest controllers over all cases."""
    near = select(results.table(f"{NEWCOMERS.name}/near-optimum"), ("controller", EVERY_SET))
    near = replace(near, columns=("controller", "within 1 %"))
    found = rows_of(results.table(f"{NEWCOMERS.name}/gaps"), STRONGEST, EVERY_SET)
    found = join(found, near, ("controller",), "within 1 %")
    return select(replace(found, caption=STRONGEST_CAPTION), STRONGEST_COLUMNS).markdown()


def _decisions(groups: tuple[str, ...], folder: str, results: ResultsFolder) -> str:
    """Return the figures of the decisions of groups, as far as these were run and decide anything."""
    run = group_controllers(NEWCOMERS.controllers)
    return "\n\n".join(
        figure(folder, NEWCOMERS.name, decisions_name(group), f"decisions of {group}", results)
        for group in groups
        if group in run and (results.path / NEWCOMERS.name / f"figure-{decisions_name(group)}.svg").exists()
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
        f"{suite}-profiles": partial(
            figure, TABLE_FIGURES, suite, "profiles", "share of runs within a gap, by the gap"
        ),
    }


FRONT_TEXT = "mean gap against mean evaluations of every controller"
BLOCKS: dict[str, Block] = {
    "findings": partial(findings, FINDINGS),
    "strongest": _strongest,
    "first-populations": partial(
        figure, FIGURES, NEWCOMERS.name, "first-populations", "first populations by their source"
    ),
    "corridors-figure": partial(
        figure, FIGURES, NEWCOMERS.name, "corridors", "the best path of each corridor in which most runs end"
    ),
    "newcomers-front": partial(figure, FIGURES, NEWCOMERS.name, "front", FRONT_TEXT),
    "decisions": partial(_decisions, (ON_THE_PAGE,), FIGURES),
}
TABLE_BLOCKS: dict[str, Block] = {
    "bends": _bends,
    "bends-made-with": _bends_made_with,
    **_suite_blocks(NEWCOMERS.name),
    "other-decisions": partial(
        _decisions, tuple(group for group in LOOKED_INTO if group != ON_THE_PAGE), TABLE_FIGURES
    ),
    "corridors": partial(_by_set, NEWCOMERS.name, "corridors"),
    "corridor-paths": partial(whole, NEWCOMERS.name, "corridor-paths"),
    **_suite_blocks(FIELDS.name),
    "newcomers-fields-front": partial(figure, TABLE_FIGURES, FIELDS.name, "front", FRONT_TEXT),
    "ablation-gaps": partial(_gaps, ABLATION.name),
    "ablation-near-optimum": partial(whole, ABLATION.name, "near-optimum"),
    "ablation-claims": partial(whole, ABLATION.name, "claims"),
    "ablation-made-with": partial(made_with, ABLATION.name),
    "optimizers": partial(whole, OPTIMIZERS.name, "newcomers-optimizers"),
    "optimizers-made-with": partial(made_with, OPTIMIZERS.name),
}


FINE = ".2f"


def optimizer_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of first populations, a row for each optimizer and set of scenarios."""
    optimizers = dict.fromkeys(entrant(name, suite.optimizer).optimizer for name in outcomes.controllers)
    rows: list[Row] = []
    for optimizer in optimizers:
        names = [f"{optimizer}+{members}" for members in (UNIFORM_MEMBERS, SMOOTH_MEMBERS)]
        if not set(names) <= set(outcomes.controllers):
            continue
        for scenario_set in outcomes.sets:
            uniform, smooth = (outcomes.sample(name, scenario_set) for name in names)
            found = difference(smooth.gap, uniform.gap, smooth.draws(), uniform.draws(RIVAL_STREAM))
            rows.append(
                {
                    "optimizer": OPTIMIZER_LABELS.get(optimizer, optimizer),
                    "scenarios": scenario_set,
                    "gap, uniform": share(uniform.gap.mean(), FINE),
                    "gap, smooth": share(smooth.gap.mean(), FINE),
                    "difference": share_in(found.difference, found.interval, "+.2f"),
                    "improvement": number(found.improvement, ".2f"),
                    "near, uniform": share((uniform.gap <= NEAR).mean()),
                    "near, smooth": share((smooth.gap <= NEAR).mean()),
                    "evaluations ratio": number(
                        smooth.evaluations.mean() / uniform.evaluations.mean(), ".2f"
                    ),
                }
            )
    caption = (
        "60 members all the time, by the source of the first population: mean gaps; their difference, smooth "
        "minus uniform, paired by scenario and seed (negative: smooth is better) [95 % interval]; share of "
        "pairs in which smooth is better, ties count half; shares of runs within "
        f"{100 * NEAR:.0f} % of the optimum; ratio of the mean evaluations, smooth over uniform"
    )
    return Table.if_any("newcomers-optimizers", caption, rows)


TABLES = {
    "newcomers-optimizers": optimizer_tables,
    "corridors": corridor_tables,
}
RESULTS, COLLECTION = "docs/newcomers-study", "newcomers-study"
DOCUMENTS = {
    "newcomers": (
        Document(Path("docs/newcomers.md"), RESULTS, "newcomers", COLLECTION, BLOCKS),
        Document(Path("docs/newcomers-tables.md"), RESULTS, "newcomers-tables", COLLECTION, TABLE_BLOCKS),
    )
}
