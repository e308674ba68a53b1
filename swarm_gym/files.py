"""Files that appear under their name only when they are complete."""

import os
from pathlib import Path


def write_atomically(path: Path, content: bytes | str) -> Path:
    """Write a file, text as UTF-8, at once or not at all; makes its folder; returns the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_bytes(content.encode() if isinstance(content, str) else content)
    os.replace(partial, path)
    return path
