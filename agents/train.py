"""Train a controller by PPO: `python -m agents.train --help`.

The policy first learns to imitate a hand-designed controller, since plain PPO from scratch collapses to tiny
populations: the price of evaluations is felt at once, their gain a dozen iterations later. PPO then goes on
from there. Training is cut into chunks; everything random in a chunk is seeded from (run seed, chunk), so
that a run that was stopped and resumed equals one that was not.
"""

import argparse
import sys
from collections.abc import Sequence

import tyro

from agents.presets import load_preset
from agents.train_config import TrainConfig
from agents.training_run import TrainingError, TrainingRun


def read_command_line(arguments: Sequence[str] | None = None) -> TrainConfig:
    """The configuration: that of `--preset`, changed by the other options."""
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    finder.add_argument("--preset", default=TrainConfig.preset)
    preset = finder.parse_known_args(arguments)[0].preset
    return tyro.cli(TrainConfig, default=load_preset(preset), description=__doc__, args=arguments)


def main() -> None:
    """Train as the command line says."""
    try:
        best = TrainingRun(read_command_line()).run()
    except (TrainingError, ValueError) as error:
        sys.exit(f"error: {error}")
    print(f"best policy by validation: {best}\nuse it as controller ppo:{best}")


if __name__ == "__main__":
    main()
