"""The bar of a training run on the terminal, and its TensorBoard events.

The bar moves at least every second: also within a chunk, and while the run validates. Events are scalars,
pictures of each validation, and hyperparameters.
"""

import json
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray
from torch.utils.tensorboard import SummaryWriter
from torch.utils.tensorboard.summary import hparams
from tqdm import tqdm

from swarm_gym.rollout import Episodes
from swarm_gym.training.pictures import draw_decisions

FILES = "events.out.tfevents.*"
PERIOD = 0.5  # seconds between two looks at the number of steps
MOST_WAIT = 10  # seconds to wait if the clock was set back a little


class Progress:
    """A bar of environment steps, which a thread moves while the training goes on.

    Args:
        name: name of the run, which the bar shows.
        total: number of steps of the training.
        count: function that returns the number of steps so far; another thread calls it.
    """

    def __init__(self, name: str, total: int, count: Callable[[], int]):
        self._name, self._count = name, count
        self._bar = tqdm(total=total, initial=count(), unit="step", desc=name)
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ends.set()
        self._thread.join()
        self._move()
        self._bar.close()

    @contextmanager
    def during(self, phase: str) -> Iterator[None]:
        """Name a phase in which no steps are counted, such as a validation, after the name of the run."""
        self._bar.set_description(f"{self._name}, {phase}")
        yield
        self._bar.set_description(self._name)

    def show(self, **results: float) -> None:
        """Show results behind the bar, by name."""
        self._bar.set_postfix({name: f"{value:.3f}" for name, value in results.items()})

    def _watch(self) -> None:
        while not self._ends.wait(PERIOD):
            self._move()

    def _move(self) -> None:
        # Steps of demonstrations are counted first, and then taken back.
        self._bar.n = max(self._bar.n, self._count())
        self._bar.refresh()


class TrainingEvents:
    """The event files in the folder of a run; a resumed run appends to the events up to its checkpoint.

    Events after the checkpoint are cut off the files, so that a run that was killed shows every event once.

    Args:
        folder: folder of the run.
        sizes: sizes of files that `flush` returned at the checkpoint; None for a new run, which leaves all
            files unchanged.
        step: step of the checkpoint, for an open TensorBoard that has read later events already.
    """

    def __init__(self, folder: Path, sizes: Mapping[str, int] | None, step: int = -1):
        self._folder = folder
        if sizes is not None:
            _cut_off(folder, sizes)
            _wait_for_a_later_name(sizes)
        self._writer = SummaryWriter(str(folder), purge_step=None if sizes is None else step + 1)
        if threading.excepthook is threading.__excepthook__:
            threading.excepthook = _leave_to_the_caller

    def add_scalars(self, scalars: Mapping[str, float], step: int) -> None:
        """Add scalars by name."""
        for name, value in scalars.items():
            self._writer.add_scalar(name, value, step)

    def add_decisions(self, by_scenario: Mapping[str, Episodes], step: int) -> None:
        """Add a picture of size and phi against the iteration, and their means at every tenth as scalars."""
        self._add_picture("validation/decisions", draw_decisions(by_scenario), step)
        for name in ("sizes", "repair_degrees"):
            values = np.concatenate([getattr(episodes, name) for episodes in by_scenario.values()])
            for iteration in range(0, values.shape[1], 10):
                column = values[:, iteration]
                if np.isnan(column).all():
                    break  # a budget has ended all episodes before
                self._writer.add_scalar(f"{name}/iteration {iteration + 1:03}", np.nanmean(column), step)

    def add_replay(self, picture: NDArray[np.uint8], step: int) -> None:
        """Add a strip of pictures of an episode, shape (height, width, 3)."""
        self._add_picture("validation/replay", picture, step)

    def add_hyperparameters(
        self, options: Mapping[str, object], metrics: Mapping[str, float], step: int
    ) -> None:
        """Add an entry of the HParams tab: options as JSON values, and the metrics of a run with these.

        If a run is made longer and ends again, TensorBoard keeps the first options and shows the last
        metrics. Options must therefore not include values that may change in a resumed run.
        """
        flat = {name: _as_scalar(value) for name, value in options.items()}
        # SummaryWriter.add_hparams would write to another file.
        for summary in hparams(flat, dict(metrics)):
            self._writer._get_file_writer().add_summary(summary, step)
        self.add_scalars(metrics, step)

    def flush(self) -> dict[str, int]:
        """Write all events to the disk; return the sizes of the files in bytes by their names."""
        self._writer.flush()
        sizes = {}
        for path in sorted(self._folder.glob(FILES)):
            with path.open("ab") as file:
                os.fsync(file.fileno())
                sizes[path.name] = file.tell()
        return sizes

    def close(self) -> None:
        """Write the remaining events and close the files."""
        self._writer.close()

    def _add_picture(self, name: str, picture: NDArray[np.uint8], step: int) -> None:
        self._writer.add_image(name, picture, step, dataformats="HWC")


def _leave_to_the_caller(arguments: threading.ExceptHookArgs) -> None:
    """Do not print write errors of TensorBoard's thread: the next call that adds or flushes raises them."""
    if not (type(arguments.thread).__module__.startswith("tensorboard") and arguments.exc_type is OSError):
        threading.__excepthook__(arguments)


def _cut_off(folder: Path, sizes: Mapping[str, int]) -> None:
    """Truncate the event files in a folder to these sizes, and delete the others."""
    for path in folder.glob(FILES):
        if path.name not in sizes:
            path.unlink()
        elif path.stat().st_size > sizes[path.name]:
            os.truncate(path, sizes[path.name])
    for name, size in sizes.items():
        path = folder / name
        there = path.stat().st_size if path.exists() else 0
        if there < size:
            print(
                f"warning: {path} has {there} of {size} bytes: TensorBoard will lack some of the run",
                file=sys.stderr,
            )


def _wait_for_a_later_name(names: Iterable[str]) -> None:
    """Wait until a new file sorts last: names begin with the second of creation, and are read in order."""
    last = max(map(_second, names), default=0)
    if last > time.time() + MOST_WAIT:
        print(
            f"warning: the clock was set back after {FILES[:-1]}{last:010} was created: TensorBoard may "
            "show the run in the wrong order",
            file=sys.stderr,
        )
        return
    while time.time() < last + 1:
        time.sleep(0.05)


def _second(name: str) -> int:
    return int(name.removeprefix(FILES[:-1]).partition(".")[0])


def _as_scalar(value: object) -> int | float | str:
    return value if isinstance(value, int | float | str) else json.dumps(value)
