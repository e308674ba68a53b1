"""Pickled arrays, dictionaries, lists and numbers, read without running code of the file.

A pickle can name any function and have it called. Here six names have a meaning, which can only make arrays
of numbers; every other name is refused before anything is imported.
"""

import io
import pickle
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file

MAX_FILE = 2**31  # bytes
NUMERIC = "biuf"  # kinds of the dtypes that are read


class _Unpickler(pickle.Unpickler):
    """A reader that knows arrays and numbers of NumPy, and nothing else."""

    def find_class(self, module: str, name: str) -> Any:
        """Return what a name of the file stands for here.

        Raises:
            pickle.UnpicklingError: for every name but those of NumPy's arrays and numbers.
        """
        known = _KNOWN.get((module.replace("numpy._core", "numpy.core"), name))
        if known is None:
            raise pickle.UnpicklingError(f"it names {module}.{name}, and only arrays and numbers are read")
        return known

    def persistent_load(self, _: Any) -> NoReturn:
        """Refuse objects that are kept elsewhere."""
        raise pickle.UnpicklingError("it refers to objects outside the file")


def load_arrays(path: Path) -> Any:
    """Return the content of a pickle that has only arrays, dictionaries, lists, texts and numbers.

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
        return _Unpickler(io.BytesIO(content)).load()
    except Exception as error:  # a damaged pickle may raise anything
        raise ScenarioError(f"{path}: refused as a pickle of arrays: {shown(str(error))}") from error


def _ndarray(*_: object) -> NoReturn:
    """Stand for the class of arrays, which only `_reconstruct` may be given."""
    raise pickle.UnpicklingError("it calls the class of arrays")


def _reconstruct(kind: object, shape: object, _code: object) -> Any:
    """Return an empty array, whose content the pickle sets next."""
    if kind is not _ndarray or shape != (0,):
        raise pickle.UnpicklingError("it has an array of another class")
    return np.ndarray((0,), dtype=np.int8)


def _from_buffer(content: object, dtype: object, shape: object, order: object) -> Any:
    """Return an array of bytes of the file."""
    if not isinstance(content, bytes | bytearray) or not isinstance(dtype, np.dtype):
        raise pickle.UnpicklingError("it has an array without bytes or numbers")
    if dtype.kind not in NUMERIC or not isinstance(shape, tuple) or order not in ("C", "F"):
        raise pickle.UnpicklingError("it has an array of another kind")
    return np.frombuffer(content, dtype).reshape(shape, order=order)


def _dtype(code: object, *_: object) -> np.dtype[Any]:
    """Return the type of numbers that a short text stands for."""
    if not isinstance(code, str) or len(code) > 3:
        raise pickle.UnpicklingError(f"it has the dtype {shown(code)}")
    found: np.dtype[Any] = np.dtype(code, copy=True)
    if found.kind not in NUMERIC:
        raise pickle.UnpicklingError(f"it has the dtype {shown(code)}, and only numbers are read")
    return found


def _scalar(dtype: object, content: object) -> Any:
    """Return a single number."""
    if not isinstance(dtype, np.dtype) or dtype.kind not in NUMERIC or not isinstance(content, bytes):
        raise pickle.UnpicklingError("it has a number of another kind")
    return np.frombuffer(content, dtype, count=1)[0]


def _encode(text: object, coding: object) -> bytes:
    """Return the bytes that old protocols write as text."""
    if not isinstance(text, str) or coding != "latin1":
        raise pickle.UnpicklingError("it has bytes of another kind")
    return text.encode("latin1")


_KNOWN: dict[tuple[str, str], Any] = {
    ("numpy.core.multiarray", "_reconstruct"): _reconstruct,
    ("numpy.core.multiarray", "scalar"): _scalar,
    ("numpy.core.numeric", "_frombuffer"): _from_buffer,
    ("numpy", "ndarray"): _ndarray,
    ("numpy", "dtype"): _dtype,
    ("_codecs", "encode"): _encode,
}
