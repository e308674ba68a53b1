"""Measure speed: `python -m experiments.benchmark --help`. Keep the machine quiet meanwhile.

Every figure is the median of repeated runs, with the smallest and the largest beside it. Ratios are between
runs of one call of this program.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import tyro
from tqdm import tqdm

from experiments.speed import environments, growth, moves, rendering, start, threads, training
from experiments.speed.measurement import (
    Measurement,
    Quantity,
    machine,
    measure,
    read_measurements,
    write_measurements,
)
from experiments.speed.page import write_page
from swarm_gym.checks import look_up
from swarm_gym.command import command
from swarm_gym.warm_up import warm_up


@dataclass(frozen=True)
class Group:
    """What a file of `experiments.speed` measures, and what follows from that."""

    quantities: Callable[[], Iterator[Quantity]]
    summary: Callable[[list[Measurement]], list[Measurement]] = lambda _: []


GROUPS: dict[str, Group] = {
    "moves": Group(moves.quantities, moves.summary),
    "environments": Group(environments.quantities),
    "threads": Group(threads.quantities),
    "growth": Group(growth.quantities, growth.summary),
    "start": Group(start.quantities),
    "training": Group(training.quantities),
    "rendering": Group(rendering.quantities),
}


@dataclass(frozen=True)
class BenchmarkConfig:
    """Options of the benchmark."""

    output: Path = Path("results/benchmark")
    """Where benchmark.json, a page with all tables and the figure of growth go."""
    groups: tuple[str, ...] = tuple(GROUPS)
    """What to measure; other groups that were measured with the same version are kept."""
    repeats: int = 5
    """Runs per figure."""


def run_benchmark(config: BenchmarkConfig) -> dict[str, list[Measurement]]:
    """All measurements, by group.

    Raises:
        UnknownNameError: for a group that is not there.
    """
    groups = {name: look_up("group", name, GROUPS) for name in config.groups}
    warm_up()
    plan = [(name, quantity) for name, group in groups.items() for quantity in group.quantities()]
    measured: dict[str, list[Measurement]] = {name: [] for name in groups}
    with tqdm(plan, unit="figure", desc="benchmark") as bar:
        for name, quantity in bar:
            bar.set_postfix_str(quantity.name)
            measured[name].append(measure(quantity, config.repeats))
    return {name: measured[name] + group.summary(measured[name]) for name, group in groups.items()}


def measured_before(file: Path) -> dict[str, list[Measurement]]:
    """Groups in the file, where they are of the same machine and version; they are kept."""
    if not file.exists():
        return {}
    there, groups = read_measurements(file)
    return groups if there == machine() else {}


def main() -> None:
    """Measure, print and store."""
    config = tyro.cli(BenchmarkConfig, description=__doc__)
    with command():
        measured = run_benchmark(config)
        file = config.output / "benchmark.json"
        write_measurements(file, measured_before(file) | measured)
        page = write_page(config.output)
    print(page.read_text(encoding="utf-8"))
    print(f"written: {page}")


if __name__ == "__main__":
    main()
