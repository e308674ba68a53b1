"""The folder of a run: its configuration is written once, and a run is only resumed with the same one."""

import dataclasses
import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from swarm_gym.errors import shown
from swarm_gym.files import remove_partials, write_atomically

CONFIG = "config.json"
LOCK = "lock"


class RunFolderError(RuntimeError):
    """A run cannot be started or resumed."""


class RunTakenError(RunFolderError):
    """Another process works on a run."""


def is_begun(folder: Path) -> bool:
    """Whether there is a run in a folder, which can be resumed."""
    return (folder / CONFIG).exists()


def prepare_folder(folder: Path, config: Any, resume: bool, not_compared: Collection[str]) -> FileLock:
    """Store the configuration of a new run, or compare that of a run that is resumed, and tidy up after it.

    Returns:
        The lock on the folder, to be released when the run ends; however a process ends, it is.

    Args:
        folder: of the run.
        config: a dataclass whose entries all have defaults.
        resume: whether the run is there already.
        not_compared: entries that a resumed run may have changed.

    Raises:
        RunTakenError: if another process works on it.
        RunFolderError: if a new run is there already, or a resumed one is not, or was another.
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
        _prepare(folder, config, resume, not_compared)
    except BaseException:
        lock.release()
        raise
    return lock


def _prepare(folder: Path, config: Any, resume: bool, not_compared: Collection[str]) -> None:
    stored = folder / CONFIG
    mine = as_json(config)
    if not resume:
        if stored.exists():
            raise RunFolderError(f"{folder} holds a run already; use --resume, another --name, or delete it")
        write_atomically(stored, json.dumps(mine, indent=2) + "\n")
        return
    try:
        theirs = dict(json.loads(stored.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise RunFolderError(f"{stored}: not a readable configuration ({error})") from error
    # What an option did before it was there is what it does by default.
    theirs = {**as_json(type(config)()), **theirs}
    different = [
        f"{key} was {shown(theirs[key])}, is {mine.get(key, 'no option')!r}"
        for key in theirs
        if key not in not_compared and theirs[key] != mine.get(key, "no option")
    ]
    if different:
        raise RunFolderError(f"--resume: {folder} was run with {'; '.join(different)}")
    remove_partials(folder)


def as_json(config: Any) -> dict[str, Any]:
    """The entries of a dataclass as JSON has them."""
    return json.loads(json.dumps(dataclasses.asdict(config), default=str))
