"""Makers of the marked blocks of documents that show tables and figures of several suites."""

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from experiments.runs.labels import label
from experiments.tables.cell import verdict
from experiments.tables.document import MADE_WITH, Block, ResultsFolder
from experiments.tables.reshape import join, keep_rows, pick, select, shorten_heads, split, spread
from experiments.tables.table import Table, list_item

GAP_COLUMNS = (
    "scenarios", "controller", "mean gap", "inter-quartile mean", "median", "max", "std",
    "feasible", "mean evaluations", "mean seconds",
)  # fmt: skip
CLAIM_COLUMNS = ("measure", "controller", "rival or limit", "difference", "holds")


@dataclass(frozen=True)
class Finding:
    """A claim that a page lists among its findings.

    Attributes:
        sentence: sentence of the claim, as in the claims file of its study.
        rows: rows of the claims tables that the page shows: the suite, the set of scenarios, and the name of
            that set on the page.
    """

    sentence: str
    rows: tuple[tuple[str, str, str], ...]


def texts(names: Iterable[str], folder: str = "") -> dict[str, Block]:
    """Return makers of blocks that show whole tables.

    Args:
        names: names of the tables, which are those of the blocks.
        folder: folder of the tables below the results of the document, with a slash behind it.
    """
    return {name: partial(ResultsFolder.text, name=f"{folder}{name}.md") for name in names}


def shortened(
    name: str,
    rows: Collection[str],
    results: ResultsFolder,
    columns: tuple[str, ...] = (),
    left_out: str = "",
) -> str:
    """Return some rows of a table, in the order of the table.

    Args:
        name: path of the table below the folder.
        rows: first entries of the rows.
        results: folder of results.
        columns: heads of the columns; by default all.
        left_out: end of the caption, about rows or columns that are not shown.

    Raises:
        ValueError: if the table lacks a row or a column, or its caption ends otherwise.
    """
    table = keep_rows(results.table(name), rows)
    if not table.caption.endswith(left_out):
        raise ValueError(f"table {table.name!r}: expected a caption that ends in {left_out!r}")
    table = replace(table, caption=table.caption.removesuffix(left_out))
    return select(table, columns or table.columns).markdown()


def findings(chosen: Sequence[Finding], results: ResultsFolder) -> str:
    """Return claims as a list: each sentence, and whether it holds, with its numbers.

    Raises:
        ValueError: if a table of claims lacks one of the rows.
    """
    return "\n".join(_listed(finding, results) for finding in chosen)


def _listed(finding: Finding, results: ResultsFolder) -> str:
    parts = [finding.sentence]
    for suite, scenario_set, name in finding.rows:
        table = results.table(f"{suite}/claims")
        found = pick(table, ("claim", "scenarios"), [(finding.sentence, scenario_set)])
        ((measure, mine, theirs, difference, holds),) = select(found, CLAIM_COLUMNS).rows
        held = "holds" if str(holds) == verdict(True) else "does **not** hold"
        parts.append(f"{name}: {held}, {mine} against {theirs}, difference {difference} ({measure}).")
    return list_item(" ".join(parts))


def rows_of(table: Table, groups: Sequence[str], scenario_set: str = "") -> Table:
    """Return the rows of some groups of controllers, by the keys of the groups and in their order.

    Args:
        table: table with a column `controller`.
        groups: keys of the groups.
        scenario_set: set of scenarios, if the table has rows for several.
    """
    if not scenario_set:
        return pick(table, ("controller",), [(label(group),) for group in groups])
    return pick(table, ("scenarios", "controller"), [(scenario_set, label(group)) for group in groups])


def decisions_name(group: str) -> str:
    """Return the name of the figure of a group's decisions, by the key of the group."""
    return f"decisions-{re.sub(r'[^a-z0-9]+', '-', group.lower().replace('/*', '-seeds')).strip('-')}"


def made_with(suite: str, results: ResultsFolder) -> str:
    """Return the line with seeds, versions and commit of a suite's runs."""
    return results.text(f"{suite}/{MADE_WITH}")


def figure(folder: str, suite: str, name: str, text: str, results: ResultsFolder) -> str:
    """Return a figure of a suite as Markdown.

    Args:
        folder: folder of the document's figures, seen from the document.
        suite: name of the suite.
        name: name of the figure.
        text: text that stands for the figure where it cannot be shown.
        results: results of several suites.
    """
    file = f"{name}.svg" if name == suite else f"{suite}-{name}.svg"
    results.show(f"{suite}/figure-{name}.svg", file)
    return f"![{text}]({folder}/{file})"


def whole(suite: str, name: str, results: ResultsFolder, columns: tuple[str, ...] = ()) -> str:
    """Return a table with its caption, or some of its columns."""
    table = results.table(f"{suite}/{name}")
    return shorten_heads(select(table, columns or table.columns)).markdown()


def by_set(table: Table) -> str:
    """Return a table for each set of scenarios, headed by the set."""
    return "\n".join(
        replace(part, caption=scenario_set).markdown() for scenario_set, part in split(table).items()
    )


def whole_by_set(suite: str, name: str, results: ResultsFolder, columns: tuple[str, ...] = ()) -> str:
    """Return a table, or some of its columns, as one table for each set of scenarios."""
    table = results.table(f"{suite}/{name}")
    return by_set(select(table, columns or table.columns))


def gaps(suite: str, results: ResultsFolder, columns: tuple[str, ...] = GAP_COLUMNS) -> str:
    """Return quality, cost, and which controllers are on the front of both."""
    found = select(results.table(f"{suite}/gaps"), columns)
    front = results.table(f"{suite}/front")
    return by_set(join(found, front, ("scenarios", "controller"), "on the front"))


def value_by_set(suite: str, name: str, keys: tuple[str, ...], value: str, results: ResultsFolder) -> str:
    """Return one value of a table, with a column for each set of scenarios."""
    caption = value if value == "p" else value.capitalize()
    return replace(spread(results.table(f"{suite}/{name}"), keys, value), caption=caption).markdown()
