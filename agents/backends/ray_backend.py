"""A backend of processes of a Ray cluster, or of Ray on this machine."""

import logging
import math
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
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
    WorkLostError,
)
from agents.backends.packing import LEFT_BEHIND, own_files, pack
from swarm_gym.errors import MissingExtraError

AHEAD = 2  # waiting Ray tasks per running one, so that no worker waits for this process

# A Ray task costs several milliseconds; while many short units are left, a task has up to `MOST_UNITS`.
MOST_UNITS = 5
TASKS_PER_WORKER = 16
TASK_SECONDS = 5.0
POLL_INTERVAL = 10.0  # seconds between two counts of the cluster's processors
CONNECT_TIMEOUT = 10.0  # seconds for an answer of the cluster's address


class RayBackend(Backend):
    """Ray tasks of one processor each; Ray retries tasks that are lost with a process or a node.

    Ray is started, or connected to, when there is work.

    Args:
        address: address of a cluster, as `ray.init` takes it; None starts Ray on this machine.
        jobs: number of units at a time; 0 is the number of processors.
        files: files that the nodes of a cluster need besides code and maps, see `agents.backends.packing`.

    Raises:
        MissingExtraError: if Ray is missing.
    """

    def __init__(self, address: str | None, jobs: int, files: Sequence[Path] = ()):
        try:
            import ray
        except ImportError as error:
            raise MissingExtraError("--backend ray", "Ray", "ray") from error
        self.on_this_machine = address is None
        self._ray = ray
        self._address = address
        self._jobs = jobs
        self._files = files
        self._connected = False
        self._room = 0
        self._counted = -math.inf

    def workers(self) -> int:
        """Return the number of requested units at a time, or the current number of processors."""
        self._connect()
        return self._jobs or max(1, self._processors())

    def run(self, task: Task[Result], units: Sequence[object]) -> Iterator[tuple[int, Result]]:
        """Run units as described in `Backend`."""
        tasks = TASKS_PER_WORKER * self.workers()  # connects to Ray
        ray = self._ray
        carry_out = ray.remote(num_cpus=1, max_retries=MOST_LOSSES - 1)(_carry_out)
        shared = ray.put(task)
        left = list(range(len(units)))[::-1]
        under_way: dict[Any, list[int]] = {}
        given_up = GivenUp()
        at_once = 1  # number of units that take about TASK_SECONDS
        try:
            while left or under_way:
                while left and len(under_way) < self._most_under_way():
                    numbers = [left.pop() for _ in range(min(max(len(left) // tasks, 1), at_once))]
                    under_way[carry_out.remote(shared, [units[number] for number in numbers])] = numbers
                for reference in self._ended(list(under_way)):
                    numbers = under_way.pop(reference)
                    try:
                        outcomes, seconds = self._outcomes(reference)
                    except WorkLostError:
                        tqdm.write(f"a task was lost {MOST_LOSSES} times; it is given up")
                        given_up.add()
                        continue
                    given_up.succeeded()
                    at_once = min(max(int(TASK_SECONDS * len(outcomes) / max(seconds, 1e-3)), 1), MOST_UNITS)
                    for number, outcome in zip(numbers, outcomes, strict=False):
                        yield number, outcome.get()
            given_up.end()
        finally:
            for reference in under_way:
                ray.cancel(reference, force=True)

    def close(self) -> None:
        """Disconnect from the cluster, or stop it if it was started here."""
        if self._connected:
            self._ray.shutdown()
            self._connected = False

    def _connect(self) -> None:
        if self._connected:
            return
        here = self._address is None
        _require_answer(self._address)
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # applies to a Ray that is started here
        os.environ.setdefault("RAY_task_oom_retries", str(MOST_LOSSES - 1))  # the default is no limit
        os.environ.setdefault("RAY_IGNORE_UNHANDLED_ERRORS", "1")  # the first error is raised and ends all
        with TemporaryDirectory(prefix="swarm_gym") as folder, _own_signals():
            environment: dict[str, Any] = {"env_vars": ONE_THREAD}
            if not here:
                set_there = pack(Path(folder), [*self._files, *own_files()])
                environment = {
                    "env_vars": ONE_THREAD | set_there,
                    "working_dir": folder,
                    "excludes": LEFT_BEHIND,
                }
            try:
                self._ray.init(
                    "local" if here else self._address,
                    num_cpus=self._jobs or None if here else None,
                    include_dashboard=False if here else None,
                    runtime_env=environment,
                    log_to_driver=False,
                    logging_level=logging.ERROR,
                )
            # No cluster there, another version, a working directory that is too large: errors of any class.
            except Exception as error:
                where = "" if here else f" --address {self._address}"
                raise BackendError(f"--backend ray{where}: {error}") from error
        self._connected = True

    def _processors(self) -> int:
        return int(self._ray.cluster_resources().get("CPU", 0))

    def _most_under_way(self) -> int:
        """Return the number of tasks to hand to Ray at a time; a cluster may grow, and is counted again."""
        if self._jobs and self._address:
            return self._jobs
        if time.monotonic() - self._counted > POLL_INTERVAL:
            processors = self._processors()
            if not processors and self._counted < 0:
                tqdm.write("the Ray cluster has no processors; waiting for some")
            self._room = (1 + AHEAD) * max(1, processors)
            self._counted = time.monotonic()
        return self._room

    def _ended(self, references: list[Any]) -> list[Any]:
        """Wait for one task to end and return all that have ended; an empty list after `POLL_INTERVAL`."""
        with _own_exceptions():
            ended, _ = self._ray.wait(references, timeout=POLL_INTERVAL)
            if ended:
                ended, _ = self._ray.wait(references, num_returns=len(references), timeout=0)
            return ended

    def _outcomes(self, reference: Any) -> tuple[list[Outcome], float]:
        errors = self._ray.exceptions
        try:
            with _own_exceptions():
                return self._ray.get(reference)
        except errors.RayTaskError as error:  # its outcome cannot be pickled
            raise error.cause from error
        except errors.RuntimeEnvSetupError as error:
            raise BackendError(f"--backend ray: a node could not set up its environment ({error})") from error
        except (
            errors.WorkerCrashedError,
            errors.NodeDiedError,
            errors.OutOfMemoryError,
            errors.ObjectLostError,
        ) as error:
            raise WorkLostError from error
        except errors.RayError as error:
            raise BackendError(f"--backend ray: {error}") from error


def _require_answer(address: str | None) -> None:
    """Raise an error for an address without a listener, which Ray itself would try for minutes.

    Raises:
        BackendError: if nothing answers at the address.
    """
    host, colon, port = (address or "").removeprefix("ray://").rpartition(":")
    if not colon or not port.isdigit():
        return
    try:
        socket.create_connection((host.strip("[]"), int(port)), CONNECT_TIMEOUT).close()
    except (OSError, OverflowError) as error:
        raise BackendError(f"--backend ray --address {address}: nothing answers there ({error})") from error


def _carry_out(task: Task, units: list[Any]) -> tuple[list[Outcome], float]:
    """Return the outcomes of units, and the seconds that they took."""
    begin = time.perf_counter()
    outcomes = task.outcomes(units)
    return outcomes, time.perf_counter() - begin


@contextmanager
def _own_exceptions() -> Iterator[None]:
    """Re-raise the exception of a signal handler that Ray, while waiting, wrapped in a SystemError."""
    try:
        yield
    except SystemError as error:
        raise error.__cause__ or error from None


@contextmanager
def _own_signals() -> Iterator[None]:
    """Restore the handler of SIGTERM, which Ray replaces: `swarm_gym.command` defines how commands end."""
    mine = signal.getsignal(signal.SIGTERM)
    yield
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, mine)
