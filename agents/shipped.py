"""Files that come with the project: found by name, or at the path that is given."""

import json
from pathlib import Path
from typing import Any


def shipped_names(folder: Path, suffix: str) -> list[str]:
    """Names of the files with that suffix in a folder; of those in folders of it, `<folder>/<file>`."""
    files = (path.relative_to(folder) for path in folder.rglob(f"*{suffix}"))
    return sorted(file.with_suffix("").as_posix() for file in files)


def find_file(name: str, folder: Path, suffix: str) -> Path | None:
    """The shipped file of that name, or the one at that path, or nothing."""
    for path in (folder / f"{name}{suffix}", Path(name)):
        if path.is_file():
            return path
    return None


def find_json(kind: str, name: str, folder: Path, error: type[ValueError]) -> Path:
    """The JSON file of that name, or at that path.

    Raises:
        ValueError: of the class `error`, if there is neither; the message lists those that ship.
    """
    path = find_file(name, folder, ".json")
    if path is None:
        shipped = ", ".join(shipped_names(folder, ".json")) or "none"
        raise error(f"{kind} {name!r}: neither a shipped one ({shipped}) nor a file")
    return path


def read_json(path: Path, form: str) -> Any:
    """The content of a JSON file, held against the format that it has to state.

    Raises:
        OSError, KeyError, TypeError, ValueError: if it is not readable, or of another format.
    """
    content = json.loads(path.read_text(encoding="utf-8"))
    if content["format"] != form:
        raise ValueError(f"expected format {form!r}, got {content['format']!r}")
    return content
