"""Ranges of seeds: test, validation and training never share a seed."""

import numpy as np

TEST = range(100_000)  # suites take their seeds from the start of this range
VALIDATION = range(100_000, 200_000)  # model selection while training
ANALYSIS = VALIDATION[50_000:]  # validation seeds that model selection does not use
TRAINING_START = 1_000_000  # training takes seeds from here on,
TRAINING_STOP = 2**31  # and below this one


def training_seed(run_seed: int, chunk: int) -> int:
    """Return a seed for the environments of one chunk of a training run, outside the other ranges."""
    draw = np.random.SeedSequence([run_seed, chunk]).generate_state(1)[0]
    return TRAINING_START + int(draw) % (TRAINING_STOP - TRAINING_START)
