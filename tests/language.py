"""Check the English of docstrings and help texts: `python tests/language.py FOLDER ...`.

A docstring must be understood alone, so it must not begin with a word that makes it a fragment of something
else, such as "Of", "What" or "Likewise". The same holds for the text behind each name of the sections Args,
Attributes, Raises and Returns, and for the help text below a field of a dataclass. `make check` runs this;
the rules are in CONTRIBUTING.md.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

OPENINGS = (
    "also", "and", "as", "but", "else", "for", "he", "him", "how", "if", "it", "its", "likewise", "of", "or",
    "same", "she", "that", "the same", "their", "them", "these", "they", "this", "those", "what", "whatever",
    "when", "where", "whether", "which", "who", "whoever", "whom", "whose", "why",
)  # fmt: skip
# Behind a name, a condition or a question of yes and no is plain: "whether to draw", "if it is missing".
ENTRY_OPENINGS = tuple(sorted(set(OPENINGS) - {"as", "for", "how", "if", "whether", "when"}))
MOST_WORDS = 40  # of a sentence; CONTRIBUTING.md asks for 25

_ENTRY = re.compile(r"^ {4}\*{0,2}\w[\w, .*]*: (.*)$")
_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns|Yields):$")


def fragment(text: str, openings: tuple[str, ...]) -> str | None:
    """Return the forbidden opening of a text, or None if it has none."""
    for opening in openings:
        if re.match(rf"{opening}\b(?!-)", text, re.IGNORECASE):
            return opening
    return None


def long_sentence(text: str) -> str | None:
    """Return the beginning of the first sentence that has too many words, or None if there is none."""
    for paragraph in re.split(r"\n\s*\n|\n\s*[*|-]|\n {4,}", text):
        for sentence in re.split(r"(?<=[.;:!?])\s+", paragraph):
            words = sentence.split()
            if len(words) > MOST_WORDS:
                return " ".join(words[:6])
    return None


def faults(docstring: str) -> Iterator[str]:
    """Yield what is wrong with a docstring."""
    if opening := fragment(docstring, OPENINGS):
        yield f'begins with "{opening}"'
    if sentence := long_sentence(docstring):
        yield f'a sentence has more than {MOST_WORDS} words: "{sentence} ..."'
    section = False
    for line in docstring.split("\n"):
        section = bool(_SECTION.match(line)) or (section and (not line or line.startswith(" ")))
        entry = _ENTRY.match(line) if section else None
        if entry and (opening := fragment(entry[1], ENTRY_OPENINGS)):
            yield f'"{line.strip()[:50]}": the description begins with "{opening}"'


def texts(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of every docstring, and of every string below a field of a class."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            docstring = ast.get_docstring(node)
            if docstring:
                yield node.body[0].lineno, docstring
        if isinstance(node, ast.ClassDef):
            for statement in node.body[1:]:
                if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                    yield statement.lineno, str(statement.value.value)


def check(folders: list[Path]) -> list[str]:
    """Return every fault in the Python files of these folders, as `file:line: fault`."""
    return [
        f"{file}:{line}: {fault}"
        for folder in folders
        for file in sorted(folder.rglob("*.py"))
        for line, text in texts(ast.parse(file.read_text(encoding="utf-8")))
        for fault in faults(text)
    ]


if __name__ == "__main__":
    found = check([Path(argument) for argument in sys.argv[1:]])
    print("\n".join(found) or "docstrings and help texts: no fault")
    sys.exit(bool(found))
