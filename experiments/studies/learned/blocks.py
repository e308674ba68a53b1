"""The marked blocks of docs/study.md, as data: each shows a table or a figure of the study's suites.

To add one, write the pair of marks into the document and a line into `BLOCKS`.
"""

from dataclasses import replace
from functools import partial

from experiments.runs.groups import group_controllers
from experiments.studies.learned.origins import origins_table
from experiments.studies.learned.suites import (
    ABLATED,
    ABLATION,
    FITTED_TO_CASES,
    FITTED_TO_FIELDS,
    LOOKED_INTO,
)
from experiments.tables.blocks import (
    decisions_name,
    figure,
    gaps,
    made_with,
    value_by_set,
    whole,
    whole_by_set,
)
from experiments.tables.cell import MISSING
from experiments.tables.document import Block, ResultsFolder
from swarm_gym.controllers.distilled import load_rule

FIGURES = "results/study"  # seen from the document

PARAMETER_COLUMNS = (
    "mean fitness", "std", "feasible", "mean evaluations", "evaluations ratio", "95 % interval of the ratio",
    "seconds ratio", "paper ratio",
)  # fmt: skip


def _decisions(suite: str, controllers: tuple[str, ...], results: ResultsFolder) -> str:
    """Return the figures of the decisions of these controllers."""
    return "\n\n".join(
        figure(FIGURES, suite, decisions_name(group), f"decisions of {group}", results)
        for group in group_controllers(controllers)
    )


def _parameter(name: str, symbol: str, published: bool, results: ResultsFolder) -> str:
    columns = PARAMETER_COLUMNS if published else PARAMETER_COLUMNS[:-1]
    return whole("parameters", name, results, (symbol, *columns))


def _origins(results: ResultsFolder) -> str:  # noqa: ARG001
    fitted = [*FITTED_TO_CASES.everything, *FITTED_TO_FIELDS.everything]
    fitted += [controller for family in ABLATED for controller in family.controllers]
    table = origins_table(tuple(dict.fromkeys(fitted)))
    # The section about distillation tells the origin of rules.
    return replace(table, rows=[row for row in table.rows if row[-2] != MISSING]).markdown()


def _rule(name: str, results: ResultsFolder) -> str:  # noqa: ARG001
    lines = "\n".join(load_rule(name).lines())
    return f"```\n{lines}\n```"


def _suite_blocks(suite: str, several_sets: bool) -> dict[str, Block]:
    """Return the blocks that every suite with gaps has."""
    whole = {
        f"{suite}-gaps": partial(gaps, suite),
        f"{suite}-differences": partial(whole_by_set, suite, "differences"),
        f"{suite}-duels": partial(whole_by_set, suite, "duels"),
    }
    by_value = {
        f"{suite}-gaps": partial(value_by_set, suite, "gaps", ("controller",), "mean gap"),
        f"{suite}-evaluations": partial(value_by_set, suite, "gaps", ("controller",), "mean evaluations"),
        f"{suite}-differences": partial(value_by_set, suite, "differences", ("controller",), "difference"),
        f"{suite}-p": partial(value_by_set, suite, "differences", ("controller",), "p"),
    }
    return {f"{suite}-made-with": partial(made_with, suite), **(by_value if several_sets else whole)}


FRONT_TEXT = "mean gap against mean evaluations of every controller"
PROFILES_TEXT = "share of runs within a gap, by the gap"
FAMILY = ("family", "controllers")

BLOCKS: dict[str, Block] = {
    "origins": _origins,
    **_suite_blocks("headline", several_sets=False),
    "headline-near-optimum": partial(whole, "headline", "near-optimum"),
    "headline-profiles": partial(figure, FIGURES, "headline", "profiles", PROFILES_TEXT),
    "headline-front-figure": partial(figure, FIGURES, "headline", "front", FRONT_TEXT),
    "headline-hypervolume": partial(value_by_set, "headline", "hypervolume", FAMILY, "hypervolume"),
    "headline-decisions": partial(_decisions, "headline", LOOKED_INTO),
    **_suite_blocks("generalisation", several_sets=False),
    "generalisation-near-optimum": partial(whole, "generalisation", "near-optimum"),
    "generalisation-hypervolume": partial(
        value_by_set, "generalisation", "hypervolume", FAMILY, "hypervolume"
    ),
    "generalisation-front-figure": partial(figure, FIGURES, "generalisation", "front", FRONT_TEXT),
    "generalisation-profiles": partial(figure, FIGURES, "generalisation", "profiles", PROFILES_TEXT),
    **_suite_blocks("out-of-distribution", several_sets=True),
    "out-of-distribution-near-optimum": partial(whole, "out-of-distribution", "near-optimum"),
    "out-of-distribution-front-figure": partial(figure, FIGURES, "out-of-distribution", "front", FRONT_TEXT),
    **_suite_blocks(ABLATION.name, several_sets=True),
    "branching": partial(whole, "branching", "branching"),
    "foresight": partial(whole, "branching", "foresight"),
    "sensitivity-decisions": partial(whole, "sensitivity", "sensitivity-decisions"),
    "sensitivity-performance": partial(whole, "sensitivity", "sensitivity-performance"),
    "sensitivity-figure": partial(figure, FIGURES, "sensitivity", "sensitivity", "what each input is worth"),
    "rule": partial(_rule, "three-cases"),
    "parameters-made-with": partial(made_with, "parameters"),
    "parameters-growth": partial(_parameter, "table-12-parameter-growth", "ω", True),
    "parameters-decay": partial(_parameter, "table-13-parameter-decay", "η", True),
    "parameters-low-deviation": partial(_parameter, "table-parameter-low-deviation", "T_low", False),
}
