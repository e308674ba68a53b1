"""Draw the picture at the top of the README: `python -m experiments.frame FILE`."""

import argparse
from pathlib import Path

import numpy as np
from matplotlib import image
from numpy.typing import NDArray

from swarm_gym.command import command
from swarm_gym.env import SwarmEnv
from swarm_gym.outputs import require_outputs


def main() -> None:
    """Write the picture to the file that the command line names."""
    parser = argparse.ArgumentParser(prog="python -m experiments.frame", description=__doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="picture to write, .png")
    file = parser.parse_args().file
    with command():
        require_outputs([file], formats={".png": None})
        image.imsave(file, picture())


def picture() -> NDArray[np.uint8]:
    """Return the picture of a noisy swarm that slowly shrinks, (height, width, 3)."""
    env = SwarmEnv(scenario="case2", noise=8.0, initial_population_size=100, render_mode="rgb_array")
    env.reset(seed=0)
    for iteration in range(40):
        env.step(np.array([100.0 - iteration, 0.0 if iteration < 25 else 0.5]))
    return np.asarray(env.render())


if __name__ == "__main__":
    main()
