"""Train a controller: `swarm-gym train --help`.

The policy may first imitate a hand-designed controller (`--warm-start`), since PPO from scratch collapses to
tiny populations: evaluations cost at once, but their gain comes a dozen iterations later. Training is divided
into chunks. All random numbers of a chunk are seeded with (run seed, chunk), so that a run that was stopped
and resumed equals one that was not. Example: `swarm-gym train --preset three-cases --seed 0`.
"""

import dataclasses
from collections.abc import Sequence

import tyro

from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.given_options import named_options, without_foreign

KEPT = "--resume continues from the last checkpoint, if there is one"


def train(config: TrainConfig) -> None:
    """Train a controller and print the file of its best policy."""
    # Imported only now, since torch takes seconds: the help is shown, and options are read, without it.
    try:
        from swarm_gym.controllers.names import ControllerName
        from swarm_gym.training.run import TrainingRun
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("swarm_gym"):
            raise
        raise MissingExtraError("a training", str(error.name), "train") from error

    run = TrainingRun(config)
    best = run.run()
    name = ControllerName.of("learned", str(best))
    print(f"best policy by validation: {best}\n{run.verdict}\nuse it as controller {name}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Train with the options of the command line."""
    with command(RunFolderError, MissingExtraError, kept=KEPT):
        named = named_options(arguments)
        left = without_foreign(arguments, named.algorithm.name)
        given = tyro.cli(TrainConfig, default=named, description=__doc__, args=left)
        # The name of a preset that is given as a file is the file's name.
        train(dataclasses.replace(given, preset=named.preset))


if __name__ == "__main__":
    main()
