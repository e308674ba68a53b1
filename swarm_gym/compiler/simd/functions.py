"""The functions of lanes in Python, on NumPy arrays of length eight, as they run with the JIT off."""

from typing import TypeVar, overload

import numpy as np
from numpy.typing import NDArray

NUM_LANES = 8

# Of shape (8,) each: floats, words and a mask.
Lanes = NDArray[np.float64]
Words = NDArray[np.uint64]
Mask = NDArray[np.bool_]
LanesOrNumber = Lanes | float
Entry = TypeVar("Entry", bound=np.generic)


def padded(length: int) -> int:
    """Return the least multiple of eight that is no less than a length."""
    return -(-length // NUM_LANES) * NUM_LANES


def load(array: NDArray[Entry], index: int) -> NDArray[Entry]:
    """Return eight entries of an array (n,) from `index` (not negative) on, or a row of one (rows, 8)."""
    return array[index : index + NUM_LANES].copy() if array.ndim == 1 else array[index].copy()


def read(rows: Lanes, row: int, lane: int | None) -> LanesOrNumber:
    """Return a row of a (rows, 8) array as lanes if `lane` is None, else one number of it."""
    return rows[row].copy() if lane is None else rows[row, lane]


def store(array: NDArray[Entry], index: int, lanes: NDArray[Entry]) -> None:
    """Write lanes to where `load` reads them."""
    if array.ndim == 1:
        array[index : index + NUM_LANES] = lanes
    else:
        array[index] = lanes


def broadcast(value: float) -> Lanes:
    """Return one float in all lanes."""
    return np.full(NUM_LANES, value, dtype=np.float64)


@overload
def where(mask: Mask, yes: LanesOrNumber, no: LanesOrNumber) -> Lanes: ...


@overload
def where(mask: bool, yes: float, no: float) -> float: ...


@overload
def where(mask: bool | Mask, yes: LanesOrNumber, no: LanesOrNumber) -> LanesOrNumber: ...


def where(mask: bool | Mask, yes: LanesOrNumber, no: LanesOrNumber) -> LanesOrNumber:
    """Return the floats of `yes` where the mask is true, else of `no`; all are lanes or numbers."""
    return np.where(mask, yes, no)[()]


@overload
def maximum(a: Lanes, b: LanesOrNumber) -> Lanes: ...


@overload
def maximum(a: float, b: Lanes) -> Lanes: ...


@overload
def maximum(a: float, b: float) -> float: ...


def maximum(a: LanesOrNumber, b: LanesOrNumber) -> LanesOrNumber:
    """Return the larger of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a > b, a, b)


@overload
def minimum(a: Lanes, b: LanesOrNumber) -> Lanes: ...


@overload
def minimum(a: float, b: Lanes) -> Lanes: ...


@overload
def minimum(a: float, b: float) -> float: ...


def minimum(a: LanesOrNumber, b: LanesOrNumber) -> LanesOrNumber:
    """Return the smaller of each pair, or of two numbers; `b` where they are equal or cannot be compared."""
    return where(a < b, a, b)


def square_root(lanes: Lanes) -> Lanes:
    """Return correctly rounded square roots."""
    return np.sqrt(lanes)


@overload
def floor(values: Lanes) -> Lanes: ...


@overload
def floor(values: float) -> float: ...


def floor(values: LanesOrNumber) -> LanesOrNumber:
    """Return, as floats, the largest whole numbers that are no larger than lanes or a number."""
    return np.floor(values)


def look_up(values: NDArray[np.uint8], indices: Lanes) -> Lanes:
    """Return, as float64, entries of an array (n,) at whole, not negative indices, which are floats."""
    return values[indices.astype(np.int64)].astype(np.float64)


def as_float(words: Words) -> Lanes:
    """Return words below 2^63 as float64."""
    return words.astype(np.float64)


def total(lanes: Lanes) -> float:
    """Return the sum of all lanes, by halves: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7))."""
    while len(lanes) > 1:
        half = len(lanes) // 2
        lanes = lanes[:half] + lanes[half:]
    return lanes[0]


def bits(mask: Mask) -> int:
    """Return a mask as an integer: lane k is bit k."""
    return int(np.packbits(mask, bitorder="little")[0])
