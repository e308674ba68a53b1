"""Parallel efficiency of threads, compared with that of independent processes.

A core may run slower when the others are busy, or while other users need it. So one thread, all threads, and
as many processes take turns, and every ratio compares measurements that follow each other.
"""

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import cache
from multiprocessing.synchronize import Barrier
from typing import Any

import numpy as np

from experiments.speed.environments import vector
from experiments.speed.measurement import ALL_THREADS, Quantity

SIZE = 60
SHARE = max(1, 64 // ALL_THREADS)  # number of swarms of a process
WIDTH = SHARE * ALL_THREADS
TURNS = 15
LONG_RUN = 5e6  # moves of a measurement, so that disturbances of milliseconds do not matter

Rates = np.ndarray  # (TURNS,) steps per second


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group; none if there is only one core."""
    if ALL_THREADS > 1:
        yield Quantity(THREADS_OVER_ONE, "%", lambda: _efficiency(_turns()[1]), 1)
        yield Quantity(PROCESSES_OVER_ONE, "%", lambda: _efficiency(_turns()[2]), 1)
        yield Quantity(THREADS_OVER_PROCESSES, "%", _against_processes, 1)


THREADS_OVER_ONE = f"parallel efficiency of {ALL_THREADS} threads, {WIDTH} swarms of {SIZE} members"
PROCESSES_OVER_ONE = f"the same of {ALL_THREADS} independent processes of {SHARE} swarms each"
THREADS_OVER_PROCESSES = "those threads over those processes"


def _efficiency(together: Rates) -> list[float]:
    return (100.0 * together / (ALL_THREADS * _turns()[0])).tolist()


def _against_processes() -> list[float]:
    _, threads, processes = _turns()
    return (100.0 * threads / processes).tolist()


@cache
def _turns() -> tuple[Rates, Rates, Rates]:
    """Return steps per second of one thread, of all threads, and of all processes together."""
    one, threads = vector(WIDTH, SIZE, 1, LONG_RUN), vector(WIDTH, SIZE, ALL_THREADS, LONG_RUN)
    with processes(ALL_THREADS, SHARE, SIZE, LONG_RUN / ALL_THREADS) as together:
        rates = np.array([(one(), threads(), together(), one()) for _ in range(TURNS + 1)])[1:]
    return (rates[:, 0] + rates[:, 3]) / 2, rates[:, 1], rates[:, 2]


@contextmanager
def processes(number: int, width: int, size: int, moves: float) -> Iterator[Callable[[], float]]:
    """Yield a function that lets processes run at the same time and returns the sum of their rates."""
    context = multiprocessing.get_context("spawn")
    arguments = (context.Barrier(number), width, size, moves)
    with ProcessPoolExecutor(number, context, _prepare, arguments) as pool:
        # Every call waits for all others, so that each process takes one of them.
        yield lambda: sum(pool.map(_measure, range(number)))


_prepared: dict[str, Any] = {}  # what a process of the pool measures


def _prepare(barrier: Barrier, width: int, size: int, moves: float) -> None:
    once = vector(width, size, 1, moves)
    once()  # past the first steps of an episode
    _prepared.update(barrier=barrier, once=once)


def _measure(_: int) -> float:
    _prepared["barrier"].wait()
    return _prepared["once"]()
