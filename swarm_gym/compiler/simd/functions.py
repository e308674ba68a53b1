"""What can be done with lanes, as it is with the JIT off: on NumPy arrays of length eight."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

NUM_LANES = 8

Lanes = NDArray[Any]  # shape (8,)


def padded(length: int) -> int:
    """The least multiple of eight that is no less."""
    return -(-length // NUM_LANES) * NUM_LANES


def load(array: NDArray, index: int) -> Lanes:
    """Eight neighbours of a one-dimensional array from `index` (not negative) on, or a row of (rows, 8)."""
    return array[index : index + NUM_LANES].copy() if array.ndim == 1 else array[index].copy()


def read(rows: NDArray, row: int, lane: int | None) -> Any:
    """A row of a (rows, 8) array as lanes where `lane` is None, else one number of it."""
    return rows[row].copy() if lane is None else rows[row, lane]


def store(array: NDArray, index: int, lanes: Lanes) -> None:
    """Write what `load` reads."""
    if array.ndim == 1:
        array[index : index + NUM_LANES] = lanes
    else:
        array[index] = lanes


def broadcast(value: float) -> Lanes:
    """The same float in all lanes."""
    return np.full(NUM_LANES, value, dtype=np.float64)


def where(mask: Any, yes: Any, no: Any) -> Any:
    """Floats of `yes` where the mask is true, else of `no`, lanes or numbers; or the same of one number."""
    return np.where(mask, yes, no)[()]


def maximum(a: Any, b: Any) -> Any:
    """The larger of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a > b, a, b)


def minimum(a: Any, b: Any) -> Any:
    """The smaller of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a < b, a, b)


def square_root(lanes: Lanes) -> Lanes:
    """Correctly rounded square roots."""
    return np.sqrt(lanes)


def floor(values: Any) -> Any:
    """The largest whole numbers that are no larger than lanes or a number, as floats."""
    return np.floor(values)


def look_up(values: NDArray[np.uint8], indices: Lanes) -> Lanes:
    """Entries of a one-dimensional array at whole, not negative indices, which are floats; as float64."""
    return values[indices.astype(np.int64)].astype(np.float64)


def as_float(words: Lanes) -> Lanes:
    """Words below 2^63 as float64."""
    return words.astype(np.float64)


def total(lanes: Lanes) -> float:
    """Sum of all lanes, by halves: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7))."""
    while len(lanes) > 1:
        half = len(lanes) // 2
        lanes = lanes[:half] + lanes[half:]
    return lanes[0]


def bits(mask: Lanes) -> int:
    """A mask as an integer: lane k is bit k."""
    return int(np.packbits(mask, bitorder="little")[0])
