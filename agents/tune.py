"""Tune hand-designed controllers, several at once and on clusters: `python -m agents.tune --help`.

The objective is the mean over episodes of log(final gap) plus the price of the evaluations, to be minimised.
The gap is the best fitness minus mu times the length of the straight line. Episodes have training scenarios
and training seeds only. The budget is in environment steps, by default that of a training preset, so that
tuned and learned controllers take the same effort. A run that was stopped and resumed equals one that was
not. Example: `python -m agents.tune --what schedule --preset three-cases`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import tyro

from agents.backends import BackendError, BackendOptions
from agents.backends.many_runs import configs_of_seeds, run_all
from agents.backends.many_runs import tune as tune_quietly
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.tuning.command_line import KEPT, defaults_of, tune
from swarm_gym.tuning.config import TuneConfig


@dataclass(frozen=True)
class TuneCommand:
    """A tuning configuration, further seeds to run it with, and options of the backend."""

    config: tyro.conf.OmitArgPrefixes[TuneConfig]
    seeds: tuple[int, ...] = ()
    """Seeds to tune with, one run each, instead of --seed, e.g. 0 1 2; by default --seed."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def read_command_line(arguments: Sequence[str] | None = None) -> TuneCommand:
    """Return the configuration of `--what` and `--preset`, changed by the other options."""
    defaults = TuneCommand(defaults_of(arguments))
    return tyro.cli(TuneCommand, default=defaults, description=__doc__, args=arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    """Tune with the options of the command line."""
    with command(RunFolderError, BackendError, MissingExtraError, kept=KEPT):
        given = read_command_line(arguments)
        given.where.check()
        if given.seeds and given.config.output:
            raise ValueError(
                f"--output {given.config.output}: one file cannot hold the several results of --seeds"
            )
        if given.seeds or given.where.elsewhere:
            configs = configs_of_seeds(given.config, given.seeds) if given.seeds else [given.config]
            run_all(tune_quietly, configs, given.where)
        else:
            tune(given.config)


if __name__ == "__main__":
    main()
