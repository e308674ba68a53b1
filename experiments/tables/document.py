"""Documents whose marked blocks show results, as data, and the folders of results that they are made from."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from experiments.tables.table import Table

MADE_WITH = "made-with.md"  # in a folder of results: versions and commit that made the runs


class ResultsFolder:
    """A folder with the results of one or several suites, which keeps account of the files that are shown.

    Args:
        path: the folder.

    Attributes:
        path: the folder.
        shown: content of the files that a document shows, by the names that it shows them under.
    """

    def __init__(self, path: Path):
        self.path = path
        self.shown: dict[str, bytes] = {}

    def text(self, name: str) -> str:
        """Return the text of a file, by its path below the folder."""
        return (self.path / name).read_text(encoding="utf-8")

    def table(self, name: str) -> Table:
        """Return a table, by its path below the folder without a suffix."""
        return Table.read(self.path / f"{name}.json")

    def show(self, name: str, shown_as: str = "") -> None:
        """Take account of a file that a document shows, under another name if one is given."""
        file = self.path / name
        self.shown[shown_as or file.name] = file.read_bytes()


Block = Callable[[ResultsFolder], str]  # returns the content of a marked block


@dataclass(frozen=True)
class Document:
    """A document whose marked blocks are filled from a folder of results.

    Attributes:
        path: the document, such as docs/moa-paper.md.
        results: folder of results, below the folder that all results are in.
        figures: folder of the figures that the document shows, below docs/results.
        suite: suite or collection whose runs the document shows; empty if other commands make its results.
        blocks: maker of each block by the name in its marks. None: each block shows the table of its name,
            and all figures of the folder are shown if it has a folder of figures.
    """

    path: Path
    results: str
    figures: str
    suite: str = ""
    blocks: Mapping[str, Block] | None = None


def document_of_suite(path: str, suite: str) -> Document:
    """Return a document whose blocks show the tables of a suite, or of a collection, by their names."""
    return Document(Path(path), f"docs/{suite}", suite, suite)
