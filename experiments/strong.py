"""Compare CMA-ES and L-SHADE with the published table of MetaBox-v2: `python -m experiments.strong`.

The rows are constants, rules and trained policies. Their runs are kept in a folder, and a later call goes on
from there. With --table repeated, some rows run with other seeds. With --table bbob, rows of CMA-ES run on
the functions of BBOB in several dimensions. With --table pycma, CMA-ES runs next to its author's library, and
with --table libraries next to several.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

from experiments.documents.digests import digests_of_results, digests_of_strong, results_key
from experiments.documents.records import commits_in, record_of, write_record
from experiments.plots.style import settings, write_figure
from experiments.studies.strong.beside_libraries import OURS, beside_libraries, run_all
from experiments.studies.strong.beside_pycma import beside_pycma, run_both
from experiments.studies.strong.decisions import choose, draw_decisions
from experiments.studies.strong.entrants import (
    CMA_ES,
    TOGETHER,
    WITHOUT_SIGHT,
    Entrant,
    entrants,
    entrants_on_bbob,
)
from experiments.studies.strong.grounds import COMPARED, OTHERS, REPEATED, bbob
from experiments.studies.strong.measured_gaps import measure_all
from experiments.studies.strong.on_bbob import on_bbob
from experiments.studies.strong.published import RUNS
from experiments.studies.strong.tables_of_gaps import REPEATED_ROWS, repeated, tables
from swarm_gym.checks import require_integer
from swarm_gym.command import command

BESIDE = 10  # dimension of the functions


@dataclass(frozen=True)
class StrongConfig:
    """Options of the command."""

    output: Path = Path("results/strong-optimizers")
    """Folder that tables are written to; its folders keep the gaps of all runs."""
    runs: int = RUNS
    """Number of runs of each training seed on each function; the published table has 51. In 3 and 40
    dimensions of BBOB it is half of that."""
    rows: tuple[str, ...] = ()
    """Parts of the names of rows to run, e.g. BIPOP 'lambda 40'; by default all rows."""
    table: Literal["metabox", "repeated", "bbob", "pycma", "libraries"] = "metabox"
    """Table to make: all rows on MetaBox's functions; some of them with other seeds; rows of CMA-ES on the 24
    functions of BBOB in 3, 5, 10, 20 and 40 dimensions; BIPOP next to pycma's in 10 dimensions; or rows of
    both optimizers next to those of other libraries."""


def write(config: StrongConfig) -> list[Path]:
    """Run what is missing, write all tables, and return the files of the tables.

    Raises:
        SettingError: if there are fewer than two runs.
        ValueError: if no row has such a name.
    """
    require_integer("runs", config.runs, 2)
    if config.table == "repeated":
        return _write_repeated(config)
    if config.table == "bbob":
        return _write_on_bbob(config)
    if config.table == "pycma":
        return _write_beside_pycma(config)
    if config.table == "libraries":
        return _write_beside_libraries(config)
    chosen = _chosen(config, entrants())
    made = tables(measure_all(chosen, config.runs, config.output / "runs"))
    commits = commits_in((config.output / "runs").glob("*.json"))
    write_record(record_of("strong-optimizers", commits, digests_of_strong()), config.output)
    for table in made:
        table.write(config.output)
    policies = {
        one.name: choose(one, config.output / "sizes")
        for one in chosen
        if one.limits is None and one.optimizer == CMA_ES and not one.name.endswith((TOGETHER, WITHOUT_SIGHT))
    }
    if policies:
        with settings():
            write_figure(draw_decisions(policies), config.output, "decisions")
    return [config.output / f"{table.name}.md" for table in made]


def _write_repeated(config: StrongConfig) -> list[Path]:
    folder = config.output / "repeated"
    chosen = _chosen(config, [one for one in entrants() if one.name in REPEATED_ROWS])
    table = repeated(measure_all(chosen, config.runs, folder, REPEATED), REPEATED.first_seed)
    commits = commits_in(folder.glob("*.json"))
    write_record(record_of("strong-repeated", commits, _digests(chosen)), config.output)
    table.write(config.output)
    return [config.output / f"{table.name}.md"]


def _write_on_bbob(config: StrongConfig) -> list[Path]:
    folder = config.output / "on-bbob"
    runs = dict.fromkeys(COMPARED, config.runs) | dict.fromkeys(OTHERS, max(config.runs // 2, 2))
    measured = {
        d: measure_all(_chosen(config, entrants_on_bbob(d)), number, folder, bbob(d))
        for d, number in runs.items()
    }
    table = on_bbob(measured)
    write_record(
        record_of(
            "strong-on-bbob", commits_in(folder.glob("*.json")), _digests(entrants_on_bbob(COMPARED[0]))
        ),
        config.output,
    )
    table.write(config.output)
    return [config.output / f"{table.name}.md"]


def _write_beside_pycma(config: StrongConfig) -> list[Path]:
    folder, ground = config.output / "beside-pycma", bbob(BESIDE)
    table = beside_pycma(run_both(ground, BESIDE, config.runs, folder), BESIDE, ground.evaluations)
    table.write(config.output)
    record = record_of("beside-pycma", commits_in(folder.glob("*.json")), digests_of_results([CMA_ES]))
    write_record(record, config.output)
    return [config.output / f"{table.name}.md"]


def _write_beside_libraries(config: StrongConfig) -> list[Path]:
    folder, ground = config.output / "beside-libraries", bbob(BESIDE)
    table = beside_libraries(run_all(ground, config.runs, folder), ground.evaluations)
    table.write(config.output)
    own = [row for row in entrants() if row.name in OURS]
    write_record(
        record_of("beside-libraries", commits_in(folder.glob("*.json")), _digests(own)), config.output
    )
    return [config.output / f"{table.name}.md"]


def _digests(rows: Sequence[Entrant]) -> dict[str, str]:
    """Return the digests of these rows and of their optimizers alone."""
    names = {row.name for row in rows} | {results_key(row.optimizer) for row in rows}
    return {name: digest for name, digest in digests_of_strong().items() if name in names}


def _chosen(config: StrongConfig, every: Sequence[Entrant]) -> list[Entrant]:
    chosen = [one for one in every if not config.rows or any(part in one.name for part in config.rows)]
    if not chosen:
        names = ", ".join(one.name for one in every)
        raise ValueError(f"--rows {' '.join(config.rows)}: no row has such a name; choose parts of {names}")
    return chosen


def main() -> None:
    """Write tables, and print where they are."""
    config = tyro.cli(StrongConfig, description=__doc__)
    with command(ValueError):
        for file in write(config):
            print(file)


if __name__ == "__main__":
    main()
