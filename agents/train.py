"""Train a controller: `python -m agents.train --help`.

The policy first learns to imitate a hand-designed controller, since plain PPO from scratch collapses to tiny
populations: the price of evaluations is felt at once, their gain a dozen iterations later. PPO then goes on
from there. Training is cut into chunks; everything random in a chunk is seeded from (run seed, chunk), so
that a run that was stopped and resumed equals one that was not.
"""

import argparse
import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field

import tyro

from agents.backends import BackendError, BackendOptions
from agents.backends.many_runs import configs_of_seeds, run_all, train
from agents.runs.folder import RunFolderError
from agents.training.config import TrainConfig
from agents.training.presets import load_preset
from agents.training.run import TrainingRun
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class CommandLine:
    """A training configuration, how many of it to run, and where."""

    config: tyro.conf.OmitArgPrefixes[TrainConfig]
    presets: tuple[str, ...] = ()
    """Train with each of these presets instead of the one."""
    seeds: tuple[int, ...] = ()
    """Train with each of these seeds instead of the one."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def read_command_line(arguments: Sequence[str] | None = None, preset: str | None = None) -> CommandLine:
    """The configuration: that of a preset, or of the one that `--preset` says, changed by the other options.

    Raises:
        PresetError: for a preset that is missing or says what cannot be.
    """
    if preset is None:
        finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
        finder.add_argument("--preset", default=TrainConfig.preset)
        preset = finder.parse_known_args(arguments)[0].preset
    loaded = load_preset(preset)
    given = tyro.cli(CommandLine, default=CommandLine(loaded), description=__doc__, args=arguments)
    # A preset that is given as a file is called by the file's name.
    return dataclasses.replace(given, config=dataclasses.replace(given.config, preset=loaded.preset))


def read_configs(given: CommandLine, arguments: Sequence[str] | None = None) -> list[TrainConfig]:
    """The configurations of all runs that a command line asks for.

    Raises:
        PresetError: for a preset that is missing or says what cannot be.
        ValueError: for a preset or a seed that is there twice.
    """
    configs = [given.config]
    if given.presets:
        configs = [read_command_line(arguments, preset).config for preset in given.presets]
        names = [config.preset for config in configs]
        if len(set(names)) < len(names):
            raise ValueError(f"--presets: each one once, got {' '.join(names)}")
        if given.config.name:
            configs = [
                dataclasses.replace(config, name=f"{config.name}/{config.preset}") for config in configs
            ]
    if given.seeds:
        configs = [one for config in configs for one in configs_of_seeds(config, given.seeds)]
    return configs


def main(arguments: Sequence[str] | None = None) -> None:
    """Train as the command line says."""
    with command(
        RunFolderError,
        BackendError,
        MissingExtraError,
        kept="--resume goes on from the last checkpoint, if there is one",
    ):
        given = read_command_line(arguments)
        given.where.check()
        configs = read_configs(given, arguments)
        if given.presets or given.seeds or given.where.elsewhere:
            controllers = [name for c in configs for name in (c.base, c.reference, c.warm_start)]
            run_all(train, configs, given.where, controllers)
            return
        best = TrainingRun(given.config).run()
    print(f"best policy by validation: {best}\nuse it as controller learned:{best}")


if __name__ == "__main__":
    main()
