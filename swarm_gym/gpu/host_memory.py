"""The free memory of this machine, on which the simulator of numba-cuda has the arrays of the device."""

import os
import sys


def free_host_memory() -> int:
    """Return the free memory of this machine in bytes, or `sys.maxsize` where the system does not tell it.

    Linux tells it. macOS does not know the name of the number, and Windows has no such function.
    """
    try:
        page, number = os.sysconf("SC_PAGE_SIZE"), os.sysconf("SC_AVPHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return sys.maxsize
    return page * number if page > 0 and number >= 0 else sys.maxsize
