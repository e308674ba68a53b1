"""A table as Markdown, CSV and LaTeX, and how its cells are written."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from swarm_gym.files import write_atomically


@dataclass(frozen=True)
class Table:
    """A table: file name, caption, column heads and cells, already formatted."""

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def markdown(self) -> str:
        """GitHub's Markdown, with the caption above."""
        lines = [self.columns, tuple("---" for _ in self.columns), *self.rows]
        body = "\n".join("| " + " | ".join(line) + " |" for line in lines)
        return f"**{self.caption}**\n\n{body}\n"

    @classmethod
    def from_markdown(cls, name: str, text: str) -> "Table":
        """What `markdown` wrote.

        Raises:
            ValueError: if it is something else.
        """
        caption, *body = text.strip().split("\n")
        rows = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in body[1:]]
        if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows) or set(rows[1]) != {"---"}:
            raise ValueError(f"table {name!r} is not as it was written")
        return cls(name, caption.removeprefix("**").removesuffix("**"), rows[0], rows[2:])

    def write(self, folder: Path) -> None:
        """Write <name>.md, <name>.csv and <name>.tex."""
        for suffix, text in (("md", self.markdown()), ("csv", self.csv()), ("tex", self.latex())):
            write_atomically(folder / f"{self.name}.{suffix}", text)

    def csv(self) -> str:
        """Comma-separated values with a head line."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([self.columns, *self.rows])
        return text.getvalue()

    def latex(self) -> str:
        """A `table` environment with booktabs rules."""
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


def percent(value: float, form: str = ".1f") -> str:
    """A share as a percentage, in a format for numbers; a dash where there is none."""
    return "–" if np.isnan(value) else f"{100 * value:{form}} %"


def percent_interval(ends: tuple[float, float], form: str = ".1f") -> str:
    """Two shares in per cent, in brackets."""
    return f"[{100 * ends[0]:{form}}, {100 * ends[1]:{form}}]"


def _escape(text: str) -> str:
    text = text.replace("**", "").replace("–", "--")
    for character in "&%$#_":
        text = text.replace(character, "\\" + character)
    return text
