"""Other readings of the SPSFA paper, on one case with fixed sizes: `python -m experiments.readings --help`.

The default reading of the SPSFA paper does not meet some cells of its tables. This command shows which mean
other readings give.
"""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from tqdm import tqdm

from agents import make_controller
from experiments.runs.labels import label
from experiments.statistics import summarise
from experiments.studies.spsfa.published import FITNESS
from experiments.tables.cell import Cell, Entry
from experiments.tables.table import Row, Table
from swarm_gym.files import write_atomically
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import make_scenario, require_analytic

# Name of the reading, range of y in its first population in map units, and its options of the environment.
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
    """Case of the SPSFA paper to run on: case1, case2 or case3 (the default)."""
    seeds: int = 50
    """Number of seeds per reading and controller, by default 50, e.g. 20."""
    controllers: tuple[str, ...] = ("fixed:60", "fixed:80", "fixed:100")
    """Controllers to run, by default the fixed sizes of the SPSFA paper, e.g. fixed:60 spsfa-tip."""
    output: Path = Path("results/readings.md")
    """Markdown file that the table is written to, by default results/readings.md."""


def compare_readings(config: ReadingsConfig) -> Table:
    """Return mean and minimum of the final fitness under every reading, below those of the SPSFA paper."""
    published = {controller: FITNESS[config.case, controller] for controller in config.controllers}
    of_paper: dict[str, Entry] = {
        label(controller): Cell.of("{value:.1f} ({minimum:.1f})", value=p.mean, minimum=p.minimum)
        for controller, p in published.items()
    }
    rows: list[Row] = [{"reading": "paper", **of_paper}]
    for name, (low, high), options in tqdm(READINGS, unit="reading", desc=config.case):
        scenario = require_analytic(make_scenario(config.case))
        y = scenario.start[1]
        scenario = dataclasses.replace(scenario, initial_range=(low - y, high - y))
        cells: dict[str, Entry] = {}
        for controller in config.controllers:
            episodes = run_episodes(make_controller(controller), scenario, TEST[: config.seeds], **options)
            found = summarise(np.asarray(episodes.final_fitness))
            cells[label(controller)] = Cell.of(
                "{value:.1f} [{low:.1f}, {high:.1f}] ({minimum:.1f})",
                value=found.mean,
                low=found.interval[0],
                high=found.interval[1],
                minimum=found.minimum,
            )
        rows.append({"reading": name, **cells})
    caption = f"Mean final fitness [95 % interval] (minimum) on {config.case}, {config.seeds} seeds"
    return Table.of("readings", caption, rows)


def main() -> None:
    """Compare readings as the command line says; print and store the table."""
    config = tyro.cli(ReadingsConfig, description=__doc__)
    table = compare_readings(config)
    write_atomically(config.output, table.markdown())
    print(table.markdown())


if __name__ == "__main__":
    main()
