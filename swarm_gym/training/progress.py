"""The bar of a training, which moves at least every second: also within a chunk, and while it validates."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

from tqdm import tqdm

PERIOD = 0.5  # seconds between two looks at the number of steps


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
