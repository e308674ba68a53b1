"""Tune a hand-designed controller: `python -m agents.tune --help`.

The objective is the mean over episodes of log(final gap) plus the price of the evaluations, to be minimised.
The gap is the best fitness minus mu times the length of the straight line. Episodes have training scenarios
and training seeds only. The budget is in environment steps, by default that of a training preset, so that
tuned and learned controllers take the same effort. A run that was stopped and resumed equals one that was
not. Example: `python -m agents.tune --what schedule --preset three-cases`.
"""

import argparse
import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field

import tyro

from agents.backends import BackendError, BackendOptions
from agents.backends.many_runs import configs_of_seeds, run_all, tune
from agents.runs.folder import RunFolderError
from agents.training.presets import load_preset
from agents.tuning.config import TuneConfig
from agents.tuning.run import TuningRun
from agents.tuning.tuners import kind_defaults
from swarm_gym.command import command
from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import MissingExtraError

FROM_PRESET = (
    "preset",
    "total_steps",
    "optimizer",
    "scenarios",
    "min_population_size",
    "max_population_size",
)


@dataclass(frozen=True)
class CommandLine:
    """A tuning configuration, further seeds to run it with, and options of the backend."""

    config: tyro.conf.OmitArgPrefixes[TuneConfig]
    seeds: tuple[int, ...] = ()
    """Seeds to tune with, one run each, instead of --seed, e.g. 0 1 2; by default --seed."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def read_command_line(arguments: Sequence[str] | None = None) -> CommandLine:
    """Return the configuration of `--what` and `--preset`, changed by the other options."""
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--what", default=TuneConfig.what)
    finder.add_argument("--preset", default=TuneConfig.preset)
    found = finder.parse_known_args(arguments)[0]
    preset = load_preset(found.preset)
    shared = {name: getattr(preset, name) for name in FROM_PRESET}
    defaults = dataclasses.replace(TuneConfig(**kind_defaults(found.what)), **shared)
    return tyro.cli(CommandLine, default=CommandLine(defaults), description=__doc__, args=arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    """Tune with the options of the command line."""
    with command(
        RunFolderError,
        BackendError,
        MissingExtraError,
        kept="--resume continues after the last round, if there is one",
    ):
        given = read_command_line(arguments)
        given.where.check()
        if given.seeds and given.config.output:
            raise ValueError(
                f"--output {given.config.output}: one file cannot hold the several results of --seeds"
            )
        if given.seeds or given.where.elsewhere:
            configs = configs_of_seeds(given.config, given.seeds) if given.seeds else [given.config]
            run_all(tune, configs, given.where)
            return
        run = TuningRun(given.config)
        result = run.run()
    name = ControllerName.of(run.tuner.family, str(result))
    print(f"tuned in {run.num_steps} steps: {result}\nuse it as controller {name}")


if __name__ == "__main__":
    main()
