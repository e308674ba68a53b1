"""Compare controllers on OneMax with the known optimum: `python -m experiments.onemax`.

Expectations are exact; those of long strings take minutes for each policy. Simulated rows take 1,000 runs
each, and the schedule over iterations is tuned first. `--tables` makes some of the tables only.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.documents.digests import digests_of_one_max
from experiments.documents.records import record_of, write_record
from experiments.studies.onemax import double_dqn, share_schedules
from experiments.studies.onemax.pictures import write_pictures
from experiments.studies.onemax.speed import speed
from experiments.studies.onemax.tables import tables
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.provenance import git_commit


@dataclass(frozen=True)
class OneMaxConfig:
    """Options of the command."""

    output: Path = Path("results/known-optimum")
    """Folder that tables and pictures are written to."""
    published: Path | None = None
    """Folder of a checkout of github.com/taindp98/OneMax-MPDAC, whose environment is timed beside this one.
    Keep the machine quiet meanwhile. By default nothing is timed."""
    only_speed: bool = False
    """Time the environments only, e.g. again on another machine."""
    tables: tuple[str, ...] = ()
    """Tables to write instead of all of them and the pictures, e.g. simulations readings."""
    tune_schedules: bool = False
    """Tune the schedules over the share of zeros again, which ship with the package, and nothing else."""
    train_double_dqn: bool = False
    """Train the policies of double DQN again, which ship with the study, and nothing else; takes an hour."""


def write(config: OneMaxConfig) -> list[Path]:
    """Write all tables and pictures, and return the files of the tables.

    Raises:
        MissingExtraError: if the published environment cannot be imported.
        UnknownNameError: if there is no table of a name.
        ValueError: if nothing is asked for.
    """
    if config.tune_schedules:
        return [share_schedules.ship()]
    if config.train_double_dqn:
        return [double_dqn.ship()]
    made = [] if config.only_speed else tables(config.tables)
    if config.published is not None:
        made.append(speed(config.published))
    if not made:
        raise ValueError("--only-speed: name the checkout to compare with by --published")
    for table in made:
        table.write(config.output)
    if not (config.only_speed or config.tables):
        write_pictures(config.output)
        write_record(record_of("known-optimum", [git_commit()], digests_of_one_max()), config.output)
    return [config.output / f"{table.name}.md" for table in made]


def main() -> None:
    """Write tables and pictures, and print where they are."""
    config = tyro.cli(OneMaxConfig, description=__doc__)
    with command(MissingExtraError):
        for file in write(config):
            print(file)


if __name__ == "__main__":
    main()
