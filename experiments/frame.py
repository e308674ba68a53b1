"""Draw the picture at the top of the README: `python -m experiments.frame FILE`."""

import sys
from pathlib import Path

import numpy as np
from matplotlib import image

from swarm_gym.env import SwarmEnv


def main() -> None:
    """Write a PNG of a noisy swarm that slowly shrinks."""
    if len(sys.argv) != 2:
        sys.exit("usage: python -m experiments.frame FILE")
    env = SwarmEnv(scenario="case2", noise=8.0, initial_population_size=100, render_mode="rgb_array")
    env.reset(seed=0)
    for iteration in range(40):
        env.step(np.array([100.0 - iteration, 0.0 if iteration < 25 else 0.5]))
    image.imsave(Path(sys.argv[1]), np.asarray(env.render()))


if __name__ == "__main__":
    main()
