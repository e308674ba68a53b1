"""Other readings of the paper, on one case with fixed sizes: `python -m experiments.readings --help`.

For cells of the paper's tables that the default readings do not meet: what the mean would be under others.
"""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from tqdm import tqdm

from agents import make_controller
from agents.evaluation.rollout import run_episodes
from agents.runs.seeds import TEST
from experiments.runs.labels import label
from experiments.statistics import summarise
from experiments.studies.spsfa.published import FITNESS
from experiments.tables import Table
from swarm_gym.files import write_atomically
from swarm_gym.scenarios import make_scenario, require_analytic

# Name of the reading, its first population (y from, y to), and its options of the environment.
READINGS: list[tuple[str, tuple[float, float], dict[str, Any]]] = [
    ("default: y in [120, 480], 31 waypoints", (120, 480), {}),
    ("y in [100, 500]", (100, 500), {}),
    ("y in [60, 540]", (60, 540), {}),
    ("y in [0, 600]", (0, 600), {}),
    ("20 waypoints", (120, 480), {"num_waypoints": 20}),
    ("30 waypoints", (120, 480), {"num_waypoints": 30}),
    ("40 waypoints", (120, 480), {"num_waypoints": 40}),
    ("y in [60, 540], 20 waypoints", (60, 540), {"num_waypoints": 20}),
]


@dataclass(frozen=True)
class ReadingsConfig:
    """Options of the comparison."""

    case: str = "case3"
    """Which case of the paper."""
    seeds: int = 50
    """Seeds per reading and size."""
    controllers: tuple[str, ...] = ("fixed:60", "fixed:80", "fixed:100")
    """Controllers to run."""
    output: Path = Path("results/readings.md")
    """Where the table goes."""


def compare_readings(config: ReadingsConfig) -> Table:
    """Mean and minimum of the final fitness under every reading, below the paper's."""
    printed = [FITNESS[config.case, controller] for controller in config.controllers]
    rows = [("paper", *(f"{row.mean:.1f} ({row.minimum:.1f})" for row in printed))]
    for name, (low, high), options in tqdm(READINGS, unit="reading", desc=config.case):
        scenario = require_analytic(make_scenario(config.case))
        y = scenario.start[1]
        scenario = dataclasses.replace(scenario, initial_range=(low - y, high - y))
        cells = []
        for controller in config.controllers:
            episodes = run_episodes(make_controller(controller), scenario, TEST[: config.seeds], **options)
            found = summarise(np.asarray(episodes.final_fitness))
            cells.append(
                f"{found.mean:.1f} [{found.interval[0]:.1f}, {found.interval[1]:.1f}] ({found.minimum:.1f})"
            )
        rows.append((name, *cells))
    return Table(
        "readings",
        f"Mean final fitness [95 % interval] (minimum) on {config.case}, {config.seeds} seeds",
        ("reading", *map(label, config.controllers)),
        rows,
    )


def main() -> None:
    """Compare as the command line says, print and store."""
    config = tyro.cli(ReadingsConfig, description=__doc__)
    table = compare_readings(config)
    write_atomically(config.output, table.markdown())
    print(table.markdown())


if __name__ == "__main__":
    main()
