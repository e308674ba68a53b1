"""Files of the package, found by name, and files of a user, found by path."""

import json
import os
from pathlib import Path
from typing import Any

from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import listed, shown

# Largest size of text files of controllers and presets, in bytes; the largest packaged one has 51 kB.
MAX_TEXT_FILE = 2**20


def packaged_names(folder: Path, suffix: str) -> list[str]:
    """Return the sorted names of all files below a folder, relative to it and without their suffix."""
    files = (path.relative_to(folder) for path in folder.rglob(f"*{suffix}"))
    return sorted(file.with_suffix("").as_posix() for file in files)


def find_file(name: str, folder: Path, suffix: str) -> Path | None:
    """Return the packaged file of that name, else the file at that path, else None."""
    for path in (folder / f"{name}{suffix}", Path(name)):
        if os.path.isfile(path):  # unlike `Path.is_file`, this takes any name
            return path
    return None


def read_bytes(path: Path, limit: int) -> bytes:
    """Return the content of a regular file of at most `limit` bytes.

    Raises:
        OSError: if it cannot be read, or is no regular file: a device could have no end.
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
    """Return the packaged JSON file of that name, else the file at that path.

    Raises:
        ValueError: an instance of `error`, if neither exists; the message names packaged files.
    """
    path = find_file(name, folder, ".json")
    if path is None:
        # One entry for all tuning seeds of a recipe: a/*@1 for a/0@1, a/1@1 and so on.
        recipes = [
            ControllerName.of("tuned", known).group.argument for known in packaged_names(folder, ".json")
        ]
        packaged = listed(dict.fromkeys(recipes), name, str(folder)) or "none"
        raise error(f"{kind} {shown(name)}: neither a packaged one ({packaged}) nor a file")
    return path


def read_json(path: Path, form: str) -> Any:
    """Return the content of a JSON file whose entry `format` has to be `form`.

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
