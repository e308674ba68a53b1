"""The last two checkpoints of a run, each with a digest of itself, so that damage to one is noticed.

A checkpoint is one line, `swarm_gym checkpoint 1 <SHA-256 of the rest>`, and then what was stored.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from agents.runs.folder import RunFolderError
from swarm_gym.files import write_atomically

FORMAT = b"swarm_gym checkpoint 1"

State = TypeVar("State")


class _DamagedError(Exception):
    """A checkpoint is not what was written; the message says how."""


class Checkpoints:
    """`checkpoint.<suffix>`, and `checkpoint-before.<suffix>`, which it was written over.

    Killed at any moment, a process leaves at least one of the two, and whole: the newest is missing for the
    moment in which it has become the one before, and its successor has not its name yet.

    Args:
        folder: of the run.
        suffix: of the files, with its dot.
    """

    def __init__(self, folder: Path, suffix: str):
        self.newest = folder / f"checkpoint{suffix}"
        self.before = folder / f"checkpoint-before{suffix}"

    def save(self, content: bytes) -> None:
        """Store one more."""
        line = FORMAT + b" " + hashlib.sha256(content).hexdigest().encode() + b"\n"
        write_atomically(self.newest, line + content, before=self.before)

    def load(self, read: Callable[[bytes], State]) -> State | None:
        """The newest checkpoint that is whole, None if there was none yet.

        A newest one that is damaged is said on standard error, and kept under another name, lest it should
        take the place of the one before.

        Args:
            read: makes a state of what was stored.

        Raises:
            RunFolderError: if what is there is damaged, or cannot be read.
        """
        damage = []
        for path in (self.newest, self.before):
            if not path.exists():
                continue
            try:
                content = _checked(path)
            except _DamagedError as error:
                damage.append(f"{path} is damaged ({error})")
                continue
            if damage:
                aside = self.newest.with_name(f"{self.newest.name}.damaged")
                os.replace(self.newest, aside)
                print(
                    f"warning: {damage[0]} and now called {aside.name}; "
                    f"going on from the checkpoint before it, {path}",
                    file=sys.stderr,
                    flush=True,
                )
            try:
                return read(content)
            except Exception as error:
                raise RunFolderError(f"{path}: not a readable checkpoint ({error})") from error
        if damage:
            other = "" if len(damage) > 1 else f", and there is no {self.before.name}"
            raise RunFolderError(f"no checkpoint to go on from: {' and '.join(damage)}{other}")
        return None


def _checked(path: Path) -> bytes:
    """What was stored in a checkpoint."""
    try:
        line, _, content = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise _DamagedError(str(error)) from error
    if not line.startswith(FORMAT + b" "):
        raise _DamagedError(f"it does not begin with {FORMAT.decode()!r}, or an earlier version wrote it")
    if hashlib.sha256(content).hexdigest().encode() != line[len(FORMAT) + 1 :]:
        raise _DamagedError("its content does not have the digest that its first line says")
    return content
