"""The interface of backends, which run units of work in processes of this machine or of others."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Generic, NamedTuple, TypeVar, cast

from swarm_gym.own_code import allow

Result = TypeVar("Result")

MOST_LOSSES = 3  # number of times that a unit of work may be lost before it is given up

# More processes use more cores, not more threads of each process; see also swarm_gym.training.learners.ppo.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


class BackendError(RuntimeError):
    """An error of a backend, which cannot be used or gives up; the message states the reason."""


class WorkLostError(BackendError):
    """Worker processes were killed repeatedly; units without a result were given up or not begun."""

    def __init__(self) -> None:
        super().__init__(
            f"worker processes were killed {MOST_LOSSES} times before one could finish its work; is memory "
            "short, or a time limit?"
        )


class GivenUp:
    """A counter of units that were given up since they were lost repeatedly; the other units still run.

    If the units are not to blame, as when all machines lack memory, no unit succeeds in between, and the
    whole work ends.
    """

    def __init__(self) -> None:
        self._in_all = self._in_a_row = 0

    def add(self) -> None:
        """Count a unit, or a job of several units, that was given up.

        Raises:
            WorkLostError: if `MOST_LOSSES` were given up in a row.
        """
        self._in_all += 1
        self._in_a_row += 1
        if self._in_a_row == MOST_LOSSES:
            raise WorkLostError

    def succeeded(self) -> None:
        """Record that a unit succeeded."""
        self._in_a_row = 0

    def end(self) -> None:
        """End the work after all other units.

        Raises:
            WorkLostError: if any unit was given up.
        """
        if self._in_all:
            raise WorkLostError


class Outcome(NamedTuple, Generic[Result]):
    """The outcome of a unit of work: a result, or the error that it raised."""

    result: Result | None
    error: Exception | None = None

    def get(self) -> Result:
        """Return the result.

        Raises:
            Exception: the error, if there is one.
        """
        if self.error is not None:
            raise self.error
        return cast(Result, self.result)


class Task(NamedTuple, Generic[Result]):
    """A function that is called for each unit of work.

    Attributes:
        function: function of a module that workers can import, called as `function(unit, *common)`.
        common: further arguments, the same for all units.
        own_code: names of own code that files of the task may name in workers, too.
    """

    function: Callable[..., Result]
    common: tuple[object, ...] = ()
    own_code: tuple[str, ...] = ()

    def __call__(self, unit: object) -> Result:
        """Return the result of a unit."""
        allow(*self.own_code)
        return self.function(unit, *self.common)

    def outcomes(self, units: Sequence[object]) -> list[Outcome[Result]]:
        """Run several units one after the other and return their outcomes, up to the first error."""
        found: list[Outcome[Result]] = []
        for unit in units:
            try:
                found.append(Outcome(self(unit)))
            except Exception as error:
                found.append(Outcome(None, error))
                break
        return found


class Backend(ABC):
    """A pool of worker processes; each runs one unit of work at a time.

    Units that are lost with a process or a machine are retried. A unit may therefore run more than once, but
    its result is yielded once.

    Attributes:
        on_this_machine: whether all workers are processes of this machine.
    """

    on_this_machine: bool = False

    @abstractmethod
    def workers(self) -> int:
        """Return the number of units that can run at a time, as far as it is known.

        Raises:
            BackendError: if the backend cannot be used.
        """

    @abstractmethod
    def run(self, task: Task[Result], units: Sequence[object]) -> Iterator[tuple[int, Result]]:
        """Run a task for each unit.

        Yields:
            The index of a unit and its result, in the order in which units end.

        Raises:
            WorkLostError: if workers are killed repeatedly; raised at the end if other units succeed.
            BackendError: if the backend cannot be used.
            Exception: the error of a task; no result is yielded after it.
        """

    def close(self) -> None:  # noqa: B027, since not every backend has something to release
        """Release the workers."""
