"""The seeds of episodes as NumPy makes them, one after the other."""

import numpy as np


def episode_seed(generator):
    """Return the seed sequence of the next episode of a swarm; advances its generator."""
    return np.random.SeedSequence(generator.integers(0, 2**32, size=8).tolist())
