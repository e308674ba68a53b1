"""Markdown of generated pages: tables, and parts of docstrings."""

import inspect
import re
from collections.abc import Iterable, Sequence

_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns|Yields):$")
_ENTRY = re.compile(r"^ {4}(\w+): (.*)$")


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table; bars inside of cells are escaped, and line breaks become spaces."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines)


def code(value: object) -> str:
    """Return a value as inline code."""
    return f"`{value}`"


def listed(names: Iterable[object]) -> str:
    """Return names as inline code, with commas between them."""
    return ", ".join(map(code, names))


def prose(documented: object) -> str:
    """Return the docstring of a module, class or function without its sections such as Args and Raises.

    Raises:
        ValueError: if there is no docstring.
    """
    kept = []
    for line in _docstring(documented).split("\n"):
        if _SECTION.match(line):
            break
        kept.append(line)
    return "\n".join(kept).strip()


def first_sentence(documented: object) -> str:
    """Return the first sentence of a docstring, without the full stop at its end.

    Raises:
        ValueError: if there is no docstring.
    """
    paragraph = " ".join(_docstring(documented).split("\n\n")[0].split())
    return re.split(r"(?<=\w\w[.)`])\s+(?=[A-Z`])", paragraph)[0].removesuffix(".")


def entries(documented: object, section: str) -> dict[str, str]:
    """Return the texts of a docstring's section by name, such as those of Attributes, each on one line.

    Raises:
        ValueError: if there is no docstring.
    """
    found: dict[str, str] = {}
    inside, name = False, ""
    for line in _docstring(documented).split("\n"):
        if not line.startswith(" ") and line:
            inside = line == f"{section}:"
        elif inside and (entry := _ENTRY.match(line)):
            name = entry[1]
            found[name] = entry[2]
        elif inside and line:
            found[name] += f" {line.strip()}"
    return found


def topic(documented: object, title: str) -> str:
    """Return the part of a docstring that a bold title such as `**Info**` begins, up to the next one.

    Raises:
        ValueError: if there is no docstring, or no such title in it.
    """
    _, begin, rest = prose(documented).partition(f"**{title}**")
    if not begin:
        raise ValueError(f"{documented!r}: expected the title **{title}** in its docstring")
    return re.split(r"\n\n\*\*\w", rest)[0].lstrip(":,").strip()


def linked(text: str) -> str:
    """Return text of a page in a folder below `docs`, with links where it names a document of that folder."""
    return re.sub(r"(?<![\[(/\w])docs/([\w-]+\.md)", r"[\1](../\1)", text)


def _cell(value: object) -> str:
    return re.sub(r"(?<!\\)\|", r"\\|", " ".join(str(value).split()))


def _docstring(documented: object) -> str:
    docstring = inspect.getdoc(documented)
    if not docstring:
        raise ValueError(f"{documented!r}: expected a docstring")
    return docstring
