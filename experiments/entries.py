"""List, rename, merge and drop entries of a results database: `python -m experiments.entries --help`.

An entry is all runs of one controller. `list` shows them. `rename` gives one another name, `drop` deletes
one, and `merge` copies the runs that a database lacks from another one. `carry-over` prepares a database of
an earlier version for this one. Each command changes all of it or nothing.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from experiments.runs import entries
from experiments.runs.database import Results, ResultsError
from experiments.runs.earlier_identities import CarriedOver, carry_over
from experiments.runs.entries import EntryError
from swarm_gym.command import command

# Columns of `list`; names come last, since they can be long.
ROW = "{:8}  {:>9}  {:>9}  {:10}  {}"
HEAD = ROW.format("digest", "runs", "scenarios", "commits", "name")

File = Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
Name = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME")]


@dataclass(frozen=True)
class List:
    """Show the entries of a database as a table: digest, runs, scenarios, commits, name."""

    database: File
    """Results database, e.g. results/paper.sqlite."""


@dataclass(frozen=True)
class Rename:
    """Give an entry another name."""

    database: File
    """Results database, e.g. results/paper.sqlite."""
    name: Name
    """Entry to rename, as `list` shows it."""
    new: Name
    """Name that no entry has yet, e.g. learned:mine/0#first."""


@dataclass(frozen=True)
class Drop:
    """Delete an entry with all of its runs."""

    database: File
    """Results database, e.g. results/paper.sqlite."""
    name: Name
    """Entry to delete, as `list` shows it."""


@dataclass(frozen=True)
class Merge:
    """Copy runs from another database. An entry of another controller under the same name is kept aside."""

    database: File
    """Results database that the runs go to, e.g. results/paper.sqlite."""
    other: File
    """Results database that they come from; it is only read."""


@dataclass(frozen=True)
class CarryOver:
    """Let this version go on with a database of an earlier one, which told controllers apart otherwise."""

    database: File
    """Results database, e.g. results/paper.sqlite. All of its runs are kept."""


def carry_out(config: List | Rename | Drop | Merge | CarryOver) -> list[str]:
    """Carry out a command and return the lines that say what was done.

    Raises:
        ResultsError: if a file cannot be used.
        EntryError: if an entry is missing, or a name taken, or if the databases cannot be merged.
    """
    if isinstance(config, List):
        results = Results.stored(config.database)
        found = entries.entries_of(results.connection)
        results.close()
        return [HEAD, *map(_line, found)] if found else [f"{config.database} has no runs"]
    if not config.database.is_file():
        raise ResultsError(f"{config.database}: there is no such results database")
    other = Results.stored(config.other) if isinstance(config, Merge) else None
    results = Results(config.database)
    try:
        with results.writing() as connection:
            if isinstance(config, Rename):
                count = entries.rename(connection, config.name, config.new)
                return [f"{config.new}: {count} runs, which were those of {config.name}"]
            if isinstance(config, Drop):
                return [f"{config.name}: {entries.drop(connection, config.name)} runs deleted"]
            if isinstance(config, CarryOver):
                return _carried(config.database, carry_over(connection))
            assert other is not None
            copied = entries.merge(connection, other.connection)
            return [f"{name}: {count} runs copied" for name, count in copied.items()]
    finally:
        results.close()
        if other is not None:
            other.close()


def _carried(database: Path, found: CarriedOver) -> list[str]:
    left = [f"{name}: its runs are left as they are ({reason})" for name, reason in found.left.items()]
    return [f"{database}: the runs of {len(found.carried)} controllers go on", *left]


def _line(entry: entries.StoredEntry) -> str:
    runs, scenarios = f"{entry.num_runs:,}", f"{entry.num_scenarios:,}"
    return ROW.format(entry.digest or "-", runs, scenarios, ", ".join(entry.commits), entry.name)


def main() -> None:
    """Carry out the command line."""
    config = tyro.extras.subcommand_cli_from_dict(
        {"list": List, "rename": Rename, "drop": Drop, "merge": Merge, "carry-over": CarryOver},
        description=__doc__,
    )
    with command(ResultsError, EntryError):
        lines = carry_out(config)
    print("\n".join(lines))


if __name__ == "__main__":
    main()
