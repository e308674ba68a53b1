"""Tune a hand-designed controller: `python -m agents.tune --help`.

What is minimised is the mean over episodes of log(final gap) plus the price of the evaluations; the gap is
the best fitness above mu times the straight line. Episodes have training scenarios and training seeds only.
The budget is in environment steps, by default that of a training preset, so that tuned and learned
controllers have cost the same. A run that was stopped and resumed equals one that was not.
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
    """A tuning configuration, how many of it to run, and where."""

    config: tyro.conf.OmitArgPrefixes[TuneConfig]
    seeds: tuple[int, ...] = ()
    """Tune with each of these seeds instead of the one."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def read_command_line(arguments: Sequence[str] | None = None) -> CommandLine:
    """The configuration: that of `--what` and `--preset`, changed by the other options."""
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--what", default=TuneConfig.what)
    finder.add_argument("--preset", default=TuneConfig.preset)
    found = finder.parse_known_args(arguments)[0]
    preset = load_preset(found.preset)
    shared = {name: getattr(preset, name) for name in FROM_PRESET}
    defaults = dataclasses.replace(TuneConfig(**kind_defaults(found.what)), **shared)
    return tyro.cli(CommandLine, default=CommandLine(defaults), description=__doc__, args=arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    """Tune as the command line says."""
    with command(
        RunFolderError,
        BackendError,
        MissingExtraError,
        kept="--resume goes on after the last round, if there is one",
    ):
        given = read_command_line(arguments)
        given.where.check()
        if given.seeds and given.config.output:
            raise ValueError(
                f"--output {given.config.output}: one file, and --seeds asks for several results"
            )
        if given.seeds or given.where.elsewhere:
            configs = configs_of_seeds(given.config, given.seeds) if given.seeds else [given.config]
            run_all(tune, configs, given.where)
            return
        run = TuningRun(given.config)
        result = run.run()
    print(f"tuned in {run.num_steps} steps: {result}\nuse it as controller {run.tuner.family}:{result}")


if __name__ == "__main__":
    main()
