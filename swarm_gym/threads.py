"""Threads for swarms: kernels release the interpreter lock, so parts of a batch run in parallel.

These are Python's threads and not Numba's: kernels need not be compiled for them again, and an idle thread
does not spin.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache

import numpy as np
from numpy.typing import NDArray

Flags = NDArray[np.bool_]


def spread(run: Callable[[Flags], None], chosen: Flags, num_threads: int) -> None:
    """Call `run` with the chosen swarms, (B,), or with parts of them in up to `num_threads` threads.

    The calling thread takes part. All parts are done when the function returns.

    Args:
        run: function of a boolean array (B,) of swarms.
        chosen: (B,) swarms to run.
        num_threads: number of threads, the calling one included.
    """
    if min(num_threads, len(chosen)) < 2:  # the fast path of a single environment, at every step
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
    # Each process has its own pool, since threads do not survive a fork.
    return ThreadPoolExecutor(num_threads, thread_name_prefix="swarm_gym")
