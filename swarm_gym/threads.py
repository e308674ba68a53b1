"""Swarms spread over threads, for kernels that release the interpreter lock.

Threads of Python and not Numba's: nothing is compiled twice for them, and none spins while there is no work.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache

import numpy as np
from numpy.typing import NDArray

Flags = NDArray[np.bool_]


def spread(run: Callable[[Flags], None], chosen: Flags, num_threads: int) -> None:
    """Call `run` with the swarms that are chosen, (B,), or with parts of them in that many threads.

    The calling thread takes part, and all are done when it returns.
    """
    if min(num_threads, len(chosen)) < 2:  # at every step of a single environment
        run(chosen)
        return
    rows = np.flatnonzero(chosen)
    num_parts = min(num_threads, len(rows))
    if num_parts < 2:
        run(chosen)
        return
    parts = np.zeros((num_parts, len(chosen)), dtype=np.bool_)
    for part, share in zip(parts, np.array_split(rows, num_parts), strict=True):
        part[share] = True
    others = [_pool(os.getpid(), num_threads - 1).submit(run, part) for part in parts[1:]]
    try:
        run(parts[0])
    finally:
        wait(others)
    for other in others:
        other.result()


@cache
def _pool(process: int, num_threads: int) -> ThreadPoolExecutor:  # noqa: ARG001
    # One per process, since threads do not outlive a fork.
    return ThreadPoolExecutor(num_threads, thread_name_prefix="swarm_gym")
