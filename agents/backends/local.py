"""A backend of processes on this machine, by joblib."""

import gc
import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from functools import cache

from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError
from tqdm import tqdm

from agents.backends.backend import MOST_LOSSES, Backend, Result, Task, WorkLostError


class LocalBackend(Backend):
    """A pool of processes; a pool of one is this process itself.

    Args:
        jobs: number of processes; 0 is the number of cores.
    """

    on_this_machine = True

    def __init__(self, jobs: int):
        self._jobs = jobs or cpu_count()

    def workers(self) -> int:
        """Return the number of processes."""
        return self._jobs

    def run(self, task: Task[Result], units: Sequence[object]) -> Iterator[tuple[int, Result]]:
        """Run units as described in `Backend`; if a process is killed, all running units are retried."""
        left = dict(enumerate(units))
        losses = 0
        while left:
            # A copy, since `left` changes while the calls are taken.
            calls = (delayed(_numbered)(number, task, unit) for number, unit in [*left.items()])
            try:
                for number, result in self._parallel()(calls):
                    del left[number]
                    losses = 0
                    yield number, result
            except TerminatedWorkerError as error:
                losses += 1
                if losses == MOST_LOSSES:
                    raise WorkLostError from error
                tqdm.write("a worker process was killed; the running units are retried")

    def _parallel(self) -> Parallel:
        # One thread per process, see swarm_gym.training.learners.ppo.
        with parallel_config(backend="loky", inner_max_num_threads=1):
            return Parallel(
                self._jobs, return_as="generator_unordered", batch_size=1, pre_dispatch="2*n_jobs"
            )


def _numbered(number: int, task: Task[Result], unit: object) -> tuple[int, Result]:
    _begin_worker()
    return number, task(unit)


@cache
def _begin_worker() -> None:
    """Prepare a process of the pool before its first unit."""
    if multiprocessing.parent_process() is None:
        return
    # Ctrl-C reaches all processes of a command; the first one ends its workers, which print nothing.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Loky's workers collect garbage every second, which takes 5 % of their time if all modules are searched.
    gc.freeze()
