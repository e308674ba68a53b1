"""How well threads share the work, beside what the machine gives to independent processes.

A core may run slower when the others are busy, or be slowed by other users for a while. So one thread, all
threads, and as many processes take turns, and every ratio is of neighbours in time.
"""

import multiprocessing
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from multiprocessing.connection import Connection

import numpy as np

from experiments.speed.environments import vector
from experiments.speed.measurement import ALL_THREADS, Measurement, Quantity

SIZE = 60
WIDTH = 64
TURNS = 25

Rates = np.ndarray  # (TURNS,) steps per second


def quantities() -> Iterator[Quantity]:
    """All of this group; nothing where there is one core only."""
    if ALL_THREADS > 1:
        yield Quantity(thread_name(), "%", lambda: _efficiency(_turns()[1]), 1)
        yield Quantity(
            f"the same of {ALL_THREADS} independent processes", "%", lambda: _efficiency(_turns()[2]), 1
        )
        yield Quantity(against_processes_name(), "%", _against_processes, 1)


def summary(measurements: list[Measurement]) -> list[Measurement]:  # noqa: ARG001
    """Nothing follows."""
    return []


def thread_name() -> str:
    """Of the efficiency of threads against one thread."""
    return f"parallel efficiency of {ALL_THREADS} threads, {WIDTH} swarms of {SIZE} members"


def against_processes_name() -> str:
    """Of the efficiency of threads against independent processes."""
    return f"{ALL_THREADS} threads beside {ALL_THREADS} independent processes of half the swarms each"


def _efficiency(together: Rates) -> list[float]:
    return (100.0 * together / (ALL_THREADS * _turns()[0])).tolist()


def _against_processes() -> list[float]:
    _, threads, processes = _turns()
    return (100.0 * threads / processes).tolist()


@cache
def _turns() -> tuple[Rates, Rates, Rates]:
    """Steps per second of one thread, of all threads, and of all processes together."""
    one, threads = vector(WIDTH, SIZE, 1), vector(WIDTH, SIZE, ALL_THREADS)
    with _processes() as together:
        rates = np.array([(one(), threads(), together(), one()) for _ in range(TURNS)])
    return (rates[:, 0] + rates[:, 3]) / 2, rates[:, 1], rates[:, 2]


@contextmanager
def _processes() -> Iterator[Callable[[], float]]:
    """A function that lets all processes run at the same time, and returns the sum of their rates."""
    context = multiprocessing.get_context("spawn")
    pipes, processes = [], []
    for _ in range(ALL_THREADS):
        here, there = context.Pipe()
        processes.append(context.Process(target=_run_on_demand, args=(there,)))
        processes[-1].start()
        pipes.append(here)

    def together() -> float:
        for pipe in pipes:
            pipe.send(True)
        return sum(pipe.recv() for pipe in pipes)

    together()  # now all are ready
    try:
        yield together
    finally:
        for pipe, process in zip(pipes, processes, strict=True):
            pipe.send(False)
            process.join()


def _run_on_demand(pipe: Connection) -> None:
    once = vector(WIDTH // ALL_THREADS, SIZE, 1)
    while pipe.recv():
        pipe.send(once())
