"""Access to map files, in the data folder or at an absolute path."""

import os
from pathlib import Path, PurePath
from typing import BinaryIO

import platformdirs

from swarm_gym.errors import ScenarioError, shown

DATA = "SWARM_GYM_DATA"  # environment variable with the path of the data folder

# Subfolders of the data folder that are searched before the others.
FOLDERS = ("movingai", "ros")


def data_folder() -> Path:
    """Return the folder of the maps: `SWARM_GYM_DATA` if it is set, else a folder in the user's data."""
    return Path(os.environ.get(DATA) or platformdirs.user_data_dir("swarm_gym"))


def find_data_file(*names: str) -> Path:
    """Return the first file that exists out of some names, each absolute or relative to the data folder.

    A relative name is looked up in the folder itself, then in `FOLDERS`, then in its other subfolders, one
    level deep.

    Raises:
        ScenarioError: if no file exists, or a relative name leads out of the folder, also by a link.
    """
    for name in names:
        _check(name)
    folder = data_folder()
    places = [folder, *(folder / name for name in FOLDERS), *_other_folders(folder)]
    for name in names:
        for place in places:
            # An absolute name replaces `place`.
            if os.path.isfile(place / name):
                if not PurePath(name).is_absolute():
                    _require_inside(folder, place / name)
                return place / name
    searched = "" if PurePath(names[0]).is_absolute() else f"; searched {folder} and its subfolders"
    raise ScenarioError(
        f"no file {' or '.join(names)}{searched}. `python -m swarm_gym.scenarios.download` downloads "
        "public maps, and the environment variable SWARM_GYM_DATA selects another folder"
    )


def _require_inside(folder: Path, path: Path) -> None:
    """Raise an error if a path leads out of a folder, by its parts or by links.

    Raises:
        ScenarioError: if the path leads out of the folder.
    """
    real = os.path.realpath(path)
    if not PurePath(real).is_relative_to(os.path.realpath(folder)):
        raise ScenarioError(
            f"{path} leads out of the folder {folder}, to {real}; move the file into the folder"
        )


def open_file(path: Path) -> BinaryIO:
    """Open a regular file for reading bytes.

    Folders and devices are refused; a device might have no end.

    Raises:
        OSError: if there is no such file, or it may not be read.
    """
    # These functions accept any name; methods of `Path` do not.
    if not os.path.isfile(path):
        raise OSError("not a regular file" if os.path.exists(path) else "no such file")
    return path.open("rb")


def stamp_of(path: Path) -> tuple[int, int]:
    """Return time of change and size of a file; if they differ, the file has to be read again.

    Raises:
        ScenarioError: if there is no such file.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
    return status.st_mtime_ns, status.st_size


def _check(name: str) -> None:
    if not name.isprintable():
        raise ScenarioError(f"file {shown(name)}: a name must not have control characters")
    path = PurePath(name)
    if not path.is_absolute() and (".." in path.parts or path.drive or path.root):
        raise ScenarioError(
            f"file {shown(name)}: a relative name must stay in the data folder; use an absolute path"
        )


def _other_folders(folder: Path) -> list[Path]:
    try:
        return sorted(entry for entry in folder.iterdir() if entry.is_dir() and entry.name not in FOLDERS)
    except OSError:
        return []
