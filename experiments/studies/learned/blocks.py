"""The marked blocks of docs/study.md, as data: each shows a table or a figure of the study's suites.

To add one, write the pair of marks into the document and a line into `BLOCKS`.
"""

import re
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
from experiments.tables.cell import MISSING
from experiments.tables.document import MADE_WITH, Block, ResultsFolder
from experiments.tables.reshape import join, select, shorten_heads, split, spread
from experiments.tables.table import Table
from swarm_gym.controllers.distilled import load_rule

FIGURES = "results/study"  # seen from the document

GAP_COLUMNS = (
    "scenarios", "controller", "mean gap", "inter-quartile mean", "median", "max", "std",
    "feasible", "mean evaluations", "mean seconds",
)  # fmt: skip
PARAMETER_COLUMNS = (
    "mean fitness", "std", "feasible", "mean evaluations", "evaluations ratio", "95 % interval of the ratio",
    "seconds ratio", "paper ratio",
)  # fmt: skip


def decisions_name(group: str) -> str:
    """Return the name of the figure of a group's decisions, by the key of the group."""
    return f"decisions-{re.sub(r'[^a-z0-9]+', '-', group.lower().replace('/*', '-seeds')).strip('-')}"


def _made_with(suite: str, results: ResultsFolder) -> str:
    return results.text(f"{suite}/{MADE_WITH}")


def _figure(suite: str, name: str, text: str, results: ResultsFolder) -> str:
    """Return a figure of a suite as Markdown, with a text in its place."""
    file = f"{name}.svg" if name == suite else f"{suite}-{name}.svg"
    results.show(f"{suite}/figure-{name}.svg", file)
    return f"![{text}]({FIGURES}/{file})"


def _whole(suite: str, name: str, results: ResultsFolder, columns: tuple[str, ...] = ()) -> str:
    """Return a table with its caption, or some of its columns."""
    table = results.table(f"{suite}/{name}")
    return shorten_heads(select(table, columns or table.columns)).markdown()


def _by_set(table: Table) -> str:
    """Return a table for each set of scenarios, headed by the set."""
    return "\n".join(
        replace(part, caption=scenario_set).markdown() for scenario_set, part in split(table).items()
    )


def _gaps(suite: str, results: ResultsFolder) -> str:
    """Return quality, cost, and which controllers are on the front of both."""
    gaps = select(results.table(f"{suite}/gaps"), GAP_COLUMNS)
    front = results.table(f"{suite}/front")
    return _by_set(join(gaps, front, ("scenarios", "controller"), "on the front"))


def _whole_by_set(suite: str, name: str, results: ResultsFolder) -> str:
    return _by_set(results.table(f"{suite}/{name}"))


def _spread(suite: str, name: str, keys: tuple[str, ...], value: str, results: ResultsFolder) -> str:
    """Return one value of a table, with a column for each set of scenarios."""
    caption = value if value == "p" else value.capitalize()
    return replace(spread(results.table(f"{suite}/{name}"), keys, value), caption=caption).markdown()


def _decisions(suite: str, controllers: tuple[str, ...], results: ResultsFolder) -> str:
    """Return the figures of the decisions of these controllers."""
    return "\n\n".join(
        _figure(suite, decisions_name(group), f"decisions of {group}", results)
        for group in group_controllers(controllers)
    )


def _parameter(name: str, symbol: str, published: bool, results: ResultsFolder) -> str:
    columns = PARAMETER_COLUMNS if published else PARAMETER_COLUMNS[:-1]
    return _whole("parameters", name, results, (symbol, *columns))


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
        f"{suite}-gaps": partial(_gaps, suite),
        f"{suite}-differences": partial(_whole_by_set, suite, "differences"),
        f"{suite}-duels": partial(_whole_by_set, suite, "duels"),
    }
    by_value = {
        f"{suite}-gaps": partial(_spread, suite, "gaps", ("controller",), "mean gap"),
        f"{suite}-evaluations": partial(_spread, suite, "gaps", ("controller",), "mean evaluations"),
        f"{suite}-differences": partial(_spread, suite, "differences", ("controller",), "difference"),
        f"{suite}-p": partial(_spread, suite, "differences", ("controller",), "p"),
    }
    return {f"{suite}-made-with": partial(_made_with, suite), **(by_value if several_sets else whole)}


FRONT_TEXT = "mean gap against mean evaluations of every controller"
PROFILES_TEXT = "share of runs within a gap, by the gap"
FAMILY = ("family", "controllers")

BLOCKS: dict[str, Block] = {
    "origins": _origins,
    **_suite_blocks("headline", several_sets=False),
    "headline-near-optimum": partial(_whole, "headline", "near-optimum"),
    "headline-profiles": partial(_figure, "headline", "profiles", PROFILES_TEXT),
    "headline-front-figure": partial(_figure, "headline", "front", FRONT_TEXT),
    "headline-hypervolume": partial(_spread, "headline", "hypervolume", FAMILY, "hypervolume"),
    "headline-decisions": partial(_decisions, "headline", LOOKED_INTO),
    **_suite_blocks("generalisation", several_sets=False),
    "generalisation-near-optimum": partial(_whole, "generalisation", "near-optimum"),
    "generalisation-hypervolume": partial(_spread, "generalisation", "hypervolume", FAMILY, "hypervolume"),
    "generalisation-front-figure": partial(_figure, "generalisation", "front", FRONT_TEXT),
    "generalisation-profiles": partial(_figure, "generalisation", "profiles", PROFILES_TEXT),
    **_suite_blocks("out-of-distribution", several_sets=True),
    "out-of-distribution-near-optimum": partial(_whole, "out-of-distribution", "near-optimum"),
    "out-of-distribution-front-figure": partial(_figure, "out-of-distribution", "front", FRONT_TEXT),
    **_suite_blocks(ABLATION.name, several_sets=True),
    "branching": partial(_whole, "branching", "branching"),
    "foresight": partial(_whole, "branching", "foresight"),
    "sensitivity-decisions": partial(_whole, "sensitivity", "sensitivity-decisions"),
    "sensitivity-performance": partial(_whole, "sensitivity", "sensitivity-performance"),
    "sensitivity-figure": partial(_figure, "sensitivity", "sensitivity", "what each input is worth"),
    "rule": partial(_rule, "three-cases"),
    "parameters-made-with": partial(_made_with, "parameters"),
    "parameters-growth": partial(_parameter, "table-12-parameter-growth", "ω", True),
    "parameters-decay": partial(_parameter, "table-13-parameter-decay", "η", True),
    "parameters-low-deviation": partial(_parameter, "table-parameter-low-deviation", "T_low", False),
}
