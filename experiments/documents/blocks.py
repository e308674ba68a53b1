"""Marked blocks of documents, whose content is generated."""

import re


def replace_block(text: str, name: str, content: str) -> str:
    """Return the text with new content between `<!-- name -->` and `<!-- /name -->`.

    Raises:
        ValueError: if there is no such block.
    """
    block = re.compile(rf"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)", re.DOTALL)
    if not block.search(text):
        raise ValueError(f"there is no block {name!r} to replace")
    return block.sub(lambda match: f"{match[1]}{content.strip()}\n{match[2]}", text)


def block_names(text: str) -> list[str]:
    """Return the names of the blocks of a text, by the marks at their ends."""
    return re.findall(r"<!-- /(\S+) -->", text)
