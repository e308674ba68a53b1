"""Compare optimizers, encodings and sources over terrain: `python -m experiments.terrain`.

Runs are kept in a folder, and a later call goes on from there. The first call makes the height maps of the
terrains, which takes some seconds for each.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.documents.digests import digests_of_terrain
from experiments.documents.records import commits_in, record_of, write_record
from experiments.studies.terrain.measured_costs import Asked, measure_all
from experiments.studies.terrain.rows import rows
from experiments.studies.terrain.tables_of_costs import tables
from swarm_gym.checks import look_up, require_integer
from swarm_gym.command import command
from swarm_gym.problem.terrain.table import COSTS
from swarm_gym.scenarios import expand_name


@dataclass(frozen=True)
class TerrainConfig:
    """Options of the command."""

    output: Path = Path("results/terrain")
    """Folder that tables are written to; its folder `runs` keeps the costs of all runs."""
    terrains: tuple[str, ...] = ("terrain:test:0-55",)
    """Names of terrains or ranges of them, e.g. terrain:test:0-3 terrain:test:28-31."""
    cost: str = "metabox"
    """Cost of flights: metabox, the published one, or documented."""
    evaluations: tuple[int, ...] = (2_500, 20_000)
    """Evaluation budgets; tables are ordered by the first."""
    runs: int = 5
    """Number of runs of each row on each terrain."""
    rows: tuple[str, ...] = ()
    """Parts of the names of rows to run, e.g. L-SHADE guided; by default all rows."""


def write(config: TerrainConfig) -> list[Path]:
    """Run what is missing, write all tables, and return their files.

    Raises:
        SettingError: if there is no run, or a budget that no optimizer has a population for.
        UnknownNameError: for a cost or a terrain that does not exist.
        ValueError: if no row has such a name.
    """
    require_integer("runs", config.runs, 1)
    look_up("cost", config.cost, COSTS)
    for evaluations in config.evaluations:
        require_integer("evaluations", evaluations, 100)
    chosen = [row for row in rows() if not config.rows or any(part in row.name for part in config.rows)]
    if not chosen:
        names = "; ".join(row.name for row in rows())
        raise ValueError(f"--rows {' '.join(config.rows)}: no row has such a name; choose parts of {names}")
    terrains = [name for given in config.terrains for name in expand_name(given)]
    asked = Asked(config.cost, tuple(config.evaluations), config.runs)
    measured = measure_all(chosen, terrains, asked, config.output / "runs")
    made = tables(measured, terrains, asked)
    commits = commits_in((config.output / "runs").glob("*.json"))
    write_record(record_of(f"terrain-{config.output.name}", commits, digests_of_terrain()), config.output)
    for table in made:
        table.write(config.output)
    return [config.output / f"{table.name}.md" for table in made]


def main() -> None:
    """Write tables, and print where they are."""
    config = tyro.cli(TerrainConfig, description=__doc__)
    with command(ValueError):
        for file in write(config):
            print(file)


if __name__ == "__main__":
    main()
