"""Train controllers, several at once and on clusters: `python -m agents.train --help`.

The policy may first imitate a hand-designed controller (`--warm-start`), since PPO from scratch collapses to
tiny populations: evaluations cost at once, but their gain comes a dozen iterations later. Training is divided
into chunks. All random numbers of a chunk are seeded with (run seed, chunk). So a run that was stopped and
resumed equals one that was not. Example: `python -m agents.train --preset three-cases --seed 0`.
"""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field

import tyro

from agents.backends import BackendError, BackendOptions
from agents.backends.many_runs import configs_of_seeds, run_all
from agents.backends.many_runs import train as train_quietly
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.command_line import KEPT, named_options, train, without_foreign
from swarm_gym.training.config import TrainConfig


@dataclass(frozen=True)
class TrainCommand:
    """A training configuration, further presets and seeds to run it with, and options of the backend."""

    config: tyro.conf.OmitArgPrefixes[TrainConfig]
    presets: tuple[str, ...] = ()
    """Presets to train with, one run each, instead of --preset, e.g. case1 case2; by default --preset."""
    seeds: tuple[int, ...] = ()
    """Seeds to train with, one run each, instead of --seed, e.g. 0 1 2; by default --seed."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def read_command_line(arguments: Sequence[str] | None = None, preset: str | None = None) -> TrainCommand:
    """Return the configuration of a preset, by default of `--preset`, changed by the other options.

    Raises:
        PresetError: for a preset that is missing or invalid.
    """
    named = named_options(arguments, preset)
    left = without_foreign(arguments, named.algorithm.name)
    given = tyro.cli(TrainCommand, default=TrainCommand(named), description=__doc__, args=left)
    # The name of a preset that is given as a file is the file's name.
    return dataclasses.replace(given, config=dataclasses.replace(given.config, preset=named.preset))


def read_configs(given: TrainCommand, arguments: Sequence[str] | None = None) -> list[TrainConfig]:
    """Return the configurations of all runs of a command line.

    Raises:
        PresetError: for a preset that is missing or invalid.
        ValueError: for a repeated preset or seed.
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
    """Train with the options of the command line."""
    with command(RunFolderError, BackendError, MissingExtraError, kept=KEPT):
        given = read_command_line(arguments)
        given.where.check()
        configs = read_configs(given, arguments)
        if given.presets or given.seeds or given.where.elsewhere:
            controllers = [name for c in configs for name in (c.base, c.reference, c.algorithm.warm_start)]
            run_all(train_quietly, configs, given.where, controllers)
        else:
            train(given.config)


if __name__ == "__main__":
    main()
