"""Write the playground as one HTML file: `python -m experiments.playground FILE`.

The page steers a swarm by hand, beside the schedule SPSFA-TIP and a learned policy from the same seed. It
computes in the browser and needs no network and no other file.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from experiments.playground.playground_page import CASES, playground_page
from swarm_gym.command import command
from swarm_gym.files import write_atomically


@dataclass(frozen=True)
class PlaygroundConfig:
    """Options of the page."""

    output: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """HTML file to write, e.g. build/docs/play.html."""
    scenarios: tuple[str, ...] = CASES
    """Names of fixed maps of circles and polygons to choose from, e.g. case2 random-fields:test:0."""


def main() -> None:
    """Write the page that the command line asks for."""
    config = tyro.cli(PlaygroundConfig, description=__doc__)
    with command():
        file = write_atomically(config.output, playground_page(config.scenarios))
    print(f"playground: {file} ({file.stat().st_size / 1e3:.0f} kB)")


if __name__ == "__main__":
    main()
