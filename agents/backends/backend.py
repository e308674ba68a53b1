"""What carries out units of work: in processes of this machine, or of others."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

MOST_LOSSES = 3  # of a unit, before it is given up

# More processes, not more threads of each, make use of more cores; see also agents.training.learners.ppo.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class BackendError(RuntimeError):
    """A backend cannot be used, or gives up; the message says why."""


class WorkLostError(BackendError):
    """Worker processes were killed again and again: what has no result was given up, or not begun."""

    def __init__(self) -> None:
        super().__init__(
            f"worker processes were killed {MOST_LOSSES} times before one could finish its work; is memory "
            "short, or a time limit?"
        )


class GivenUp:
    """Counts what was lost so often that it is given up; the rest is carried out nonetheless.

    Where the fault lies with none of it, as when all machines lack memory, nothing succeeds in between.
    """

    def __init__(self) -> None:
        self._in_all = self._in_a_row = 0

    def add(self) -> None:
        """A unit, or a few, were given up.

        Raises:
            WorkLostError: if too many were, with nothing that succeeded in between.
        """
        self._in_all += 1
        self._in_a_row += 1
        if self._in_a_row == MOST_LOSSES:
            raise WorkLostError

    def succeeded(self) -> None:
        """A unit has succeeded."""
        self._in_a_row = 0

    def end(self) -> None:
        """All others have ended.

        Raises:
            WorkLostError: if anything was given up.
        """
        if self._in_all:
            raise WorkLostError


class Outcome(NamedTuple):
    """What became of a unit: a result, or an error that its work raised."""

    result: Any
    error: Exception | None = None

    def get(self) -> Any:
        """The result.

        Raises:
            Exception: the error, if there is one.
        """
        if self.error is not None:
            raise self.error
        return self.result


class Task(NamedTuple):
    """What is done with each unit of work.

    Attributes:
        function: of a module that workers can import; called as `function(unit, *common)`.
        common: arguments that are the same for all units.
    """

    function: Callable[..., Any]
    common: tuple[Any, ...] = ()

    def __call__(self, unit: Any) -> Any:
        """What becomes of a unit."""
        return self.function(unit, *self.common)

    def outcomes(self, units: Sequence[Any]) -> list[Outcome]:
        """What becomes of several, one after the other; nothing is done after an error."""
        found = []
        for unit in units:
            try:
                found.append(Outcome(self(unit)))
            except Exception as error:
                found.append(Outcome(None, error))
                break
        return found


class Backend(ABC):
    """Carries out units of work, several at a time, in processes that do one after the other.

    What is lost with a process or a machine is carried out again, so that work may be done more than once;
    its result comes once.

    Attributes:
        on_this_machine: whether all workers are processes of this machine.
    """

    on_this_machine: bool = False

    @abstractmethod
    def workers(self) -> int:
        """How many units can be under way at a time, as far as that is known.

        Raises:
            BackendError: if the backend cannot be used.
        """

    @abstractmethod
    def run(self, task: Task, units: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Carry out a task for each of some units.

        Yields:
            The number of a unit and its result, as they end.

        Raises:
            WorkLostError: if workers are killed again and again: at the end, where others succeed.
            BackendError: if the backend cannot be used.
            Exception: whatever the task raises; no result comes after that.
        """

    def close(self) -> None:  # noqa: B027, since not every backend has something to let go of
        """Let go of workers."""
