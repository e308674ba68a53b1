"""The host's side: entries that it launches, and its own free memory.

The simulator of numba-cuda has the arrays of the device in the memory of the host.
"""

import os
import sys
from collections.abc import Callable
from typing import Protocol


class Entry(Protocol):
    """A compiled function that the host launches, as numba-cuda makes it."""

    def __getitem__(self, configuration: tuple[object, ...], /) -> Callable[..., None]:
        """Return the function for a number of blocks, a number of threads each, and perhaps a stream."""


def free_host_memory() -> int:
    """Return the free memory of this machine in bytes, or `sys.maxsize` where the system does not tell it.

    Linux tells it. macOS does not know the name of the number, and Windows has no such function.
    """
    try:
        page, number = os.sysconf("SC_PAGE_SIZE"), os.sysconf("SC_AVPHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return sys.maxsize
    return page * number if page > 0 and number >= 0 else sys.maxsize
