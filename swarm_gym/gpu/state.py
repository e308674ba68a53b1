"""The state of swarms on a device, and how kernels see it.

Arrays are tensors of torch, so that networks read observations and rewards where they are. Kernels read the
same memory. In the simulator of numba-cuda, the device is the memory of the host.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple, overload

import numpy as np
import torch
from numba import cuda
from numpy.typing import NDArray

from swarm_gym.compiler.named_tuples import Row
from swarm_gym.errors import SettingError
from swarm_gym.gpu.host import free_host_memory
from swarm_gym.gpu.warps import BLOCK, IS_SIMULATED, NUM_LANES
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Tables

_NUM_BLOCKS = NUM_LANES // BLOCK


def torch_device() -> torch.device:
    """Return the device of tensors that kernels can work on.

    Raises:
        SettingError: if there is no GPU that torch and CUDA can use, and no simulator either.
    """
    if IS_SIMULATED:
        return torch.device("cpu")
    if not torch.cuda.is_available():
        raise SettingError(
            "device 'cuda': torch finds no GPU here; it takes one of NVIDIA, a build of torch for CUDA and "
            "the extra 'gpu'; NUMBA_ENABLE_CUDASIM=1, set before Python starts, simulates one, for tests"
        )
    return torch.device("cuda", torch.cuda.current_device())


@contextmanager
def beside_torch(device: torch.device) -> Iterator[object]:
    """Make a device the present one of CUDA; yield the stream in which torch works there.

    Kernels in this stream begin when torch has ended its earlier work there; its later work waits for them.
    """
    if IS_SIMULATED:
        yield 0
        return
    with torch.cuda.device(device):
        handle = torch.cuda.current_stream().cuda_stream
        yield cuda.external_stream(handle) if handle else 0


@overload
def as_kernels_see(arrays: Row) -> Row: ...


@overload
def as_kernels_see(arrays: torch.Tensor) -> NDArray: ...


def as_kernels_see(arrays: "NamedTuple | torch.Tensor") -> "NamedTuple | NDArray":
    """Return tensors, a NamedTuple or one, as arrays of kernels on the same memory.

    Words of random streams, the field `stream`, are unsigned there; torch has them as signed integers.
    """
    if isinstance(arrays, tuple):
        seen = {name: as_kernels_see(one) for name, one in arrays._asdict().items()}
        if "stream" in seen:
            seen["stream"] = seen["stream"].view(np.uint64)
        return type(arrays)._make(seen.values())
    return arrays.numpy() if IS_SIMULATED else cuda.as_cuda_array(arrays)


def with_lanes(array: np.ndarray, fill: float = 0.0) -> np.ndarray:
    """Return an array whose last axis has one entry for each lane; those beyond its length are `fill`."""
    out = np.full((*array.shape[:-1], NUM_LANES), fill, dtype=array.dtype)
    out[..., : array.shape[-1]] = array
    return out


def with_numbers(array: np.ndarray, number: type[np.floating]) -> np.ndarray:
    """Return an array whose floats have this type; arrays of integers and flags as they are."""
    return array.astype(number) if array.dtype == np.float64 else array


def tables_with_lanes(tables: Tables, number: type[np.floating] = np.float64) -> Tables:
    """Return stacked problem tables whose arrays over components or segments have one entry for each lane.

    The entries beyond them change nothing, as in `swarm_gym.problem.padding`. Floats have the type
    `number`.
    """
    fields = {name: with_numbers(array, number) for name, array in tables._asdict().items()}
    for name, array in fields.items():
        if name == "squared_spacing":  # beyond the path tiny, but not 0, see `analytic.table`
            tiny = float(np.finfo(number).tiny)
            fields[name] = with_lanes(np.maximum(array, tiny), tiny)
        elif name == "first_tile":  # blocks beyond the last one have no tiles
            more = np.repeat(array[:, -1:], _NUM_BLOCKS + 1 - array.shape[1], axis=1)
            fields[name] = np.concatenate([array, more], axis=1)
        elif name == "rows":  # one row of numbers for each problem; an obstacle's are BLOCK places apart
            fields[name] = array.reshape(len(array), -1)
        elif name == "first_row":  # the place of the tile's first number in that row
            fields[name] = BLOCK * array
        elif name in _OVER_COMPONENTS:
            fields[name] = with_lanes(array)
    return type(tables)(**fields)


_OVER_COMPONENTS = (
    "lower", "upper", "initial_lower", "initial_upper", "middles", "across", "modes", "optimum",
)  # fmt: skip


def allocate(num_swarms: int, capacity: int, memory_columns: int, arrival_window: int) -> Swarms:
    """Return empty swarms as NumPy arrays with a column for each lane.

    Each swarm has a register for each member, in which kernels note who stays when it shrinks.
    """
    return Swarms.allocate(
        num_swarms,
        capacity,
        NUM_LANES - 1,
        memory_columns,
        num_registers=capacity,
        arrival_window=arrival_window,
    )


def require_memory(needed: int, num_swarms: int) -> None:
    """Raise an error if arrays of this many bytes do not fit into the free memory of the device.

    Raises:
        SettingError: naming both numbers, before anything is allocated.
    """
    free = _free_memory()
    if needed > free:
        raise SettingError(
            f"num_envs: {num_swarms} swarms need {needed / 2**30:.1f} GiB, but only {free / 2**30:.1f} GiB "
            "of memory are free on device 'cuda'; take fewer swarms, or a smaller max_population_size"
        )


def bytes_of(num_swarms: int, capacity: int, memory_columns: int, history_columns: int, length: int) -> int:
    """Return about how many bytes the state of swarms takes, with their record of `length` iterations."""
    per_member = NUM_LANES + 2 + memory_columns + 1  # position, fitness and collision, memory, register
    per_swarm = capacity * per_member + 2 * NUM_LANES + 100
    return 8 * num_swarms * (per_swarm + (length + 1) * history_columns)


def _free_memory() -> int:
    if IS_SIMULATED:
        return free_host_memory()
    unused = torch.cuda.memory_reserved() - torch.cuda.memory_allocated()  # kept by torch for new tensors
    return int(torch.cuda.mem_get_info()[0]) + unused
