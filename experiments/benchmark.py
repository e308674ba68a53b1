"""Measure speed: `python -m experiments.benchmark --help`. Keep the machine quiet meanwhile.

Every figure is the median of repeated runs, with the smallest and the largest beside it. Ratios are between
runs of one call of this program.
"""

import json
import platform
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import gymnasium
import numba
import numpy as np
import tyro
from tqdm import tqdm

import swarm_gym  # noqa: F401
from experiments.numpy_firefly import NumpyFirefly
from experiments.tables import Table
from swarm_gym.env import SwarmEnv
from swarm_gym.files import write_atomically
from swarm_gym.problem import Problem
from swarm_gym.scenarios import make_scenario
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.warm_up import warm_up

CASES = ("case1", "case2", "case3")
HEADLINE_SIZE = 60
ALL_THREADS = numba.config.NUMBA_NUM_THREADS


@dataclass(frozen=True)
class BenchmarkConfig:
    """Options of the benchmark."""

    output: Path = Path("results/benchmark.json")
    """Where all figures go; a Markdown table of the most telling ones is written beside."""
    repeats: int = 5
    """Runs per figure."""
    sizes: tuple[int, ...] = (30, 60, 100)
    """Population sizes of the environment figures."""
    widths: tuple[int, ...] = (8, 64, 512)
    """Numbers of swarms of the vector figures."""


@dataclass(frozen=True)
class Figure:
    """One measured quantity."""

    name: str
    unit: str
    median: float
    low: float
    high: float


def measure(name: str, unit: str, repeats: int, once: Callable[[], float]) -> Figure:
    """Median and spread of a quantity over repeated runs, after one that is thrown away."""
    once()
    values = [once() for _ in range(repeats)]
    return Figure(name, unit, float(np.median(values)), min(values), max(values))


def microseconds_per_move(case: str, repair_degree: float) -> Callable[[], float]:
    """A whole FA-60 run of 100 iterations in a single environment, per firefly move with evaluation."""
    env = SwarmEnv(scenario=case, initial_population_size=60)

    def once() -> float:
        _, first = env.reset(seed=0)
        begin = time.perf_counter()
        info = _episode(env, np.array([60.0, repair_degree]))
        spent = time.perf_counter() - begin
        return spent / (info["evaluations"] - first["evaluations"]) * 1e6

    return once


def numpy_microseconds_per_move(case: str) -> Callable[[], float]:
    """The same moves in NumPy, over one iteration of 60 fireflies."""

    def once() -> float:
        swarm = NumpyFirefly(Problem(make_scenario(case)), 60, seed=0)
        before, begin = swarm.evaluations, time.perf_counter()
        swarm.iterate()
        return (time.perf_counter() - begin) / (swarm.evaluations - before) * 1e6

    return once


def milliseconds_per_run(case: str) -> Callable[[], float]:
    """A whole FA-60 run, reset included."""
    env = SwarmEnv(scenario=case, initial_population_size=60)

    def once() -> float:
        begin = time.perf_counter()
        env.reset(seed=0)
        _episode(env, np.array([60.0, 0.0]))
        return (time.perf_counter() - begin) * 1e3

    return once


def single_steps_per_second(size: int) -> Callable[[], float]:
    """One environment made by `gymnasium.make`, case 1, constant size."""
    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1", initial_population_size=size)

    def once() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        _episode(env, np.array([float(size), 0.0]))
        return 100 / (time.perf_counter() - begin)

    return once


def vector_steps_per_second(width: int, size: int, threads: int) -> Callable[[], float]:
    """A native vector environment over the three cases, constant size, a few iterations."""
    env = SwarmVectorEnv(width, scenario=list(CASES), initial_population_size=size, num_threads=threads)
    actions = np.tile([float(size), 0.0], (width, 1))
    steps = max(1, min(100, 60_000_000 // (width * size**2 * 4)))

    def once() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for _ in range(steps):
            env.step(actions)
        return steps * width / (time.perf_counter() - begin)

    return once


def import_seconds() -> float:
    """`import swarm_gym` in a fresh interpreter, less the start of that interpreter."""

    def run(code: str) -> float:
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        return time.perf_counter() - begin

    return run("import swarm_gym") - run("pass")


def run_benchmark(config: BenchmarkConfig) -> list[Figure]:
    """All figures."""
    warm_up()
    plan: list[tuple[str, str, Callable[[], float]]] = [("import swarm_gym", "s", import_seconds)]
    for case in CASES:
        plan += [
            (f"{case}: move with evaluation", "us", microseconds_per_move(case, 0.0)),
            (f"{case}: move with repair and evaluation", "us", microseconds_per_move(case, 0.2)),
            (f"{case}: the same move in NumPy, without repair", "us", numpy_microseconds_per_move(case)),
            (f"{case}: FA-60 run of 100 iterations", "ms", milliseconds_per_run(case)),
        ]
    for size in config.sizes:
        plan.append((f"single environment, {size} members", "steps/s", single_steps_per_second(size)))
        for width in config.widths:
            for threads in sorted({1, ALL_THREADS}):
                plan.append(
                    (
                        f"{width} swarms of {size} members, {threads} thread{'s' * (threads > 1)}",
                        "steps/s",
                        vector_steps_per_second(width, size, threads),
                    )
                )
    figures = [
        measure(name, unit, config.repeats, once)
        for name, unit, once in tqdm(plan, unit="figure", desc="benchmark")
    ]
    return figures + _ratios(figures)


def _ratios(figures: list[Figure]) -> list[Figure]:
    """NumPy's time per move over ours, of the medians."""
    medians = {figure.name: figure.median for figure in figures}
    found = []
    for case in CASES:
        ours = medians[f"{case}: move with evaluation"]
        theirs = medians[f"{case}: the same move in NumPy, without repair"]
        found.append(Figure(f"{case}: NumPy / swarm_gym", "times", *[theirs / ours] * 3))
    return found


def _episode(env: gymnasium.Env, action: np.ndarray) -> dict[str, Any]:
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(action)
    return info


def _table(figures: list[Figure]) -> Table:
    rows = [(f.name, f"{f.median:,.4g}", f"{f.low:,.4g} to {f.high:,.4g}", f.unit) for f in figures]
    return Table(
        "benchmark",
        f"Speed on {platform.machine()}, {ALL_THREADS} threads; Python {platform.python_version()}, "
        f"Numba {version('numba')}, NumPy {version('numpy')}",
        ("quantity", "median", "range", "unit"),
        rows,
    )


def main() -> None:
    """Measure, print and store."""
    config = tyro.cli(BenchmarkConfig, description=__doc__)
    figures = run_benchmark(config)
    table = _table(figures)
    write_atomically(config.output, json.dumps([vars(figure) for figure in figures], indent=1) + "\n")
    headlines = [f for f in figures if "members" not in f.name or f" {HEADLINE_SIZE} members" in f.name]
    write_atomically(config.output.with_suffix(".md"), _table(headlines).markdown())
    print(table.markdown())


if __name__ == "__main__":
    main()
