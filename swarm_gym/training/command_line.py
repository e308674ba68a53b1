"""Train a controller: `swarm-gym train --help`.

The policy may first imitate a hand-designed controller (`--warm-start`), since PPO from scratch collapses to
tiny populations: evaluations cost at once, but their gain comes a dozen iterations later. Training is divided
into chunks. All random numbers of a chunk are seeded with (run seed, chunk), so that a run that was stopped
and resumed equals one that was not. Example: `swarm-gym train --preset three-cases --seed 0`.
"""

import argparse
import dataclasses
from collections.abc import Sequence

import tyro

from swarm_gym.command import command
from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.presets import load_preset
from swarm_gym.training.run import TrainingRun

KEPT = "--resume continues from the last checkpoint, if there is one"


def named_preset(arguments: Sequence[str] | None) -> str:
    """Return the preset that a command line names, which gives the defaults of all other options."""
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--preset", default=TrainConfig.preset)
    return finder.parse_known_args(arguments)[0].preset


def train(config: TrainConfig) -> None:
    """Train a controller and print the file of its best policy."""
    run = TrainingRun(config)
    best = run.run()
    name = ControllerName.of("learned", str(best))
    print(f"best policy by validation: {best}\n{run.verdict}\nuse it as controller {name}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Train with the options of the command line."""
    with command(RunFolderError, MissingExtraError, kept=KEPT):
        loaded = load_preset(named_preset(arguments))
        given = tyro.cli(TrainConfig, default=loaded, description=__doc__, args=arguments)
        # The name of a preset that is given as a file is the file's name.
        train(dataclasses.replace(given, preset=loaded.preset))


if __name__ == "__main__":
    main()
