"""Tune a hand-designed controller: `swarm-gym tune --help`.

The objective is the mean over episodes of log(final gap) plus the price of the evaluations, to be minimised.
The gap is the best fitness minus mu times the length of the straight line. Episodes have training scenarios
and training seeds only. The budget is in environment steps, by default the budget of a training preset, so
that tuned and learned controllers take the same effort. A run that was stopped and resumed equals one that
was not. Example: `swarm-gym tune --what schedule --preset three-cases`.
"""

import argparse
import dataclasses
from collections.abc import Sequence

import tyro

from swarm_gym.command import command
from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.presets import load_preset
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.run import TuningRun
from swarm_gym.tuning.tuners import kind_defaults

KEPT = "--resume continues after the last round, if there is one"
FROM_PRESET = (
    "preset",
    "total_steps",
    "optimizer",
    "scenarios",
    "encoding",
    "distance_weight",
    "ground_weight",
    "curvature_weight",
    "cost",
    "source",
    "min_population_size",
    "max_population_size",
)


def defaults_of(arguments: Sequence[str] | None) -> TuneConfig:
    """Return the defaults of the `--what` and `--preset` that a command line names."""
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--what", default=TuneConfig.what)
    finder.add_argument("--preset", default=TuneConfig.preset)
    found = finder.parse_known_args(arguments)[0]
    preset = load_preset(found.preset)
    shared = {name: getattr(preset, name) for name in FROM_PRESET}
    return dataclasses.replace(kind_defaults(found.what), **shared)


def tune(config: TuneConfig) -> None:
    """Tune a controller and print its file."""
    run = TuningRun(config)
    result = run.run()
    name = ControllerName.of(run.tuner.family, str(result))
    print(f"tuned in {run.num_steps} steps: {result}\nuse it as controller {name}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Tune with the options of the command line."""
    with command(RunFolderError, MissingExtraError, kept=KEPT):
        defaults = defaults_of(arguments)
        tune(tyro.cli(TuneConfig, default=defaults, description=__doc__, args=arguments))


if __name__ == "__main__":
    main()
