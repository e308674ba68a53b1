"""Files that come with the project: found by name, or at the path that is given."""

import json
import os
from pathlib import Path
from typing import Any

from swarm_gym.errors import shown

# Of the text files of controllers and presets, in bytes; the largest that ships has 51 kB.
MAX_TEXT_FILE = 2**20


def shipped_names(folder: Path, suffix: str) -> list[str]:
    """Names of the files with that suffix in a folder; of those in folders of it, `<folder>/<file>`."""
    files = (path.relative_to(folder) for path in folder.rglob(f"*{suffix}"))
    return sorted(file.with_suffix("").as_posix() for file in files)


def find_file(name: str, folder: Path, suffix: str) -> Path | None:
    """The shipped file of that name, or the one at that path, or nothing."""
    for path in (folder / f"{name}{suffix}", Path(name)):
        if os.path.isfile(path):  # unlike the method of `Path`, this takes any name
            return path
    return None


def read_bytes(path: Path, limit: int) -> bytes:
    """The content of a regular file of at most so many bytes.

    Raises:
        OSError: if it cannot be read, or is no regular file: a device might have no end.
        ValueError: if it has more bytes.
    """
    if not os.path.isfile(path):
        raise OSError("not a regular file" if os.path.exists(path) else "no such file")
    with path.open("rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise ValueError(f"expected at most {limit} bytes, the file has more")
    return data


def find_json(kind: str, name: str, folder: Path, error: type[ValueError]) -> Path:
    """The JSON file of that name, or at that path.

    Raises:
        ValueError: of the class `error`, if there is neither; the message lists those that ship.
    """
    path = find_file(name, folder, ".json")
    if path is None:
        shipped = ", ".join(shipped_names(folder, ".json")) or "none"
        raise error(f"{kind} {shown(name)}: neither a shipped one ({shipped}) nor a file")
    return path


def read_json(path: Path, form: str) -> Any:
    """The content of a JSON file, held against the format that it has to state.

    Raises:
        OSError, KeyError, TypeError, ValueError: if it is not readable, or of another format.
    """
    try:
        content = json.loads(read_bytes(path, MAX_TEXT_FILE).decode())
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
    if content["format"] != form:
        raise ValueError(f"expected format {form!r}, got {shown(content['format'])}")
    return content
