"""Check the English of docstrings, help texts, messages and names of tests: `python tests/language.py DIR`.

A docstring must be understood alone. So it must not begin with a word that makes it a fragment of something
else, such as "Of", "What" or "Likewise". The same holds for texts behind names in the sections Args,
Attributes, Raises and Returns, and for help texts of fields. The name of a test is a statement, and does not
begin with a pronoun. No sentence has more than 25 words; formulas do not count. `make check` runs this; the
rules are in CONTRIBUTING.md.
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
# A name of a test that begins so cannot be understood without its file.
PRONOUNS = ("he", "it", "its", "of", "she", "that", "their", "them", "these", "they", "this", "those")
MOST_WORDS = 25  # of a sentence

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
            words = [word for word in sentence.split() if re.search("[A-Za-z]", word)]
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


def messages(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of every error message; a value in it counts as one word."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            for argument in node.exc.args:
                if text := text_of(argument):
                    yield argument.lineno, text


def text_of(node: ast.expr) -> str:
    """Return the text of a string, with X for each value in it; nothing if it is no string."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(text_of(part) or "X" for part in node.values)
    return ""


def names_of_tests(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the name of every test, as words."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            yield node.lineno, node.name.removeprefix("test_").replace("_", " ")


def faults_of_name(name: str) -> Iterator[str]:
    """Yield what is wrong with the name of a test."""
    if opening := fragment(name, PRONOUNS):
        yield f'the name of the test begins with "{opening}"'
    if len(name.split()) > MOST_WORDS:
        yield f"the name of the test has more than {MOST_WORDS} words"


def faults_of_message(message: str) -> Iterator[str]:
    """Yield what is wrong with an error message."""
    if sentence := long_sentence(message):
        yield f'a sentence of the message has more than {MOST_WORDS} words: "{sentence} ..."'


def check(folders: list[Path]) -> list[str]:
    """Return every fault in the Python files of these folders, as `file:line: fault`."""
    found = []
    for folder in folders:
        for file in sorted(folder.rglob("*.py")):
            tree = ast.parse(file.read_text(encoding="utf-8"))
            checks = ((texts, faults), (messages, faults_of_message), (names_of_tests, faults_of_name))
            found += [
                f"{file}:{line}: {fault}"
                for find, faults_in in checks
                for line, text in find(tree)
                for fault in faults_in(text)
            ]
    return found


if __name__ == "__main__":
    found = check([Path(argument) for argument in sys.argv[1:]])
    print("\n".join(found) or "docstrings, help texts, messages and names of tests: no fault")
    sys.exit(bool(found))
