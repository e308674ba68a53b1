"""A backend of Slurm jobs, by submitit; for trials, the jobs can be processes of this machine."""

import math
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from tqdm import tqdm

from agents.backends.backend import (
    MOST_LOSSES,
    ONE_THREAD,
    Backend,
    BackendError,
    GivenUp,
    Outcome,
    Result,
    Task,
)
from swarm_gym.errors import MissingExtraError

HERE = "local"
ROUNDS = 4  # jobs that follow one another in each place of the queue, so that no single long job ends last
MINUTES = 24 * 60  # time limit of a job, unless SBATCH_TIMELIMIT sets another one
POLL_INTERVAL = 1.0  # seconds between two checks of the jobs
PREEMPTED = "PREEMPTED"  # submitit takes this for the state of a running job, but it may be the last one


class SlurmBackend(Backend):
    """Slurm jobs of one processor each, which see this file system and use the Python of this process.

    Slurm reads further settings (account, time limit, memory) from its own environment variables, `SBATCH_*`.

    Args:
        partition: partition of the cluster; None is its default, "local" is processes of this machine.
        jobs: number of jobs in the queue at a time.
        folder: folder for inputs and results of jobs; its files are deleted when jobs succeed.

    Raises:
        MissingExtraError: if submitit is missing.
        BackendError: if there is no Slurm, or Slurm has no accounting, without which killed jobs are not
            reported; on Windows, where submitit does not run.
        ValueError: if the number of jobs is missing.
    """

    def __init__(self, partition: str | None, jobs: int, folder: Path):
        if not hasattr(signal, "SIGUSR2"):
            raise BackendError(
                "--backend slurm: submitit needs signals and a shell, which Windows does not have; "
                "use `--backend local` here, or start the command on a node of the cluster"
            )
        try:
            import submitit
        except ImportError as error:
            raise MissingExtraError("--backend slurm", "submitit", "slurm") from error
        if jobs < 1:
            raise ValueError("--backend slurm: give the number of jobs in the queue at a time by --jobs")
        self._submitit = submitit
        self._jobs = jobs
        self._folder = folder.absolute()
        cluster = "local" if partition == HERE else "slurm"
        try:
            self._executor = submitit.AutoExecutor(self._folder, cluster)
        except RuntimeError as error:
            raise BackendError(f"--backend slurm: {error} `--address {HERE}` needs no Slurm") from error
        if cluster == "slurm":
            _require_accounting()
        setup = [f"export {name}={value}" for name, value in ONE_THREAD.items()]
        self._executor.update_parameters(
            name="swarm_gym",
            timeout_min=MINUTES,
            cpus_per_task=1,
            slurm_partition=partition,
            **{f"{cluster}_setup": setup},
        )

    def workers(self) -> int:
        """Return the number of jobs at a time."""
        return self._jobs

    def run(self, task: Task[Result], units: Sequence[object]) -> Iterator[tuple[int, Result]]:
        """Run units as described in `Backend`; a job has several units, whose results come when it ends."""
        size = math.ceil(len(units) / (ROUNDS * self._jobs)) or 1
        numbers = range(len(units))
        left = [numbers[first : first + size] for first in numbers[::size]][::-1]
        under_way: dict[Any, range] = {}
        losses: Counter[range] = Counter()
        given_up = GivenUp()
        try:
            while left or under_way:
                while left and len(under_way) < self._jobs:
                    try:
                        job = self._submit(task, [units[number] for number in left[-1]])
                    except BackendError:
                        if not under_way:
                            raise
                        break  # the account may have reached its limit of jobs; one of them will end
                    under_way[job] = left.pop()
                time.sleep(POLL_INTERVAL)
                for job in [job for job in under_way if job.done() or job.state == PREEMPTED]:
                    numbers = under_way.pop(job)
                    outcomes = self._outcomes(job)
                    if outcomes is None:
                        job.cancel(check=False)  # Slurm restarts some jobs itself, as when a node fails
                        losses[numbers] += job.state != PREEMPTED  # preemption is not the work's fault
                        again = losses[numbers] < MOST_LOSSES
                        then = "retried" if again else "given up"
                        tqdm.write(f"job {job.job_id} was lost ({job.state}); its work is {then}")
                        if again:
                            left.append(numbers)
                        else:
                            given_up.add()
                        continue
                    given_up.succeeded()
                    for number, outcome in zip(numbers, outcomes, strict=False):
                        yield number, outcome.get()
            given_up.end()
        finally:
            for job in under_way:
                job.cancel(check=False)

    def close(self) -> None:
        """Delete the folder if only links to deleted files are left in it."""
        for link in self._folder.glob(".submission_file_*"):
            if not link.exists():
                link.unlink(missing_ok=True)
        with suppress(OSError):
            self._folder.rmdir()

    def _submit(self, task: Task, units: list[Any]) -> Any:
        try:
            return self._executor.submit(_carry_out, task, units)
        except self._submitit.core.utils.FailedJobError as error:
            raise BackendError(f"--backend slurm: a job was refused ({error})") from error

    def _outcomes(self, job: Any) -> list[Outcome] | None:
        """Return the outcomes of an ended job, or None if it was killed."""
        if not job.done():  # it was preempted
            return None
        try:
            outcomes = job.result()
        except self._submitit.core.utils.FailedJobError as error:  # a subclass of UncompletedJobError
            raise BackendError(f"--backend slurm: {error}") from error
        except self._submitit.core.utils.UncompletedJobError:
            return None
        paths = job.paths
        for path in (
            paths.submission_file,
            paths.submitted_pickle,
            paths.result_pickle,
            paths.stdout,
            paths.stderr,
        ):
            path.unlink(missing_ok=True)
        return outcomes


def _require_accounting() -> None:
    asked = subprocess.run(["sacct", "--noheader", "--jobs=1"], capture_output=True, text=True, check=False)
    if asked.returncode:
        raise BackendError(
            f"--backend slurm needs Slurm's accounting, but sacct says: {asked.stderr.strip()}"
        )


def _carry_out(task: Task, units: list[Any]) -> list[Outcome]:
    # Submitit restarts a job for ever if SBATCH_TIMELIMIT is below the limit that submitit knows.
    signal.signal(signal.SIGUSR2, signal.SIG_IGN)
    # Submitit ignores SIGTERM: a cancelled job would keep its processor and the lock of its run.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    return task.outcomes(units)
