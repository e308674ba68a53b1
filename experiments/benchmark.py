"""Measure speed: `python -m experiments.benchmark --help`. Keep the machine quiet meanwhile.

Every number is the median of repeated runs, with the smallest and the largest beside it. Ratios compare runs
of the same call of this program.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import tyro
from tqdm import tqdm

from experiments.speed import environments, growth, moves, rendering, start, threads, training
from experiments.speed.benchmark_page import write_page
from experiments.speed.measurement import Measurement, Quantity, measure, measured_before, write_measurements
from swarm_gym.checks import look_up
from swarm_gym.command import command
from swarm_gym.warm_up import warm_up


@dataclass(frozen=True)
class BenchmarkGroup:
    """A group of the benchmark.

    Attributes:
        quantities: function that yields the quantities to measure.
        summary: function that computes further numbers from their measurements.
    """

    quantities: Callable[[], Iterator[Quantity]]
    summary: Callable[[list[Measurement]], list[Measurement]] = lambda _: []


GROUPS: dict[str, BenchmarkGroup] = {
    "moves": BenchmarkGroup(moves.quantities, moves.summary),
    "environments": BenchmarkGroup(environments.quantities),
    "threads": BenchmarkGroup(threads.quantities),
    "growth": BenchmarkGroup(growth.quantities, growth.summary),
    "start": BenchmarkGroup(start.quantities),
    "training": BenchmarkGroup(training.quantities),
    "rendering": BenchmarkGroup(rendering.quantities),
}


def measure_groups(names: Sequence[str], repeats: int) -> dict[str, list[Measurement]]:
    """Return the measurements of groups, by their names.

    Args:
        names: names in `GROUPS`.
        repeats: number of runs for each quantity that does not have its own.

    Raises:
        UnknownNameError: if there is no group of a name.
    """
    groups = {name: look_up("group", name, GROUPS) for name in names}
    warm_up()
    plan = [(name, quantity) for name, group in groups.items() for quantity in group.quantities()]
    measured: dict[str, list[Measurement]] = {name: [] for name in groups}
    with tqdm(plan, unit="figure", desc="benchmark") as bar:
        for name, quantity in bar:
            bar.set_postfix_str(quantity.name)
            measured[name].append(measure(quantity, repeats))
    return {name: measured[name] + group.summary(measured[name]) for name, group in groups.items()}


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
