"""Units of work of a known length, and runs of no length: what is measured beside them is overhead."""

import dataclasses
import time
from typing import Any

from experiments.runs.run import Run


def compute(_: int, seconds: float) -> None:
    """Use a processor for so long, by its own clock: who has to share one takes longer."""
    begin = time.process_time()
    while time.process_time() - begin < seconds:
        pass


def compute_together(barrier: Any, units: int, seconds: float) -> None:
    """Begin with others and compute so many units."""
    barrier.wait()
    for number in range(units):
        compute(number, seconds)


def wait(_: int, seconds: float) -> None:
    """Take so long and no processor, so that there can be more workers than cores."""
    time.sleep(seconds)


def copies(number: int, run: Run, count: int) -> list[Run]:
    """Runs with seeds of their own, as a unit of an evaluation brings them back."""
    return [dataclasses.replace(run, seed=number * count + k) for k in range(count)]
