"""The functions of `hardware` in Python, for the simulator of numba-cuda.

The simulator runs a thread for each lane. It knows no instructions of warps, so lanes exchange numbers
through shared memory. It replaces `cuda` in the module of the function that is launched, which is this one.
"""

import math
import sys
import threading
import warnings
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError
from swarm_gym.gpu.host import Entry

try:
    import numba_cuda  # noqa: F401  # Numba's own CUDA target is deprecated
    from numba import cuda
except ImportError as error:
    raise MissingExtraError("device 'cuda'", "numba-cuda", "gpu") from error

Function = TypeVar("Function", bound=Callable[..., object])

_NUM_LANES = 32
# Seconds for which a thread keeps the others waiting at most; by Python's default of 5 ms, an exchange takes
# several times as long.
_SWITCH_INTERVAL = 2e-4
_own = threading.local()  # of each lane
_one_at_a_time = threading.Lock()


def kernel(function: Function) -> Function:
    """Return a function that only functions on the device call, as it is."""
    return function


def entry(function: Callable[..., None]) -> Entry:
    """Return a function that the host launches."""

    def run(*arguments: object) -> None:
        function(*arguments)

    return cuda.jit(run)


def launch(
    function: Entry,
    num_swarms: int,
    num_lanes: int,
    arguments: tuple[object, ...],
    stream: object,  # the simulator runs nothing beside others
) -> None:
    """Run an entry, one swarm after the other."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_INTERVAL)
    try:
        with warnings.catch_warnings():
            # Words of a random stream wrap around by design; NumPy's scalars would warn of it.
            warnings.filterwarnings("ignore", "overflow encountered", RuntimeWarning)
            function[num_swarms, num_lanes](*arguments)
    finally:
        sys.setswitchinterval(interval)


def natural(number: int) -> int:
    """Return a number from 0 to 2^31 - 1 as it is, see `hardware.natural`."""
    return number


def lane_number() -> int:
    """Return the number of this lane, 0 to 31."""
    return cuda.threadIdx.x


def swarm_number() -> int:
    """Return the number of the swarm that this warp works on."""
    return cuda.blockIdx.x


def from_lane(value: float, lane: int) -> float:
    """Return the value that another lane has."""
    return _all(value)[lane]


def total(value: float) -> float:
    """Return the sum over all lanes, in the order of sums on the CPU, see `hardware.total`."""
    v = _all(value)
    by_column = [((v[k] + v[k + 8]) + v[k + 16]) + v[k + 24] for k in range(8)]
    halves = [by_column[k] + by_column[k + 4] for k in range(4)]
    return (halves[0] + halves[2]) + (halves[1] + halves[3])


def largest(value: float) -> float:
    """Return the largest number of all lanes."""
    return max(_all(value))


def ballot(flag: bool) -> int:
    """Return an integer whose bit k says whether the flag of lane k is true."""
    return sum(1 << lane for lane, is_set in enumerate(_all(float(flag))) if is_set)


def lowest_bit(word: int) -> int:
    """Return the number of the lowest bit that is set, -1 for 0."""
    return (word & -word).bit_length() - 1


def _of_its_type(function: Callable[[float], float]) -> Callable[[float], float]:
    """Return a function whose values have the type of its argument, float64 or float32."""
    return lambda value: type(value)(function(value))


square_root, exponential, logarithm, sine, cosine = map(
    _of_its_type, (math.sqrt, math.exp, math.log, math.sin, math.cos)
)


def wait() -> None:
    """Let all lanes see what the others have written."""
    cuda.syncthreads()


def _all(value: float) -> list[float]:
    """Return the numbers of all lanes.

    Two rows take turns: no lane writes into a row while another one may still read it.
    """
    values = _shared_rows()
    turn = _own.turn = _own.turn ^ 1
    values[turn, cuda.threadIdx.x] = value
    cuda.syncthreads()
    return [type(value)(number) for number in values[turn].tolist()]


def _shared_rows() -> NDArray[np.float64]:
    """Return two rows of numbers, (2, 32), that the lanes of this warp share."""
    if not hasattr(_own, "rows"):  # this thread is a lane that has just begun
        with _one_at_a_time:  # the simulator looks for the rows, and makes them if there are none
            _own.rows = cuda.shared.array((2, _NUM_LANES), np.float64)
        _own.turn = 0
    return _own.rows
