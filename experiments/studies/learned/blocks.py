"""What the marked blocks of docs/study.md show, as data: tables and figures of the suites.

To add one, write the pair of marks into the document and a line into `BLOCKS`.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from experiments.catalogue import ABLATED, ABLATION, FITTED_TO_CASES, FITTED_TO_FIELDS, LOOKED_INTO
from experiments.documents.figures import decisions_name
from experiments.documents.page import MADE_WITH
from experiments.runs.groups import group_controllers
from experiments.studies.learned.origins import origins_table
from experiments.tables.reshape import NOTHING, join, select, shorten_heads, split, spread
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


class Source:
    """The folder that the suites wrote to, and the figures that were asked for.

    Attributes:
        figures: content of the figures, by the names that the document shows them under.
    """

    def __init__(self, folder: Path):
        self.folder = folder
        self.figures: dict[str, bytes] = {}

    def text(self, suite: str, name: str) -> str:
        """A file of a suite."""
        return (self.folder / suite / name).read_text(encoding="utf-8")

    def table(self, suite: str, name: str) -> Table:
        """A table of a suite."""
        return Table.from_markdown(f"{suite}/{name}", self.text(suite, f"{name}.md"))

    def figure(self, suite: str, name: str, text: str) -> str:
        """A figure of a suite as Markdown, with a text in its place."""
        file = f"{name}.svg" if name == suite else f"{suite}-{name}.svg"
        self.figures[file] = (self.folder / suite / f"figure-{name}.svg").read_bytes()
        return f"![{text}]({FIGURES}/{file})"


Block = Callable[[Source], str]


def _made_with(suite: str, source: Source) -> str:
    return source.text(suite, MADE_WITH)


def _figure(suite: str, name: str, text: str, source: Source) -> str:
    return source.figure(suite, name, text)


def _whole(suite: str, name: str, source: Source, columns: tuple[str, ...] = ()) -> str:
    """A table with its caption, or some of its columns."""
    table = source.table(suite, name)
    return shorten_heads(select(table, columns or table.columns)).markdown()


def _by_set(table: Table) -> str:
    """A table for each set of scenarios, headed by the set."""
    return "\n".join(
        Table(table.name, scenario_set, part.columns, part.rows).markdown()
        for scenario_set, part in split(table).items()
    )


def _gaps(suite: str, source: Source) -> str:
    """Quality, cost, and which controllers are on the front of both."""
    gaps = select(source.table(suite, "gaps"), GAP_COLUMNS)
    return _by_set(join(gaps, source.table(suite, "front"), ("scenarios", "controller"), "on the front"))


def _whole_by_set(suite: str, name: str, source: Source) -> str:
    return _by_set(source.table(suite, name))


def _spread(suite: str, name: str, keys: tuple[str, ...], value: str, source: Source) -> str:
    """One value of a table, with a column for each set of scenarios."""
    table = spread(source.table(suite, name), keys, value)
    caption = value if value == "p" else value.capitalize()
    return Table(name, caption, table.columns, table.rows).markdown()


def _decisions(suite: str, controllers: tuple[str, ...], source: Source) -> str:
    """Figures of the decisions of these."""
    return "\n\n".join(
        source.figure(suite, decisions_name(group), f"decisions of {group}")
        for group in group_controllers(controllers)
    )


def _parameter(name: str, symbol: str, printed: bool, source: Source) -> str:
    columns = PARAMETER_COLUMNS if printed else PARAMETER_COLUMNS[:-1]
    return _whole("parameters", name, source, (symbol, *columns))


def _origins(source: Source) -> str:  # noqa: ARG001
    fitted = [*FITTED_TO_CASES.everything, *FITTED_TO_FIELDS.everything]
    fitted += [controller for family in ABLATED for controller in family.controllers]
    table = origins_table(tuple(dict.fromkeys(fitted)))
    rows = [row for row in table.rows if row[-2] != NOTHING]  # of rules, "understanding" says it
    return Table(table.name, table.caption, table.columns, rows).markdown()


def _rule(name: str, source: Source) -> str:  # noqa: ARG001
    lines = "\n".join(load_rule(name).lines())
    return f"```\n{lines}\n```"


def _suite_blocks(suite: str, several_sets: bool) -> dict[str, Block]:
    """What every suite with gaps has."""
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
