"""Documents with marked blocks, whose content is generated from results."""

import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from experiments.tables.document import Document, ResultsFolder
from swarm_gym.files import write_atomically

FIGURES = Path("docs/results")


def replace_block(text: str, name: str, content: str) -> str:
    """Return the text with new content between `<!-- name -->` and `<!-- /name -->`.

    Raises:
        ValueError: if there is no such block.
    """
    block = re.compile(rf"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)", re.DOTALL)
    if not block.search(text):
        raise ValueError(f"there is no block {name!r} to replace")
    return block.sub(lambda match: f"{match[1]}{content.strip()}\n{match[2]}", text)


def content_of(text: str, name: str) -> str:
    """Return what stands between `<!-- name -->` and `<!-- /name -->`.

    Raises:
        ValueError: if there is no such block.
    """
    found = re.search(rf"<!-- {re.escape(name)} -->\n(.*?)<!-- /{re.escape(name)} -->", text, re.DOTALL)
    if not found:
        raise ValueError(f"there is no block {name!r} to read")
    return found[1]


def block_names(text: str) -> list[str]:
    """Return the names of the blocks of a text, by the marks at their ends."""
    return re.findall(r"<!-- /(\S+) -->", text)


@dataclass(frozen=True)
class Filled:
    """A document with its blocks filled, ready to be written.

    Attributes:
        document: document that was filled.
        text: text of the document.
        figures: content of the files that it shows, by their names in its folder of figures.
    """

    document: Document
    text: str
    figures: dict[str, bytes]

    def write(self) -> None:
        """Write figures and document; delete figures that the document shows no more."""
        folder = FIGURES / self.document.figures
        for name, content in self.figures.items():
            write_atomically(folder / name, content)
        write_atomically(self.document.path, self.text)
        if not (self.document.figures or self.figures):
            return  # a document without figures beside one that has some
        for path in folder.glob("*.svg"):
            if path.name not in self.figures:
                path.unlink()


def fill(document: Document, results: Path) -> Filled:
    """Return a document with its blocks filled; nothing is written.

    Raises:
        OSError: if a table or figure is missing, or the document.
        ValueError: if a block is missing or unknown, or a file is not as expected.
    """
    text = document.path.read_text(encoding="utf-8")
    folder = ResultsFolder(results / document.results)
    blocks = document.blocks
    if blocks is None:
        blocks = {name: partial(ResultsFolder.text, name=f"{name}.md") for name in block_names(text)}
        if document.figures:
            for file in sorted(folder.path.rglob("*.svg")):
                folder.show(file.relative_to(folder.path).as_posix())
    unknown = sorted(set(block_names(text)) - set(blocks))
    if unknown:
        raise ValueError(f"{document.path}: nothing is known of the blocks {', '.join(unknown)}")
    for name, make in blocks.items():
        text = replace_block(text, name, make(folder))
    return Filled(document, text, folder.shown)
