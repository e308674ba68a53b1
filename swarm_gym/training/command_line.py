"""Train a controller: `swarm-gym train --help`.

The policy may first imitate a hand-designed controller (`--warm-start`), since PPO from scratch collapses to
tiny populations: evaluations cost at once, but their gain comes a dozen iterations later. Training is divided
into chunks. All random numbers of a chunk are seeded with (run seed, chunk). So a run that was stopped and
resumed equals one that was not. Example: `swarm-gym train --preset three-cases --seed 0`.
"""

import argparse
import dataclasses
import sys
from collections.abc import Sequence

import tyro

from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.algorithms import EVERY_OPTION, Algorithm, foreign_options, refuse_foreign
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.presets import load_preset

KEPT = "--resume continues from the last checkpoint, if there is one"


def named_options(arguments: Sequence[str] | None, preset: str | None = None) -> TrainConfig:
    """Return the options of the preset, with the algorithm, that a command line names.

    Args:
        arguments: the command line; None takes the process's.
        preset: preset to take instead of the one that is named.

    Raises:
        PresetError: for a preset that is missing or invalid.
        UnknownNameError: if there is no such algorithm.
    """
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--preset", default=TrainConfig.preset)
    finder.add_argument("--algorithm")
    found = finder.parse_known_args(arguments)[0]
    loaded = load_preset(preset or found.preset)
    return loaded if found.algorithm is None else loaded.changed(algorithm=found.algorithm)


def without_foreign(arguments: Sequence[str] | None, algorithm: str) -> list[str]:
    """Return a command line without the options that other algorithms than the named one have.

    A preset may give options of another algorithm than the command line names. So commands state options of
    algorithms that they do not use, such as `--algorithm evolution --warm-start none`. They are accepted as
    long as they have no effect, see `algorithms.refuse_foreign`; a note on standard error names those of them
    that would have one with another algorithm.

    Raises:
        ValueError: for an option that would have an effect.
        SystemExit: for a value of another type than the option's.
    """
    foreign = foreign_options(algorithm)
    kept: list[str] = []
    taken: list[str] = []
    stated: set[str] = set()
    place = kept
    for argument in sys.argv[1:] if arguments is None else arguments:
        if argument.startswith("--"):
            option = argument[2:].partition("=")[0].replace("-", "_")
            found = foreign & {option, option.removeprefix("no_")}
            stated |= found
            place = taken if found else kept
        place.append(argument)
    if taken:
        fields = [(option, kind, default) for option, (kind, default) in EVERY_OPTION.items()]
        form = dataclasses.make_dataclass("OptionsOfOthers", fields, frozen=True)
        given: object = tyro.cli(form, args=taken)
        values = {option: getattr(given, option) for option in stated}
        refuse_foreign(algorithm, values)
        for option, value in sorted(values.items()):
            if value != getattr(Algorithm, option, EVERY_OPTION[option][1]):
                name = option.replace("_", "-")
                print(f"note: --{name} {value} changes nothing with {algorithm}", file=sys.stderr)
    return kept


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
