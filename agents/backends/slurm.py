"""Jobs of a Slurm cluster, by submitit; or, to try things out, the same in processes of this machine."""

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
    Task,
)
from swarm_gym.errors import MissingExtraError

HERE = "local"
ROUNDS = 4  # jobs that come after one another in each place of the queue, lest one long job ends last
MINUTES = 24 * 60  # of a job, unless SBATCH_TIMELIMIT says otherwise
PATIENCE = 1.0  # seconds between two looks at the jobs
PREEMPTED = "PREEMPTED"  # which submitit takes for the state of a job that goes on; it may be its last one


class SlurmBackend(Backend):
    """Slurm jobs of one processor each, which see this file system and the Python that this process is.

    What Slurm wants to know else (account, time limit, memory) it is told by its own variables, `SBATCH_*`.

    Args:
        partition: of the cluster; None for its default, "local" for processes of this machine.
        jobs: how many jobs are in the queue at a time.
        folder: for what jobs are told and tell; deleted where all went well.

    Raises:
        MissingExtraError: if submitit is missing.
        BackendError: if there is no Slurm, or none with accounting: only `sacct` tells of killed jobs.
        ValueError: if it is not said how many jobs.
    """

    def __init__(self, partition: str | None, jobs: int, folder: Path):
        try:
            import submitit
        except ImportError as error:
            raise MissingExtraError("--backend slurm", "submitit", "slurm") from error
        if jobs < 1:
            raise ValueError("--backend slurm: say by --jobs how many jobs are in the queue at a time")
        self._submitit = submitit
        self._jobs = jobs
        self._folder = folder.absolute()
        cluster = "local" if partition == HERE else "slurm"
        try:
            self._executor = submitit.AutoExecutor(self._folder, cluster)
        except RuntimeError as error:
            raise BackendError(f"--backend slurm: {error} `--address {HERE}` does without") from error
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
        """As many as there are jobs at a time."""
        return self._jobs

    def run(self, task: Task, units: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """See `Backend`; a job carries out several units, and their results come when it ends."""
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
                        break  # an account may have as many jobs as it may, one of which is about to end
                    under_way[job] = left.pop()
                time.sleep(PATIENCE)
                for job in [job for job in under_way if job.done() or job.state == PREEMPTED]:
                    numbers = under_way.pop(job)
                    outcomes = self._outcomes(job)
                    if outcomes is None:
                        job.cancel(check=False)  # Slurm begins some of them again, as when a node fails
                        losses[numbers] += job.state != PREEMPTED  # for which its work is not to blame
                        again = losses[numbers] < MOST_LOSSES
                        then = "done again" if again else "given up"
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
        """Delete the folder, if nothing is left in it but links to what is deleted."""
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
        """What a job that has ended tells, or nothing, if it was killed."""
        if not job.done():  # but preempted
            return None
        try:
            outcomes = job.result()
        except self._submitit.core.utils.FailedJobError as error:  # a kind of the other one
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
    # Submitit has a job begin again, without end, where SBATCH_TIMELIMIT is less than what it was told.
    signal.signal(signal.SIGUSR2, signal.SIG_IGN)
    # Nor does it heed SIGTERM: what is cancelled would keep its processor and the lock of its run.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    return task.outcomes(units)
