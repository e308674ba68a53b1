"""Steps per second of single and vector environments."""

import time
from collections.abc import Callable, Iterator

import gymnasium
import numpy as np

from experiments.speed.measurement import ALL_THREADS, CASES, Measurement, Quantity
from experiments.speed.moves import run_episode
from swarm_gym.vector_env import SwarmVectorEnv

SIZES = (30, 60, 100)
WIDTHS = (8, 64, 512, 4096)
THREADS = tuple(sorted({1, ALL_THREADS}))
SHORT_RUN = 1.5e6  # moves of a measurement, about


def quantities() -> Iterator[Quantity]:
    """All of this group."""
    for size in SIZES:
        yield Quantity(f"single environment, {size} members", "steps/s", single(size))
        for width in WIDTHS:
            for threads in THREADS:
                yield Quantity(name(width, size, threads), "steps/s", vector(width, size, threads))


def summary(measurements: list[Measurement]) -> list[Measurement]:  # noqa: ARG001
    """Nothing follows."""
    return []


def name(width: int, size: int, threads: int) -> str:
    """Of a quantity on vector environments."""
    return f"{width} swarms of {size} members, {threads} thread{'s' * (threads > 1)}"


def single(size: int) -> Callable[[], float]:
    """One environment made by `gymnasium.make`, case 1, constant size."""
    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1", initial_population_size=size)

    def once() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        run_episode(env, np.array([float(size), 0.0]))
        return 100 / (time.perf_counter() - begin)

    return once


def vector(width: int, size: int, threads: int) -> Callable[[], float]:
    """A native vector environment over the three cases, constant size, a few iterations."""
    actions = np.tile([float(size), 0.0], (width, 1))
    steps = int(min(100, max(2, SHORT_RUN / (width * size**2 / 2))))

    def once() -> float:
        env = SwarmVectorEnv(width, scenario=list(CASES), initial_population_size=size, num_threads=threads)
        env.reset(seed=0)
        env.step(actions)  # touches all memory for the first time
        begin = time.perf_counter()
        for _ in range(steps):
            env.step(actions)
        return steps * width / (time.perf_counter() - begin)

    return once
