"""The tables of the study of learned controllers, and the documents that show them.

Suites of other studies name some of these tables as well. The marked blocks of docs/study.md and
docs/study-tables.md are data: each shows a table or a figure. To add one, write the pair of marks into the
document and a line into `BLOCKS` or `TABLE_BLOCKS`.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

from experiments.runs.groups import EVERY_SET
from experiments.studies.learned.origins import origins_table
from experiments.studies.learned.suites import (
    ABLATION,
    GENERALISATION,
    HEADLINE,
    LOOKED_INTO,
    OUT_OF_DISTRIBUTION,
    SINGLE_CASES,
)
from experiments.tables.block_contents import (
    Finding,
    decisions_name,
    figure,
    findings,
    gaps,
    made_with,
    rows_of,
    value_by_set,
    whole,
    whole_by_set,
)
from experiments.tables.cell import MISSING
from experiments.tables.claim_tables import group_claim_tables
from experiments.tables.differences import difference_tables, paired_comparison_tables
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.free_paths import free_path_tables
from experiments.tables.front import front_tables
from experiments.tables.gaps import gap_tables, near_optimum_tables
from experiments.tables.headline import headline_tables
from swarm_gym.controllers.distilled import load_rule
from swarm_gym.controllers.names import BLINDED, FITTED, ControllerName

FIGURES = "results/study"  # seen from the document
TABLE_FIGURES = "results/study-tables"
PARAMETER_FIGURES = tuple(
    (name, symbol, kind)
    for name, symbol in (("growth", "ω"), ("decay", "η"), ("low-deviation", "T_low"))
    for kind in ("courses", "outcomes")
)
FRONT_TEXT = "mean gap against mean evaluations of every controller"
PROFILES_TEXT = "share of runs within a gap, by the gap"
FAMILY = ("family", "controllers")

PARAMETER_COLUMNS = (
    "mean fitness", "std", "feasible", "mean evaluations", "evaluations ratio", "95 % interval of the ratio",
    "seconds ratio", "paper ratio",
)  # fmt: skip

TOGETHER = (HEADLINE.name, EVERY_SET, "All cases")
CASE1, CASE2, CASE3 = ((HEADLINE.name, f"case{k}", f"Case {k}") for k in (1, 2, 3))
ON_FIELDS = ((GENERALISATION.name, "random-fields:test", "Test fields"),)

SMALLER = "Policies by PPO have a smaller objective than"
SMALLER_ON_FIELDS = "On test fields, policies of fields by PPO have a smaller objective than"
TOLD_HALF = "Policies by PPO, told price 0.5, have a mean gap that is at least"
# What holds first; what does not hold follows.
FINDINGS = (
    Finding("Policies by PPO, told price 1, end closer to the optimum than SPSFA-TIP.", (TOGETHER,)),
    Finding(
        "Policies by PPO, told price 1, take at most three quarters of the evaluations of SPSFA-TIP.",
        (TOGETHER,),
    ),
    Finding(f"{SMALLER} tuned schedules with as many steps.", (TOGETHER,)),
    Finding(f"{SMALLER} open loops of thirteen knots with as many steps.", (TOGETHER, CASE2, CASE3)),
    Finding(f"{SMALLER} themselves blinded.", (TOGETHER, CASE3)),
    Finding(f"{SMALLER} linear policies by CMA-ES with as many steps.", (TOGETHER,)),
    Finding(f"{SMALLER} policies of the same network by CMA-ES with as many steps.", (TOGETHER,)),
    Finding("On test fields, policies of fields by PPO end closer to the optimum than SPSFA-TIP.", ON_FIELDS),
    Finding(f"{SMALLER_ON_FIELDS} the open loop of fields that they correct.", ON_FIELDS),
    Finding(f"{SMALLER_ON_FIELDS} themselves blinded.", ON_FIELDS),
    Finding("The paper: SPSFA-TIP ends closer to the optimum than FA-100.", (TOGETHER,)),
    Finding(
        f"{TOLD_HALF} 45 % smaller than SPSFA-TIP's in cases 1 and 3.",
        (CASE1, CASE3),
    ),
    Finding(f"{TOLD_HALF} 10 % smaller than SPSFA-TIP's in case 2.", (CASE2,)),
    Finding("Policies by PPO, told price 5, end closer to the optimum than SPSFA-TIP.", (CASE2, CASE3)),
)
# Keys of the groups that the page's table shows.
STRONGEST = (
    "learned:three-cases/*@0.5", "learned:three-cases/*@1", "learned:three-cases-linear/*@1",
    "learned:three-cases-evolution/*@1", "open-loop:three-cases-13-knots/*@1", "tuned:three-cases",
    "open-loop:three-cases-long/*@1", "spsfa-tip", "fixed:100", "learned:three-cases/*@5",
)  # fmt: skip
ON_THE_PAGE = "learned:three-cases/*@1"  # the group whose decisions the page itself shows


def _strongest(results: ResultsFolder) -> str:
    """Return the strongest rows of the headline table."""
    return rows_of(results.table(f"{HEADLINE.name}/headline"), STRONGEST).markdown()


def _decisions(groups: tuple[str, ...], folder: str, results: ResultsFolder) -> str:
    """Return the figures of the decisions of groups."""
    return "\n\n".join(
        figure(folder, HEADLINE.name, decisions_name(group), f"decisions of {group}", results)
        for group in groups
    )


def _parameter(name: str, symbol: str, published: bool, results: ResultsFolder) -> str:
    columns = PARAMETER_COLUMNS if published else PARAMETER_COLUMNS[:-1]
    return whole("parameters", name, results, (symbol, *columns))


def _parameter_figures(results: ResultsFolder) -> str:
    """Return figures 20 to 25 of the SPSFA paper: courses and outcomes by the value of each parameter."""
    return "\n\n".join(
        figure(
            TABLE_FIGURES,
            "parameters",
            f"parameter-{name}-{kind}",
            f"{kind} by {symbol}, figure {number}",
            results,
        )
        for number, (name, symbol, kind) in enumerate(PARAMETER_FIGURES, start=20)
    )


def _origins(results: ResultsFolder) -> str:  # noqa: ARG001
    run = dict.fromkeys((*HEADLINE.controllers, *GENERALISATION.controllers))
    fitted = [name for name in run if ControllerName.parse(name).family in {*FITTED} - {BLINDED}]
    table = origins_table(fitted)
    # The section about the rule tells the origin of rules.
    return replace(table, rows=[row for row in table.rows if row[-2] != MISSING]).markdown()


def _rule(name: str, results: ResultsFolder) -> str:  # noqa: ARG001
    lines = "\n".join(load_rule(name).lines())
    return f"```\n{lines}\n```"


def _tables(suite: str) -> dict[str, Block]:
    """Return the blocks of a suite in the appendix."""
    return {
        f"{suite}-gaps": partial(gaps, suite),
        f"{suite}-differences": partial(whole_by_set, suite, "differences"),
        f"{suite}-near-optimum": partial(whole, suite, "near-optimum"),
        f"{suite}-free-paths": partial(whole, suite, "free-paths"),
        f"{suite}-hypervolume": partial(value_by_set, suite, "hypervolume", FAMILY, "hypervolume"),
    }


BLOCKS: dict[str, Block] = {
    "findings": partial(findings, FINDINGS),
    "strongest": _strongest,
    "headline-front-figure": partial(figure, FIGURES, HEADLINE.name, "front", FRONT_TEXT),
    "headline-profiles": partial(figure, FIGURES, HEADLINE.name, "profiles", PROFILES_TEXT),
    "headline-decisions": partial(_decisions, (ON_THE_PAGE,), FIGURES),
    "generalisation-front-figure": partial(figure, FIGURES, GENERALISATION.name, "front", FRONT_TEXT),
}
BESIDE = (GENERALISATION.name, OUT_OF_DISTRIBUTION.name, SINGLE_CASES.name, ABLATION.name)
WITH_CLAIMS = (HEADLINE.name, GENERALISATION.name, SINGLE_CASES.name, ABLATION.name)
TABLE_BLOCKS: dict[str, Block] = {
    "origins": _origins,
    **{suite: partial(whole, suite, "headline") for suite in (HEADLINE.name, *BESIDE)},
    **{f"{suite}-made-with": partial(made_with, suite) for suite in (HEADLINE.name, *BESIDE, "parameters")},
    **{f"{suite}-claims": partial(whole, suite, "claims") for suite in WITH_CLAIMS},
    "other-decisions": partial(
        _decisions, tuple(group for group in LOOKED_INTO if group != ON_THE_PAGE), TABLE_FIGURES
    ),
    **_tables(HEADLINE.name),
    **_tables(GENERALISATION.name),
    "out-of-distribution-gaps": partial(
        value_by_set, OUT_OF_DISTRIBUTION.name, "gaps", ("controller",), "mean gap"
    ),
    "out-of-distribution-near-optimum": partial(whole, OUT_OF_DISTRIBUTION.name, "near-optimum"),
    "branching": partial(whole, "branching", "branching"),
    "foresight": partial(whole, "branching", "foresight"),
    "sensitivity-decisions": partial(whole, "sensitivity", "sensitivity-decisions"),
    "sensitivity-performance": partial(whole, "sensitivity", "sensitivity-performance"),
    "rule": partial(_rule, "three-cases"),
    "parameters-figures": _parameter_figures,
    "parameters-growth": partial(_parameter, "table-12-parameter-growth", "ω", True),
    "parameters-decay": partial(_parameter, "table-13-parameter-decay", "η", True),
    "parameters-low-deviation": partial(_parameter, "table-parameter-low-deviation", "T_low", False),
}


TABLES = {
    "headline": headline_tables,
    "gaps": gap_tables,
    "differences": difference_tables,
    "duels": paired_comparison_tables,
    "front": front_tables,
    "claims": group_claim_tables,
    "near-optimum": near_optimum_tables,
    "free-paths": free_path_tables,
}
DOCUMENTS = {
    "study": (Document(Path("docs/study.md"), "study", "study", blocks=BLOCKS),),
    "study-tables": (Document(Path("docs/study-tables.md"), "study", "study-tables", blocks=TABLE_BLOCKS),),
}
