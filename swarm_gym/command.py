"""How commands end: whatever ends them, one line says so, and the exit status tells it to scripts."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

# As shells report a process that a signal ended.
INTERRUPTED = 128 + signal.SIGINT
TERMINATED = 128 + signal.SIGTERM


class _Terminated(BaseException):
    """SIGTERM has come; no `except Exception` shall stop it."""


@contextmanager
def command(*errors: type[Exception], kept: str = "") -> Iterator[None]:
    """Carry out a command: what ends it early becomes a line on standard error and an exit status.

    | what ends it | exit status |
    |---|---|
    | `OSError` (a full disk, a folder that is read only), `ValueError`, one of `errors` | 1 |
    | Ctrl-C | 130 |
    | SIGTERM, as batch systems send it before they kill | 143 |

    After Ctrl-C and SIGTERM files are closed and worker processes end, as after an error. Any other exception
    is a mistake in the program and comes with its traceback.

    Args:
        errors: more exceptions that say what is wrong by themselves.
        kept: for the message: what an interrupted command has kept, and how one goes on.
    """
    expected: tuple[type[Exception], ...] = (OSError, ValueError, *errors)
    with _raising_on_sigterm():
        try:
            yield
        except KeyboardInterrupt:
            _end("interrupted", kept, INTERRUPTED)
        except _Terminated:
            _end("terminated", kept, TERMINATED)
        except expected as error:
            more = f"; {kept}" if kept and isinstance(error, OSError) else ""
            sys.exit(f"error: {error}{more}")


def _end(what: str, kept: str, status: int) -> NoReturn:
    # A progress bar may have begun the line.
    print(f"\n{what}; {kept}" if kept else f"\n{what}", file=sys.stderr, flush=True)
    sys.exit(status)


@contextmanager
def _raising_on_sigterm() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield  # Python lets no other thread handle signals
        return
    process = os.getpid()

    def terminate(*_: Any) -> None:
        if os.getpid() != process:  # a copy of this process has no command to end
            os._exit(TERMINATED)
        raise _Terminated

    previous = signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)
