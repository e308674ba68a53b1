"""Markup of the site: docstrings for Sphinx, and attributes for keyboards and screen readers.

Sphinx reads docstrings as reStructuredText. Those of this project have inline code in single backticks,
tables with bars and indented examples, which mean something else there.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

_CODE = re.compile(r"(?<![`:\w])`([^`\n]+)`(?![`_])")
_NAME = re.compile(r"(?:swarm_gym|agents|experiments)(?:\.\w+)+")
_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns|Yields):$")
_ITEM = re.compile(r"^ *([*-]|\d+\.) ")


def to_restructured_text(lines: list[str]) -> list[str]:
    """Return the lines of a docstring as reStructuredText, for the extension napoleon.

    Inline code becomes a literal, or a reference if it is a full name of this project. Tables become
    `list-table` directives, and indented paragraphs outside of sections and lists become code blocks.
    """
    out: list[str] = []
    in_section, previous = False, ""
    blocks = _blocks([line.replace("\t", "    ") for line in lines])
    for block in blocks:
        first = block[0]
        if not first.startswith(" "):
            in_section = bool(_SECTION.match(first))
        if first.lstrip().startswith("|"):
            out += _table(block)
        elif first.startswith("    ") and not in_section and not _ITEM.match(previous):
            out += [".. code-block:: python", "", *block]
        else:
            out += [_inline(line) for line in block]
        out.append("")
        previous = first
    return out


def _blocks(lines: list[str]) -> Iterator[list[str]]:
    """Yield the paragraphs, tables and examples of a docstring, without the empty lines between them."""
    block: list[str] = []
    for line in lines:
        is_row = line.lstrip().startswith("|")
        if block and (not line.strip() or is_row != block[-1].lstrip().startswith("|")):
            yield block
            block = []
        if line.strip():
            block.append(line)
    if block:
        yield block


def _table(rows: list[str]) -> list[str]:
    """Return a Markdown table, whose second row is a line, as a directive."""
    indent = rows[0][: len(rows[0]) - len(rows[0].lstrip())]
    lines = [".. list-table::", "   :header-rows: 1", ""]
    for row in (rows[0], *rows[2:]):
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))]
        for number, cell in enumerate(cells):
            lines.append(f"   {'* -' if number == 0 else '  -'} {_inline(cell)}".rstrip())
    return [indent + line if line else line for line in lines]


def _inline(line: str) -> str:
    return _CODE.sub(lambda found: _literal(found[1]), line)


def _literal(text: str) -> str:
    return f":py:obj:`{text}`" if _NAME.fullmatch(text) else f"``{text}``"


# By opening tag as Sphinx and its theme Furo write it, the attributes that it lacks. Headings of lists have
# no level, two landmarks have no name, and boxes that scroll sideways cannot be reached by keyboard.
MISSING = {
    '<p class="caption" role="heading"': 'aria-level="2"',
    '<aside class="sidebar-drawer"': 'aria-label="Site"',
    '<aside class="toc-drawer"': 'aria-label="On this page"',
    '<aside class="toc-drawer no-toc"': 'aria-label="On this page"',
    '<div class="highlight"><pre': 'tabindex="0"',
    '<div class="table-wrapper colwidths-auto docutils container"': (
        'tabindex="0" role="group" aria-label="Table"'
    ),
    '<div class="table-wrapper colwidths-given docutils container"': (
        'tabindex="0" role="group" aria-label="Table"'
    ),
    '<div class="table-wrapper docutils container"': 'tabindex="0" role="group" aria-label="Table"',
}


def accessible(page: str) -> str:
    """Return an HTML page with the attributes that tags lack; a page that has them stays as it is."""
    for tag, attributes in MISSING.items():
        page = page.replace(f"{tag}>", f"{tag} {attributes}>")
    return page


# A paragraph that holds a figure alone, and the width of an SVG file in points.
_FIGURE = re.compile(r'<p>(<img [^>]*src="([^"]+\.svg)"[^>]*?) */></p>')
_POINTS = re.compile(r'<svg [^>]*width="([\d.]+)pt"')


def legible(page: str, folder: Path) -> str:
    """Return an HTML page whose figures scroll sideways where the window is too narrow for their letters.

    Letters in figures have about nine points. So a figure is at least as many CSS pixels wide as it has
    points; a smaller window shows a part of it, in a box that scrolls.

    Args:
        page: text of the page.
        folder: folder of the page, from which the links to figures lead.
    """

    def widened(figure: re.Match[str]) -> str:
        path = folder / unquote(figure[2])
        points = _POINTS.search(path.read_text(encoding="utf-8")) if path.is_file() else None
        if points is None:
            return figure[0]
        box = '<p class="figure" tabindex="0" role="group" aria-label="Figure">'
        return f'{box}{figure[1]} style="min-width: {float(points[1]):.0f}px" /></p>'

    return _FIGURE.sub(widened, page)
