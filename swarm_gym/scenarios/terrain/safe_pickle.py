"""Pickled arrays, dictionaries, lists and numbers, read without running code of the file.

A pickle can name any function and have it called. Here six names have a meaning, each defined by code below;
every other name is refused before anything is imported. NumPy restores nothing itself, since crafted states
of arrays and types can break its memory. Shapes, types of numbers and bytes are taken from the file, and
checked.
"""

import io
import math
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file

MAX_FILE = 2**31  # bytes
DEEPEST = 20  # lists and dictionaries in each other


def load_arrays(path: Path) -> object:
    """Return the content of a pickle that has only arrays, dictionaries, lists, tuples, texts and numbers.

    Raises:
        ScenarioError: if the file cannot be read, or has anything else.
    """
    try:
        with open_file(path) as file:
            content = file.read(MAX_FILE + 1)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    if len(content) > MAX_FILE:
        raise ScenarioError(f"{path}: expected at most {MAX_FILE} bytes, the file has more")
    try:
        return _plain(_Unpickler(io.BytesIO(content)).load(), DEEPEST)
    except Exception as error:  # a damaged pickle may raise anything
        raise ScenarioError(f"{path}: refused as a pickle of arrays: {shown(str(error))}") from error


# The reader in Python, whose steps touch Python objects only.
class _Unpickler(pickle._Unpickler):
    """A reader that knows arrays and numbers of NumPy, and nothing else."""

    def find_class(self, module: str, name: str) -> Any:
        """Return what a name of the file stands for here.

        Raises:
            pickle.UnpicklingError: for every name except NumPy's arrays and numbers.
        """
        known = _KNOWN.get((module.replace("numpy._core", "numpy.core"), name))
        if known is None:
            raise pickle.UnpicklingError(f"it names {module}.{name}, and only arrays and numbers are read")
        return known

    def persistent_load(self, _: Any) -> NoReturn:
        """Refuse objects that are kept elsewhere."""
        raise pickle.UnpicklingError("it refers to objects outside the file")


class _Named:
    """A function that the file may name; it has no state that the file could change."""

    __slots__ = ("_call",)
    _call: Callable[..., Any]

    def __init__(self, call: Callable[..., Any]):
        object.__setattr__(self, "_call", call)

    def __call__(self, *arguments: Any) -> Any:
        return self._call(*arguments)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise pickle.UnpicklingError("it changes a function")

    def __setstate__(self, state: object) -> NoReturn:
        raise pickle.UnpicklingError("it changes a function")


class _DType:
    """A type of numbers."""

    __slots__ = ("code", "order")

    def __init__(self, code: str):
        self.code, self.order = code, "="

    def __setstate__(self, state: Any) -> None:
        if not isinstance(state, tuple) or len(state) < 2 or state[1] not in ("<", ">", "|", "="):
            raise pickle.UnpicklingError("it has a type of numbers with another state")
        self.order = state[1]


class _Array:
    """An array, whose content follows in the file."""

    __slots__ = ("value",)

    def __init__(self) -> None:
        self.value: Any = None

    def __setstate__(self, state: Any) -> None:
        if not isinstance(state, tuple) or len(state) != 5:
            raise pickle.UnpicklingError("it has an array with another state")
        _, shape, dtype, fortran, content = state
        self.value = _numbers(content, dtype, shape, "F" if fortran is True else "C")


def _numbers(content: object, dtype: object, shape: object, order: object) -> Any:
    """Return an array of bytes of the file.

    Raises:
        pickle.UnpicklingError: if type, shape and number of bytes do not fit.
    """
    if not isinstance(content, bytes | bytearray) or not isinstance(dtype, _DType):
        raise pickle.UnpicklingError("it has an array of objects, and only numbers are read")
    if not isinstance(shape, tuple) or not all(type(side) is int and side >= 0 for side in shape):
        raise pickle.UnpicklingError("it has an array of another shape")
    numbers = np.dtype(dtype.code).newbyteorder(dtype.order)  # type: ignore[arg-type]
    if len(shape) > 8 or math.prod(shape) * numbers.itemsize != len(content) or order not in ("C", "F"):
        raise pickle.UnpicklingError("it has an array whose shape and bytes differ")
    return np.frombuffer(bytes(content), numbers).reshape(shape, order=order)


def _plain(found: Any, depth: int) -> Any:
    """Return a content with arrays of NumPy in it.

    Raises:
        pickle.UnpicklingError: for anything else but dictionaries, lists, tuples, texts and numbers.
    """
    if isinstance(found, _Array):
        if found.value is None:
            raise pickle.UnpicklingError("it has an array without content")
        return found.value
    if found is None or type(found) in (str, bytes, bool, int, float, np.ndarray):
        return found
    if depth == 0:
        raise pickle.UnpicklingError("it has lists too deep in each other")
    if type(found) is dict:
        return {key: _plain(value, depth - 1) for key, value in found.items()}
    if type(found) in (list, tuple):
        return [_plain(value, depth - 1) for value in found]
    raise pickle.UnpicklingError(f"it has {type(found).__name__}, and only arrays and numbers are read")


def _class_of_arrays(*_: object) -> NoReturn:
    """Stand for the class of arrays, which only `_reconstruct` may be given."""
    raise pickle.UnpicklingError("it calls the class of arrays")


def _reconstruct(kind: object, *_: object) -> _Array:
    """Return an array whose content follows."""
    if kind is not _KNOWN["numpy", "ndarray"]:
        raise pickle.UnpicklingError("it has an array of another class")
    return _Array()


def _dtype(code: object, *_: object) -> _DType:
    """Return the type of numbers that a short text stands for."""
    if not isinstance(code, str) or not re.fullmatch("b1|[iu][1248]|f[248]", code):
        raise pickle.UnpicklingError(f"it has the dtype {shown(code)}, and only numbers are read")
    return _DType(code)


def _scalar(dtype: object, content: object) -> Any:
    """Return a single number."""
    return _numbers(content, dtype, (), "C").item()


def _encode(text: object, coding: object) -> bytes:
    """Return the bytes that old protocols write as text."""
    if not isinstance(text, str) or coding != "latin1":
        raise pickle.UnpicklingError("it has bytes of another kind")
    return text.encode("latin1")


_KNOWN: dict[tuple[str, str], _Named] = {
    ("numpy.core.multiarray", "_reconstruct"): _Named(_reconstruct),
    ("numpy.core.multiarray", "scalar"): _Named(_scalar),
    ("numpy.core.numeric", "_frombuffer"): _Named(_numbers),
    ("numpy", "ndarray"): _Named(_class_of_arrays),
    ("numpy", "dtype"): _Named(_dtype),
    ("_codecs", "encode"): _Named(_encode),
}
