"""Decorators of kernels, and what the lanes of a warp exchange, by the instructions of a GPU."""

import math
from collections.abc import Callable
from typing import TypeVar

from swarm_gym.errors import MissingExtraError
from swarm_gym.gpu.host import Entry

try:
    import numba_cuda  # noqa: F401  # Numba's own CUDA target is deprecated
    from numba import cuda
except ImportError as error:
    raise MissingExtraError("device 'cuda'", "numba-cuda", "gpu") from error

Function = TypeVar("Function", bound=Callable[..., object])

EVERY_LANE = 0xFFFFFFFF

# Of the type of their argument, float64 or float32.
square_root, exponential, logarithm, sine, cosine = math.sqrt, math.exp, math.log, math.sin, math.cos


def kernel(function: Function) -> Function:
    """Compile a function that only functions on the device call."""
    return cuda.jit(device=True, forceinline=True)(function)


def entry(function: Callable[..., None]) -> Entry:
    """Compile a function that the host launches."""
    return cuda.jit(function)


def launch(
    function: Entry, num_swarms: int, num_lanes: int, arguments: tuple[object, ...], stream: object
) -> None:
    """Run an entry on the device, with one warp for each swarm, in a stream of CUDA."""
    function[num_swarms, num_lanes, stream](*arguments)


@kernel
def natural(number: int) -> int:
    """Return a number from 0 to 2^31 - 1 as it is, in a form that shows the compiler this range.

    Numba lets a negative index count from the end of an array, and tests every index that may be negative.
    Without these tests, and with fewer products for addresses, 8,192 swarms of 60 members made 1.7 times as
    many steps per second on an H100.
    """
    return number & 0x7FFFFFFF


@kernel
def lane_number() -> int:
    """Return the number of this lane, 0 to 31."""
    return natural(cuda.threadIdx.x)


@kernel
def swarm_number() -> int:
    """Return the number of the swarm that this warp works on."""
    return natural(cuda.blockIdx.x)


@kernel
def from_lane(value: float, lane: int) -> float:
    """Return the value that another lane has; all lanes have to call this, as all functions of a warp."""
    return cuda.shfl_sync(EVERY_LANE, value, lane)


@kernel
def total(value: float) -> float:
    """Return the sum over all lanes, in the order of sums on the CPU.

    These add the blocks of eight, then `swarm_gym.compiler.simd.total` adds by halves.
    """
    lane = cuda.threadIdx.x & 7
    found = cuda.shfl_sync(EVERY_LANE, value, lane) + cuda.shfl_sync(EVERY_LANE, value, lane + 8)
    found = found + cuda.shfl_sync(EVERY_LANE, value, lane + 16)
    found = found + cuda.shfl_sync(EVERY_LANE, value, lane + 24)
    found = found + cuda.shfl_xor_sync(EVERY_LANE, found, 4)
    found = found + cuda.shfl_xor_sync(EVERY_LANE, found, 2)
    return found + cuda.shfl_xor_sync(EVERY_LANE, found, 1)


@kernel
def largest(value: float) -> float:
    """Return the largest number of all lanes."""
    for distance in (16, 8, 4, 2, 1):
        value = max(value, cuda.shfl_xor_sync(EVERY_LANE, value, distance))
    return value


@kernel
def ballot(flag: bool) -> int:
    """Return an integer whose bit k says whether the flag of lane k is true."""
    return cuda.ballot_sync(EVERY_LANE, flag)


@kernel
def lowest_bit(word: int) -> int:
    """Return the number of the lowest bit that is set, -1 for 0."""
    return cuda.ffs(word) - 1


@kernel
def wait() -> None:
    """Let all lanes see what the others have written."""
    cuda.syncwarp()
