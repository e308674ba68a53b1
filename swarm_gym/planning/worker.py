"""A thread for one run of the planner, which ends before the interpreter does."""

import atexit
import threading
import time
from collections.abc import Callable

from swarm_gym.errors import NoPathError
from swarm_gym.planning.drive_run import DriveRun
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.result import Plan
from swarm_gym.reference.disc_planner import StoppedError

LOOK = 0.002  # seconds between two looks at an event of the caller
GRACE = 0.004  # seconds that a run has to end by itself when its time is nearly up
EARLY = 0.010  # seconds before the limit at which planning ends

AnyRun = PlanningRun | DriveRun

_interpreter_ends = threading.Event()


class Worker(threading.Thread):
    """One run in a thread of its own.

    The thread may go on when its result is no longer awaited: it ends at the next look at `stop`. Python must
    not end before: it frees compiled code and LLVM's objects, and a thread that works with them then crashes
    the process. So the interpreter waits for these threads when it ends, see `end_all`.

    Attributes:
        began: time of the monotonic clock when it began.
        stop: event that ends it.
    """

    def __init__(self, begin: Callable[["Worker"], AnyRun], began: float):
        """Make the thread, which `start` starts.

        Args:
            begin: function that makes the run; it is called in the thread.
            began: time of the monotonic clock when planning began.
        """
        # A thread that is no daemon would be awaited before it is told to stop.
        super().__init__(name="swarm_gym.plan", daemon=True)
        self.began, self.stop = began, threading.Event()
        self._begin = begin
        self._run: AnyRun | None = None
        self._plan: Plan | None = None
        self._error: BaseException | None = None
        self._done = threading.Event()

    def run(self) -> None:
        """Make the run and let it plan."""
        try:
            if _interpreter_ends.is_set():
                raise RuntimeError("the interpreter ends: expected calls of plan before the program's end")
            self._run = self._begin(self)
            self._plan = self._run.run()
        except StoppedError:
            pass  # the caller takes the best path so far
        except BaseException as error:  # the caller raises it
            self._error = error
        finally:
            self._done.set()

    def result_by(self, limit: float | None, cancel: threading.Event | None) -> Plan:
        """Return the plan, or the best one so far when a time has come or planning is cancelled.

        Args:
            limit: time of the monotonic clock; None for no limit.
            cancel: event that cancels planning; None without one.

        Raises:
            NoPathError: if no path is known then.
            Exception: an error of the run.
        """
        why = self._wait(limit, cancel)
        self.stop.set()
        if why is not None:
            self._done.wait(GRACE)
        if self._error is not None:
            raise self._error
        if self._plan is not None:
            return self._plan
        so_far = None if self._run is None else self._run.best_so_far()
        if so_far is None:
            raise NoPathError(
                f"no path was known when {why or 'planning was cancelled'}; a longer time may help"
            )
        return so_far

    def _wait(self, limit: float | None, cancel: threading.Event | None) -> str | None:
        """Wait for the end of the run; return why it is not awaited, or None at its end."""
        while not self._done.wait(LOOK):
            if self.stop.is_set() or (cancel is not None and cancel.is_set()):
                return "planning was cancelled"
            if limit is not None and time.monotonic() >= limit - EARLY:
                return f"the time of {limit - self.began:g} s was up"
        return None


@atexit.register
def end_all() -> None:
    """End all runs, and wait for their threads; the interpreter calls it before it frees what they use.

    What cannot be stopped is completed: a kernel that is being compiled, or one call of a library.
    """
    _interpreter_ends.set()
    workers = [thread for thread in threading.enumerate() if isinstance(thread, Worker)]
    for worker in workers:
        worker.stop.set()
    for worker in workers:
        worker._done.wait()  # another thread may just be starting it, and what has not started is not joined
        worker.join()
