"""Film a run, one picture for each iteration: `python -m experiments.video --help`."""

import tyro
from gymnasium.error import DependencyNotInstalled

from experiments.plots.video import VideoConfig, write_video
from swarm_gym.command import command


def main() -> None:
    """Write the video files that the command line asks for."""
    config = tyro.cli(VideoConfig, description=__doc__)
    with command(ImportError, DependencyNotInstalled):
        write_video(config)
    print("written:", ", ".join(str(path) for path in config.output))


if __name__ == "__main__":
    main()
