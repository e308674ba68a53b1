"""Measure speed: `python -m experiments.benchmark --help`. Keep the machine quiet meanwhile.

Every number is the median of repeated runs, with the smallest and the largest beside it. Ratios compare runs
of the same call of this program.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.speed.groups import GROUPS, measure_groups
from experiments.speed.measurement import measured_before, write_measurements
from experiments.speed.page import write_page
from swarm_gym.command import command


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
