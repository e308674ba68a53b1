"""Train a controller: `python -m agents.train --help`.

The policy first learns to imitate a hand-designed controller, since plain PPO from scratch collapses to tiny
populations: the price of evaluations is felt at once, their gain a dozen iterations later. PPO then goes on
from there. Training is cut into chunks; everything random in a chunk is seeded from (run seed, chunk), so
that a run that was stopped and resumed equals one that was not.
"""

import argparse
import dataclasses
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import tyro

from agents.presets import load_preset
from agents.run_folder import RunFolderError
from agents.train_config import TrainConfig
from agents.training_run import TrainingRun
from agents.training_seeds import configs_of_seeds, describe, train_seeds
from swarm_gym.command import command


@dataclass(frozen=True)
class CommandLine:
    """A training configuration, and how many of it to run."""

    config: tyro.conf.OmitArgPrefixes[TrainConfig]
    seeds: tuple[int, ...] = ()
    """Train with each of these seeds instead of the one, in a process of its own."""
    jobs: int = 1
    """How many of these to run at a time."""


def read_command_line(arguments: Sequence[str] | None = None) -> CommandLine:
    """The configuration: that of `--preset`, changed by the other options.

    Raises:
        PresetError: for a preset that is missing or says what cannot be.
    """
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--preset", default=TrainConfig.preset)
    preset = load_preset(finder.parse_known_args(arguments)[0].preset)
    given = tyro.cli(CommandLine, default=CommandLine(preset), description=__doc__, args=arguments)
    # A preset that is given as a file is called by the file's name.
    return dataclasses.replace(given, config=dataclasses.replace(given.config, preset=preset.preset))


def main(arguments: Sequence[str] | None = None) -> None:
    """Train as the command line says."""
    with command(RunFolderError, kept="--resume goes on from the last checkpoint, if there is one"):
        given = read_command_line(arguments)
        if given.seeds:
            _train_seeds(given)
            return
        best = TrainingRun(given.config).run()
    print(f"best policy by validation: {best}\nuse it as controller learned:{best}")


def _train_seeds(given: CommandLine) -> None:
    failed = 0
    for outcome in train_seeds(configs_of_seeds(given.config, given.seeds), given.jobs):
        print(describe(outcome), flush=True)
        failed += outcome.best is None
    if failed:
        sys.exit(f"error: {failed} of {len(given.seeds)} runs failed; --resume goes on with these")


if __name__ == "__main__":
    main()
