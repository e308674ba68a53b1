"""Compare optimizers, encodings, sources and controllers over terrain: `python -m experiments.terrain`.

Runs are kept in a folder, and a later call goes on from there, also one that asks for more runs. The first
call makes the height maps of the terrains, which takes some seconds for each.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
import tyro

from experiments.documents.digests import digests_of_terrain
from experiments.documents.records import commits_in, record_of, write_record
from experiments.speed.beside_metabox import table_beside_metabox
from experiments.studies.terrain import library_runs
from experiments.studies.terrain.best_known import collect, least_costs
from experiments.studies.terrain.controllers_of_terrain import rows
from experiments.studies.terrain.measured_costs import Asked, Floats, measure_all
from experiments.studies.terrain.rows import SIZES, AnyRow, ControlledRow, PeerRow, Row
from experiments.studies.terrain.table_of_control import objective, table_of_control
from experiments.studies.terrain.tables_of_costs import best_costs, listed, tables
from experiments.tables import Table
from swarm_gym.checks import look_up, require_integer
from swarm_gym.command import command
from swarm_gym.problem.terrain.table import COSTS
from swarm_gym.scenarios import TerrainScenario, expand_name, make_scenario


@dataclass(frozen=True)
class TerrainConfig:
    """Options of the command."""

    output: Path = Path("results/terrain")
    """Folder that tables are written to."""
    runs_folder: Path | None = None
    """Folder that keeps the costs of all runs, which several tables may share; by default the folder `runs`
    in the output."""
    terrains: tuple[str, ...] = ("terrain:test:0-55",)
    """Names of terrains or ranges of them, e.g. terrain:test:0-3 terrain:test:28-31."""
    validation: str = "terrain:validation:0-23"
    """Terrains on which the best rule or blind controller is chosen, a name with a range."""
    cost: str = "metabox"
    """Cost of flights: metabox, the published one, or documented."""
    evaluations: tuple[int, ...] = (2_500, 20_000)
    """Evaluation budgets; tables are ordered by the first."""
    runs: int = 5
    """Number of runs of each row on each terrain."""
    peer_runs: int = 5
    """Number of runs of each row of another library on each terrain."""
    policy_runs: int | None = None
    """Number of runs of each policy of a row on each terrain; by default as many as `runs`."""
    rows: tuple[str, ...] = ()
    """Parts of the names of rows to run, e.g. L-SHADE guided; by default all rows."""
    without: tuple[str, ...] = ()
    """Parts of the names of rows to leave out, e.g. learned."""
    keep_best: bool = False
    """Replace best known flights by better ones of these runs, in the file of the study."""
    keep_libraries: bool = False
    """Add the runs of other libraries from 20,000 evaluations on to the file of the study, from which later
    calls take them."""
    beside_metabox: bool = False
    """Measure the cost beside MetaBox's code, in one run, instead of running rows."""


def write(config: TerrainConfig) -> list[Path]:
    """Run what is missing, write all tables, and return their files.

    Raises:
        SettingError: if there is no run, or a budget that no optimizer has a population for.
        UnknownNameError: for a cost or a terrain that does not exist.
        ValueError: if no row has such a name, or MetaBox's code is asked for and missing.
    """
    if config.beside_metabox:
        table = table_beside_metabox()
        table.write(config.output)
        return [config.output / f"{table.name}.md"]
    require_integer("runs", config.runs, 1)
    require_integer("peer_runs", config.peer_runs, 1)
    if config.policy_runs is not None:
        require_integer("policy_runs", config.policy_runs, 1, config.runs)
    look_up("cost", config.cost, COSTS)
    for evaluations in config.evaluations:
        require_integer("evaluations", evaluations, 100)
    chosen = _chosen(config)
    terrains = [name for given in config.terrains for name in expand_name(given)]
    asked = Asked(config.cost, tuple(config.evaluations), config.runs, config.peer_runs, config.policy_runs)
    folder = config.runs_folder or config.output / "runs"
    used: set[Path] = set()
    measured = measure_all(chosen, terrains, asked, folder, used)
    if config.keep_best:
        collect(folder, terrains)
    if config.keep_libraries:
        library_runs.keep(used, [row.name for row in chosen if isinstance(row, PeerRow)])
    known = least_costs(config.cost, terrains)
    made = [
        *tables(measured, terrains, asked, best_costs(measured, known)),
        *_control(config, chosen, measured, asked, terrains, known, folder, used),
    ]
    commits = commits_in(sorted(used))
    digests = digests_of_terrain(row.name for row in chosen)
    write_record(record_of(f"terrain-{config.output.name}", commits, digests), config.output)
    for table in made:
        table.write(config.output)
    return [config.output / f"{table.name}.md" for table in made]


def _chosen(config: TerrainConfig) -> list[AnyRow]:
    every = rows()
    wanted = [row for row in every if not config.rows or any(part in row.name for part in config.rows)]
    chosen = [row for row in wanted if not any(part in row.name for part in config.without)]
    if not chosen:
        names = "; ".join(row.name for row in every)
        raise ValueError(f"--rows {' '.join(config.rows)}: no row has such a name; choose parts of {names}")
    return chosen


def _control(
    config: TerrainConfig,
    chosen: Sequence[AnyRow],
    measured: dict[str, Floats],
    asked: Asked,
    terrains: Sequence[str],
    known: Floats,
    folder: Path,
    used: set[Path],
) -> list[Table]:
    """Return the table of controllers, if policies have rivals."""
    controlled = [row for row in chosen if isinstance(row, ControlledRow | Row) and row.source == "guided"]
    controlled.sort(key=lambda row: ([*SIZES].index(row.optimizer), row.encoding != "waypoints"))
    learned = {row.group for row in controlled if row.is_learned}
    groups: dict[tuple[str, str], list[ControlledRow | Row]] = {}
    for row in controlled:
        if not row.is_learned and row.group in learned:
            groups.setdefault(row.group, []).append(row)
    if not groups:
        return []
    several = [row for own in groups.values() if len(own) > 1 for row in own]  # among which one is chosen
    asked_once = asked._replace(evaluations=asked.evaluations[:1])
    found = measure_all(several, expand_name(config.validation), asked_once, folder, used)
    rivals = {
        group: min(own, key=lambda row: objective(found[row.name])).name if len(own) > 1 else own[0].name
        for group, own in groups.items()
    }
    threats = [len(cast(TerrainScenario, make_scenario(name)).threats) for name in terrains]
    are_tests = all(name.startswith("terrain:test:") for name in terrains)
    words = "test terrains" if are_tests else f"terrains ({listed(terrains)})"
    if np.isinf(known).all():
        words += ", whose best known flights are those of these runs,"
    best = best_costs(measured, known)
    return [table_of_control(controlled, measured, rivals, asked, best, threats, words)]


def main() -> None:
    """Write tables, and print where they are."""
    config = tyro.cli(TerrainConfig, description=__doc__)
    with command(ValueError):
        for file in write(config):
            print(file)


if __name__ == "__main__":
    main()
