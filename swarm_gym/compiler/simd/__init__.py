"""SIMD lanes: kernels compute with eight numbers at once, by the vector instructions of the processor.

A value of type `Lanes` holds eight float64 ("floats"), uint64 ("words") or truth values (a "mask"), one in
each lane. Arithmetic and comparisons are written as for plain numbers (`left + rise * share`, also with a
number on one side) and act on each lane alone. Lanes are values: `a = a + b`, not `a += b`. LLVM turns them
into vector instructions of whatever width the processor has. Since nothing is left to a vectorising compiler,
the bits are the same on all of them, and sums have the order of `total`.

Lanes exist inside kernels only. Arrays that are padded to a multiple of eight need no loops over a remainder.
With the JIT off, lanes are NumPy arrays of length eight and each function is the Python one in `functions`;
`compiled` registers its compiled form.
"""

from swarm_gym.compiler.simd import compiled  # noqa: F401
from swarm_gym.compiler.simd.functions import (
    NUM_LANES,
    Lanes,
    LanesOrNumber,
    as_float,
    bits,
    broadcast,
    floor,
    load,
    look_up,
    maximum,
    minimum,
    padded,
    read,
    square_root,
    store,
    total,
    where,
)

__all__ = [
    "NUM_LANES",
    "Lanes",
    "LanesOrNumber",
    "as_float",
    "bits",
    "broadcast",
    "floor",
    "load",
    "look_up",
    "maximum",
    "minimum",
    "padded",
    "read",
    "square_root",
    "store",
    "total",
    "where",
]
