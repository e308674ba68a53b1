"""Convergence of runs: at most a thousandth of the whole gain is still to come."""

import numpy as np

from experiments.runs.run import Floats

STILL_TO_COME = 1e-3


def convergence_iteration(course: Floats) -> int:
    """Return the first iteration t with best(t) - best(T) <= 1e-3 (best(0) - best(T)).

    Args:
        course: (T + 1,) best fitness so far.
    """
    return int(np.argmax(course - course[-1] <= STILL_TO_COME * (course[0] - course[-1])))
