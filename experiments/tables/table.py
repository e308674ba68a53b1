"""A results table: cells with numbers, and its renderings as Markdown, LaTeX, CSV and JSON."""

import csv
import io
import json
import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from experiments.tables.cell import MISSING, Cell, Entry, plain_text
from swarm_gym.files import write_atomically

LINE = 100  # characters of a line of a caption

Row = Mapping[str, Entry]  # the entries of a row by the heads of their columns


@dataclass(frozen=True)
class Table:
    """A results table.

    Attributes:
        name: name of its files, without a suffix.
        caption: text above the table.
        columns: heads of the columns.
        rows: entries of every row, one per column: cells with numbers, or text.
        scenario: name of the scenario that the table is about, if its suite has such a table for each of its
            scenarios; None for a table about all of them.
    """

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: Sequence[tuple[Entry, ...]]
    scenario: str | None = None

    @classmethod
    def of(cls, name: str, caption: str, rows: Iterable[Row], scenario: str | None = None) -> "Table":
        """Return a table whose rows state their entries by the heads of the columns; there is at least one.

        Raises:
            ValueError: if there is no row, or if two rows have other heads.
        """
        first, *others = listed = [*rows]
        if any(tuple(row) != tuple(first) for row in others):
            raise ValueError(f"table {name!r}: expected the columns {', '.join(first)} in every row")
        return cls(name, caption, tuple(first), [tuple(row.values()) for row in listed], scenario)

    @classmethod
    def if_any(cls, name: str, caption: str, rows: Sequence[Row]) -> list["Table"]:
        """Return a list with the table of these rows; an empty one if there is no row."""
        return [cls.of(name, caption, rows)] if rows else []

    def write(self, folder: Path) -> None:
        """Write <name>.md, <name>.tex, <name>.csv and <name>.json."""
        for suffix, text in (
            ("md", self.markdown()),
            ("tex", self.latex()),
            ("csv", self.csv()),
            ("json", self.json()),
        ):
            write_atomically(folder / f"{self.name}.{suffix}", text)

    @classmethod
    def read(cls, path: Path) -> "Table":
        """Return the table of a JSON file that `write` made.

        Raises:
            OSError: if the file cannot be read.
            ValueError: if it is not a table.
        """
        text = path.read_text(encoding="utf-8")
        try:
            stored = json.loads(text)
            rows = [tuple(map(_entry, row)) for row in stored["rows"]]
            table = cls(stored["name"], stored["caption"], tuple(stored["columns"]), rows, stored["scenario"])
        except (ValueError, LookupError, TypeError, AttributeError) as error:
            raise ValueError(f"{path} is not a table as `Table.write` stores it: {error}") from error
        if any(len(row) != len(table.columns) for row in rows):
            raise ValueError(f"{path} is not a table: a row does not have {len(table.columns)} entries")
        return table

    def markdown(self) -> str:
        """Return the table in GitHub's Markdown, with the caption above."""
        lines = [self.columns, tuple("---" for _ in self.columns), *self.rows]
        body = "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)
        return f"{wrapped(f'**{self.caption}**')}\n\n{body}\n"

    def latex(self) -> str:
        """Return a `table` environment with booktabs rules."""
        lines = [" & ".join(map(_escape, line)) + r" \\" for line in (self.columns, *self.rows)]
        return "\n".join(
            [
                r"\begin{table}",
                r"\centering",
                rf"\caption{{{_escape(self.caption)}}}",
                rf"\begin{{tabular}}{{l{'r' * (len(self.columns) - 1)}}}",
                r"\toprule",
                lines[0],
                r"\midrule",
                *lines[1:],
                r"\bottomrule",
                r"\end{tabular}",
                r"\end{table}",
                "",
            ]
        )

    def csv(self) -> str:
        """Return comma-separated values with a head line: one column per number, in full precision.

        The number `value` of a column has the head of the column, any other its name behind that, such as
        "mean gap low". Shares are numbers from 0 to 1; what is missing is empty.
        """
        heads: list[str] = []
        columns: list[list[str]] = []
        for place, head in enumerate(self.columns):
            entries = [row[place] for row in self.rows]
            names = list(dict.fromkeys(name for e in entries if isinstance(e, Cell) for name in e.numbers))
            for name in names or ["value"]:
                heads.append(_unused(head if name == "value" else f"{head} {name}", heads))
                columns.append([_plain_value(entry, name) for entry in entries])
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([heads, *zip(*columns, strict=True)])
        return text.getvalue()

    def json(self) -> str:
        """Return the table as JSON that `read` takes, a row a line."""
        rows = ",\n".join(
            json.dumps([_stored(entry) for entry in row], ensure_ascii=False) for row in self.rows
        )
        facts = {name: getattr(self, name) for name in ("name", "caption", "scenario", "columns")}
        return f'{json.dumps(facts, ensure_ascii=False)[:-1]}, "rows": [\n{rows}\n]}}\n'


def write_tables_page(
    folder: Path, title: str, tables: Sequence[Table], above: Sequence[str] = (), below: Sequence[str] = ()
) -> Path:
    """Write tables to files of their own, and a README.md that shows all of them; return the latter.

    Args:
        folder: folder of the files, made if missing.
        title: heading of the page.
        tables: the tables.
        above: paragraphs between the heading and the tables, each with a line break at its end.
        below: paragraphs after the tables.
    """
    for table in tables:
        table.write(folder)
    parts = [f"# {title}\n", *above, *(table.markdown() for table in tables), *below]
    return write_atomically(folder / "README.md", "\n".join(parts))


def wrapped(text: str, line: int = LINE) -> str:
    """Return a paragraph of Markdown in lines of at most so many characters."""
    return textwrap.fill(text, line, break_long_words=False, break_on_hyphens=False)


def list_item(text: str) -> str:
    """Return an item of a list of Markdown in lines of at most `LINE` characters."""
    return textwrap.indent(wrapped(text, LINE - 2), "  ").replace("  ", "* ", 1)


def text_columns(table: Table) -> list[bool]:
    """Return for every column whether it holds no numbers."""
    return [
        not any(isinstance(row[place], Cell) for row in table.rows) for place in range(len(table.columns))
    ]


def _plain_value(entry: Entry, name: str) -> str:
    """Return what CSV has of an entry: a number of a cell, or a text in place of the number `value`."""
    if isinstance(entry, Cell):
        return repr(entry.numbers[name]) if name in entry.numbers else ""
    return plain_text(entry) if name == "value" and entry != MISSING else ""


def _unused(head: str, heads: Iterable[str]) -> str:
    """Return the head, or with a number behind it if there is such a head already."""
    if head not in heads:
        return head
    return next(other for k in count(2) if (other := f"{head} ({k})") not in heads)


def _stored(entry: Entry) -> Any:
    """Return an entry as JSON has it; numbers that are not finite are strings there."""
    if not isinstance(entry, Cell):
        return entry
    numbers = {name: v if math.isfinite(v) else repr(v) for name, v in entry.numbers.items()}
    return {"template": entry.template, "numbers": numbers}


def _entry(stored: Any) -> Entry:
    if isinstance(stored, str):
        return stored
    numbers = {name: float(v) if isinstance(v, str) else v for name, v in stored["numbers"].items()}
    return Cell(stored["template"], numbers)


def _escape(entry: Entry) -> str:
    text = plain_text(entry).replace(MISSING, "--")
    for character in "&%$#_":
        text = text.replace(character, "\\" + character)
    return text
