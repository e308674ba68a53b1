"""The parts of a report, and its HTML, which needs no other file and no network."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

import swarm_gym
from experiments.playground.playground_page import Playground, json_for_html, templates
from experiments.report.drawn import DrawnFigure
from experiments.tables.cell import Cell, Entry
from experiments.tables.table import Table, text_columns

ASSETS = Path(__file__).parent / "assets"
TEMPLATE = "report.html.jinja"
SCRIPTS = ("tables.js", "theme.js", "replay.js", "player.js")
# The player's legend: CSS class, meaning, marks drawn across the line, and whether it may be a dot instead.
KEY = (
    ("feasible", "feasible", "", True),
    ("colliding", "colliding", "", True),
    ("new", "new in this step", "M21 1V13", False),
    ("removed", "removed in this step", "M15 1L27 13M27 1L15 13", False),
    ("best", "best so far", "", False),
    ("shortest", "shortest path", "", False),
)


@dataclass(frozen=True)
class Section:
    """A section of a report: a heading, tables and figures."""

    identifier: str
    title: str
    tables: Sequence[Table] = ()
    figures: Sequence[DrawnFigure] = ()


@dataclass(frozen=True)
class Report:
    """The content of a report.

    Attributes:
        title: heading of the report.
        lead: first sentence, below the heading.
        notices: sentences about missing or different results.
        sections: sections in their order; replays follow the first one.
        replays: maps and replays packed by `replay.pack`, by scenario and seed.
        playground: playground on the suite's maps; None if its port cannot run on them.
        runs: table of all runs; None if there are too many.
        facts: names and values of facts about the runs.
        commands: commands that make the runs and the report again.
        configuration: configuration of the runs, as the database has it.
    """

    title: str
    lead: str
    notices: Sequence[str] = ()
    sections: Sequence[Section] = ()
    replays: Sequence[dict[str, Any]] = ()
    playground: Playground | None = None
    runs: Table | None = None
    facts: Sequence[tuple[str, str]] = ()
    commands: Sequence[str] = ()
    configuration: dict[str, Any] = field(default_factory=dict)


def to_html(report: Report) -> str:
    """Return the HTML of a report."""
    environment = templates(ASSETS)
    environment.filters.update(emphasised=_emphasised, sorted_by=_sorted_by, text_columns=text_columns)
    assets = {name: (ASSETS / name).read_text(encoding="utf-8") for name in ("report.css", *SCRIPTS)}
    parts = {
        **vars(report),
        "replays": json_for_html(report.replays) if report.replays else "",
        "configuration": json.dumps(report.configuration, indent=1) if report.configuration else "",
    }
    return environment.get_template(TEMPLATE).render(
        parts,
        key=KEY,
        version=swarm_gym.__version__,
        css=Markup(assets["report.css"]),
        scripts=[assets[name] for name in SCRIPTS],
    )


def _sorted_by(entry: Entry) -> Markup:
    """Return the attribute with the number that a cell is sorted by; nothing if it has no number."""
    if not isinstance(entry, Cell):
        return Markup("")
    first = next(iter(entry.numbers.values()))
    return Markup(f' data-value="{repr(first).replace("inf", "Infinity")}"')


def _emphasised(text: Entry) -> Markup:
    """Return a text as HTML, with parts between pairs of asterisks in bold, as in Markdown."""
    return Markup(re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", str(escape(str(text)))))
