"""Commands: how they read numbers, and how they end.

Any interruption or expected error becomes one line and an exit status.
"""

import argparse
import os
import re
import select
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

LONGEST = 5_000  # characters of an error message
# Exit statuses of shells for processes that a signal ended.
INTERRUPTED = 128 + signal.SIGINT
TERMINATED = 128 + signal.SIGTERM
PIPE_CLOSED = 128 + 13  # of SIGPIPE, which not all systems have


class NumberParser(argparse.ArgumentParser):
    """A parser of arguments that takes a minus sign with a digit for a value, not for an option.

    So `--start -0.5,0.5` and `--shift -1e-3` need no equals sign. Python does the same from version 3.14 on.
    Before, it does so for plain numbers only.
    """

    def __init__(
        self,
        prog: str | None = None,
        description: str | None = None,
        epilog: str | None = None,
        formatter_class: type[argparse.HelpFormatter] = argparse.HelpFormatter,
    ):
        super().__init__(prog, description=description, epilog=epilog, formatter_class=formatter_class)
        self._negative_number_matcher = re.compile(r"-\.?\d")


def point(text: str) -> tuple[float, float]:
    """Return the two numbers of an argument `x,y`.

    Raises:
        argparse.ArgumentTypeError: for any other text.
    """
    try:
        x, y = (float(number) for number in text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"expected two numbers x,y, got {text!r}") from error
    return x, y


def budget(text: str) -> tuple[int | None, float | None]:
    """Return the evaluations or the seconds of an argument such as `50000` or `2s`; the other is None.

    Raises:
        argparse.ArgumentTypeError: for any other text.
    """
    try:
        return (None, float(text[:-1])) if text.endswith("s") else (int(text), None)
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"expected evaluations such as 50000 or seconds such as 2s, got {text!r}"
        ) from error


class _Terminated(BaseException):
    """The arrival of SIGTERM or Ctrl-Break; a `BaseException`, so that no `except Exception` stops it."""


@contextmanager
def command(*errors: type[Exception], kept: str = "") -> Iterator[None]:
    """Run a command; turn errors and signals into a line on standard error and an exit status.

    | end | exit status |
    |---|---|
    | `OSError` (a full disk, a read-only folder), `ValueError`, one of `errors` | 1 |
    | Ctrl-C | 130 |
    | SIGTERM, which batch systems send before they kill; on Windows Ctrl-Break | 143 |
    | standard output is closed, as by `head` after its lines; without a message | 141 |

    Messages have at most `LONGEST` characters. After Ctrl-C and SIGTERM files are closed and worker
    processes end, as after an error. Any other exception is a mistake in the program and is raised with its
    traceback.

    Args:
        errors: further exceptions whose messages are sufficient for users.
        kept: for the message: what an interrupted command has kept, and how to continue.
    """
    expected: tuple[type[Exception], ...] = (OSError, ValueError, *errors)
    with _raising_on_signals():
        try:
            with quiet_without_readers():
                yield
        except KeyboardInterrupt:
            _end("interrupted", kept, INTERRUPTED)
        except _Terminated:
            _end("terminated", kept, TERMINATED)
        except expected as error:
            more = f"; {kept}" if kept and isinstance(error, OSError) else ""
            sys.exit(f"error: {_shortened(str(error))}{more}")


@contextmanager
def quiet_without_readers() -> Iterator[None]:
    """End with status 141 where nobody reads standard output any more; files are to be written before."""
    try:
        try:
            yield
        except SystemExit:  # after a help text
            sys.stdout.flush()
            raise
        sys.stdout.flush()
    except BrokenPipeError:
        if not _reader_is_gone():
            raise  # another pipe, such as that of a worker process
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(PIPE_CLOSED)


def _reader_is_gone() -> bool:
    if not hasattr(select, "poll"):
        return True
    poll = select.poll()
    poll.register(sys.stdout.fileno(), 0)
    return any(event & select.POLLERR for _, event in poll.poll(0))


@contextmanager
def warnings_in_a_line() -> Iterator[None]:
    """Print warnings to standard error, each in a line without the place in the code."""

    def show(message: Warning | str, *_: object, **__: object) -> None:
        print(f"warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = show
        yield


def _shortened(message: str) -> str:
    """Return a message of at most `LONGEST` characters; what is left out of a longer one is its middle."""
    if len(message) <= LONGEST:
        return message
    gap = f" ... ({len(message) - LONGEST:,} characters more) ... "
    half = (LONGEST - len(gap)) // 2
    return f"{message[:half]}{gap}{message[-half:]}"


def _end(what: str, kept: str, status: int) -> NoReturn:
    # A progress bar may have begun the line.
    print(f"\n{what}; {kept}" if kept else f"\n{what}", file=sys.stderr, flush=True)
    sys.exit(status)


@contextmanager
def _raising_on_signals() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield  # in Python only the main thread handles signals
        return
    process = os.getpid()

    def terminate(*_: object) -> None:
        if os.getpid() != process:  # a forked copy of this process must not run the command's clean-up
            os._exit(TERMINATED)
        raise _Terminated

    # Nobody can send SIGTERM on Windows; Ctrl-Break is the signal that one process sends another there.
    ending = [getattr(signal, name) for name in ("SIGTERM", "SIGBREAK") if hasattr(signal, name)]
    previous = {number: signal.signal(number, terminate) for number in ending}
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
