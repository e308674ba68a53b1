"""Checkpoints of runs: the last two of a run, each with a digest, so that damage to one is noticed.

A checkpoint is one line, `swarm_gym checkpoint 1 <SHA-256 of the rest>`, followed by the stored content. A
CMA-ES of the package `cmaes` is stored as arrays, since its own way of storing itself is a pickle.
"""

import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from cmaes import CMA, SepCMA
from numpy.typing import NDArray

from swarm_gym.files import write_atomically
from swarm_gym.runs.folder import RunFolderError

FORMAT = b"swarm_gym checkpoint 1"

State = TypeVar("State")
Arrays = dict[str, NDArray]


class _DamagedError(Exception):
    """A checkpoint whose content was changed after writing; the message states the difference."""


class Checkpoints:
    """The files `checkpoint<suffix>` and `checkpoint-before<suffix>` of a run, the newest and the one before.

    A process that is killed at any moment leaves at least one of the two intact. The newest file is missing
    only between its renaming to the one before and the renaming of its successor.

    Args:
        folder: folder of the run.
        suffix: suffix of the files, with its dot.
    """

    def __init__(self, folder: Path, suffix: str):
        self.newest = folder / f"checkpoint{suffix}"
        self.before = folder / f"checkpoint-before{suffix}"

    def save(self, content: bytes) -> None:
        """Write a checkpoint; the newest one becomes the one before."""
        line = FORMAT + b" " + hashlib.sha256(content).hexdigest().encode() + b"\n"
        write_atomically(self.newest, line + content, before=self.before)

    def load(self, read: Callable[[bytes], State]) -> State | None:
        """Return the newest intact checkpoint, or None if there is none yet.

        If the newest checkpoint is damaged, a warning is printed to standard error, and its file is renamed.
        So the next `save` does not overwrite the intact one with it.

        Args:
            read: function from the stored content to a state.

        Raises:
            RunFolderError: if all checkpoints are damaged, or one cannot be read.
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
                    f"continuing from the checkpoint before it, {path}",
                    file=sys.stderr,
                    flush=True,
                )
            try:
                return read(content)
            except Exception as error:
                raise RunFolderError(f"{path}: not a readable checkpoint ({error})") from error
        if damage:
            other = "" if len(damage) > 1 else f", and there is no {self.before.name}"
            raise RunFolderError(f"no checkpoint to continue from: {' and '.join(damage)}{other}")
        return None


def strategy_state(strategy: CMA | SepCMA) -> Arrays:
    """Return everything that changes in a strategy between `tell` and `ask`, as arrays without objects."""
    state = {
        f"strategy.{name}": np.asarray(value)
        for name, value in vars(strategy).items()
        if name != "_rng" and value is not None
    }
    _, keys, *numbers = strategy._rng.get_state()
    return {
        **state,
        "generator.keys": np.asarray(keys, dtype=np.int64),
        "generator.numbers": np.array(numbers, dtype=float),
    }


def load_strategy(strategy: CMA | SepCMA, state: Arrays) -> None:
    """Set a strategy to a state that `strategy_state` returned."""
    for name in vars(strategy):
        if name != "_rng":
            value = state.get(f"strategy.{name}")  # absent if it was None
            setattr(strategy, name, value.item() if value is not None and value.ndim == 0 else value)
    place, has_gauss, gauss = state["generator.numbers"].tolist()
    keys = state["generator.keys"].astype(np.uint32)
    strategy._rng.set_state(("MT19937", keys, int(place), int(has_gauss), gauss))


def _checked(path: Path) -> bytes:
    """Return the stored content of a checkpoint file."""
    try:
        line, _, content = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise _DamagedError(str(error)) from error
    if not line.startswith(FORMAT + b" "):
        raise _DamagedError(f"it does not begin with {FORMAT.decode()!r}")
    if hashlib.sha256(content).hexdigest().encode() != line[len(FORMAT) + 1 :]:
        raise _DamagedError("its content does not have the digest in its first line")
    return content
