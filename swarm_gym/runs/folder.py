"""The folder of a run: its configuration is stored once, and a run is resumed only with the same one."""

import json
from collections.abc import Collection, Mapping
from pathlib import Path

from filelock import FileLock, Timeout

from swarm_gym.errors import shown
from swarm_gym.files import remove_partials, write_atomically

CONFIG = "config.json"
LOCK = "lock"


class RunFolderError(RuntimeError):
    """An error because of which a run cannot be started or resumed."""


class RunTakenError(RunFolderError):
    """An error because another process holds the lock of a run."""


def is_begun(folder: Path) -> bool:
    """Return whether a folder has a run that can be resumed."""
    return (folder / CONFIG).exists()


def prepare_folder(
    folder: Path, options: Mapping[str, object], resume: bool, not_compared: Collection[str]
) -> FileLock:
    """Store the configuration of a new run, or compare a resumed run's and delete its partial files.

    Args:
        folder: folder of the run.
        options: the configuration, its entries by name.
        resume: whether the run exists already.
        not_compared: entries that may have changed when a run is resumed.

    Returns:
        The lock on the folder, to be released when the run ends; the end of the process releases it too.

    Raises:
        RunTakenError: if another process works on the run.
        RunFolderError: if a new run exists already, or a resumed one is missing or has another configuration.
        OSError: if the folder cannot be written.
    """
    if resume and not is_begun(folder):
        raise RunFolderError(f"--resume: there is no run in {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / LOCK)
    try:
        lock.acquire(blocking=False)
    except Timeout as error:
        raise RunTakenError(f"{folder}: another process works on this run") from error
    except NotImplementedError:  # a file system without locks
        pass
    try:
        _prepare(folder, options, resume, not_compared)
    except BaseException:
        lock.release()
        raise
    return lock


def _prepare(
    folder: Path, options: Mapping[str, object], resume: bool, not_compared: Collection[str]
) -> None:
    stored = folder / CONFIG
    mine = as_json(options)
    if not resume:
        if stored.exists():
            raise RunFolderError(f"{folder} holds a run already; use --resume, another --name, or delete it")
        write_atomically(stored, json.dumps(mine, indent=2) + "\n")
        return
    try:
        theirs = dict(json.loads(stored.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise RunFolderError(f"{stored}: not a readable configuration ({error})") from error
    missing = "no option"
    different = [
        f"{key} was {shown(theirs.get(key, missing))}, is {mine.get(key, missing)!r}"
        for key in {**theirs, **mine}
        if key not in not_compared and theirs.get(key, missing) != mine.get(key, missing)
    ]
    if different:
        raise RunFolderError(f"--resume: {folder} was run with {'; '.join(different)}")
    remove_partials(folder)


def as_json(options: Mapping[str, object]) -> dict[str, object]:
    """Return the entries of a configuration as JSON values, by name."""
    return json.loads(json.dumps(dict(options), default=str))
