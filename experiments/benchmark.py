"""Measure speed: `python -m experiments.benchmark --help`. Keep the machine quiet meanwhile.

Every number is the median of repeated runs, with the smallest and the largest beside it. Ratios compare runs
of the same call of this program.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.speed import environments, growth, moves, start, threads, training
from experiments.speed.benchmark_page import write_page
from experiments.speed.measurement import (
    BenchmarkGroup,
    Measurement,
    measure_all,
    measured_before,
    write_measurements,
)
from swarm_gym.checks import look_up
from swarm_gym.command import command
from swarm_gym.warm_up import warm_up

GROUPS: dict[str, BenchmarkGroup] = {
    "moves": BenchmarkGroup(moves.quantities, moves.summary),
    "environments": BenchmarkGroup(environments.quantities),
    "threads": BenchmarkGroup(threads.quantities),
    "growth": BenchmarkGroup(growth.quantities, growth.summary),
    "start": BenchmarkGroup(start.quantities),
    "training": BenchmarkGroup(training.quantities),
    "rendering": BenchmarkGroup(environments.picture_quantities),
}


def measure_groups(names: Sequence[str], repeats: int) -> dict[str, list[Measurement]]:
    """Return the measurements of groups, by their names in `GROUPS`; `measure_all` describes `repeats`.

    Raises:
        UnknownNameError: if there is no group of a name.
    """
    groups = {name: look_up("group", name, GROUPS) for name in names}
    warm_up()
    return measure_all(groups, repeats)


@dataclass(frozen=True)
class BenchmarkConfig:
    """Options of the benchmark."""

    output: Path = Path("results/benchmark")
    """Folder for benchmark.json, a page with all tables, and the figure of growth."""
    groups: tuple[str, ...] = tuple(GROUPS)
    """Groups to measure, e.g. moves; other groups that were measured with the same version are kept."""
    repeats: int = 5
    """Number of runs for each number."""


def main() -> None:
    """Measure, then print and store the tables."""
    config = tyro.cli(BenchmarkConfig, description=__doc__)
    with command():
        measured = measure_groups(config.groups, config.repeats)
        file = config.output / "benchmark.json"
        write_measurements(file, measured_before(file) | measured)
        page = write_page(config.output)
    print(page.read_text(encoding="utf-8"))
    print(f"written: {page}")


if __name__ == "__main__":
    main()
