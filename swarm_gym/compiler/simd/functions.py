"""The functions of lanes in Python, on NumPy arrays of length eight, as they run with the JIT off."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

NUM_LANES = 8

Lanes = NDArray[Any]  # shape (8,)


def padded(length: int) -> int:
    """Return the least multiple of eight that is no less than a length."""
    return -(-length // NUM_LANES) * NUM_LANES


def load(array: NDArray, index: int) -> Lanes:
    """Return eight entries of an array (n,) from `index` (not negative) on, or a row of one (rows, 8)."""
    return array[index : index + NUM_LANES].copy() if array.ndim == 1 else array[index].copy()


def read(rows: NDArray, row: int, lane: int | None) -> Any:
    """Return a row of a (rows, 8) array as lanes if `lane` is None, else one number of it."""
    return rows[row].copy() if lane is None else rows[row, lane]


def store(array: NDArray, index: int, lanes: Lanes) -> None:
    """Write lanes to where `load` reads them."""
    if array.ndim == 1:
        array[index : index + NUM_LANES] = lanes
    else:
        array[index] = lanes


def broadcast(value: float) -> Lanes:
    """Return one float in all lanes."""
    return np.full(NUM_LANES, value, dtype=np.float64)


def where(mask: Any, yes: Any, no: Any) -> Any:
    """Return the floats of `yes` where the mask is true, else of `no`; all are lanes or numbers."""
    return np.where(mask, yes, no)[()]


def maximum(a: Any, b: Any) -> Any:
    """Return the larger of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a > b, a, b)


def minimum(a: Any, b: Any) -> Any:
    """Return the smaller of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a < b, a, b)


def square_root(lanes: Lanes) -> Lanes:
    """Return correctly rounded square roots."""
    return np.sqrt(lanes)


def floor(values: Any) -> Any:
    """Return, as floats, the largest whole numbers that are no larger than lanes or a number."""
    return np.floor(values)


def look_up(values: NDArray[np.uint8], indices: Lanes) -> Lanes:
    """Return, as float64, entries of an array (n,) at whole, not negative indices, which are floats."""
    return values[indices.astype(np.int64)].astype(np.float64)


def as_float(words: Lanes) -> Lanes:
    """Return words below 2^63 as float64."""
    return words.astype(np.float64)


def total(lanes: Lanes) -> float:
    """Return the sum of all lanes, by halves: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7))."""
    while len(lanes) > 1:
        half = len(lanes) // 2
        lanes = lanes[:half] + lanes[half:]
    return lanes[0]


def bits(mask: Lanes) -> int:
    """Return a mask as an integer: lane k is bit k."""
    return int(np.packbits(mask, bitorder="little")[0])
