"""Decorators of kernels on a GPU, and what the lanes of a warp exchange.

One warp, 32 lanes, works on one swarm, and a block is one warp. Lane k holds component k of a position and
segment k of a path, so that arrays over components have 32 columns on the device.

Kernels compute in the type of the swarms' arrays, float64 or float32. So they use the numbers `ZERO`, `HALF`,
`ONE` and `TWO`: these are exact in float32, and do not turn a number of that type into float64.

The functions come from `hardware`, or with `NUMBA_ENABLE_CUDASIM=1` from `simulator`.
"""

from types import ModuleType
from typing import cast

import numba
import numpy as np

from swarm_gym.compiler import simd
from swarm_gym.gpu.host import Entry

NUM_LANES = 32
BLOCK = simd.NUM_LANES  # components or segments that share random numbers, sums and tiles, as on the CPU
IS_SIMULATED = bool(numba.config.ENABLE_CUDASIM)

_functions: ModuleType
if IS_SIMULATED:
    from swarm_gym.gpu import simulator as _functions
else:
    from swarm_gym.gpu import hardware as _functions

kernel, entry = _functions.kernel, _functions.entry
lane_number, swarm_number, wait = _functions.lane_number, _functions.swarm_number, _functions.wait
natural = _functions.natural
from_lane, total, largest = _functions.from_lane, _functions.total, _functions.largest
ballot, lowest_bit = _functions.ballot, _functions.lowest_bit
square_root, exponential, logarithm = _functions.square_root, _functions.exponential, _functions.logarithm
sine, cosine = _functions.sine, _functions.cosine

# Of float32, which the type checker does not count among the floats.
ZERO, HALF, ONE, TWO = (cast(float, np.float32(number)) for number in (0.0, 0.5, 1.0, 2.0))


def launch(function: Entry, num_swarms: int, *arguments: object, stream: object = 0) -> None:
    """Run an entry on the device, with one warp for each swarm, in a stream of CUDA; 0 is the default one."""
    _functions.launch(function, num_swarms, NUM_LANES, arguments, stream)


@kernel
def maximum(a: float, b: float) -> float:
    """Return the larger of two numbers; `b` where they are equal or cannot be compared, as on the CPU."""
    return a if a > b else b


@kernel
def minimum(a: float, b: float) -> float:
    """Return the smaller of two numbers; `b` where they are equal or cannot be compared, as on the CPU."""
    return a if a < b else b
