"""Arrays of objects in infos: names of scenarios, and last observations of episodes.

Gymnasium's wrappers for other array libraries, such as `gymnasium.wrappers.vector.NumpyToTorch`, convert
all arrays in infos. No such library has arrays of objects, so the wrappers fail. Here they learn to keep such
arrays, and to convert the arrays inside.
"""

import sys
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np

Shape = TypeVar("Shape", bound=tuple[int, ...])
Kind = TypeVar("Kind", bound=np.dtype)

# Modules of Gymnasium, and the function there that converts infos: the first since version 1.2.
_CONVERSIONS = {
    "gymnasium.wrappers.array_conversion": "array_conversion",
    "gymnasium.wrappers.numpy_to_torch": "numpy_to_torch",
}


class ObjectArray(np.ndarray):
    """A NumPy array of objects that Gymnasium's wrappers keep as it is.

    Make one as a view: `array.view(ObjectArray)`. Comparisons and functions return plain arrays.
    """

    def __array_wrap__(
        self, array: np.ndarray[Shape, Kind], _context: object = None, return_scalar: bool = False
    ) -> np.ndarray[Shape, Kind]:
        plain = array[()] if return_scalar else np.asarray(array)
        return cast(np.ndarray[Shape, Kind], plain)


def let_wrappers_keep_objects() -> None:
    """Register `ObjectArray` with the wrappers of Gymnasium, if they are imported and do not know it yet."""
    for module, name in _CONVERSIONS.items():
        convert: Any = getattr(sys.modules.get(module), name, None)
        # In Gymnasium 1.2 and later, `numpy_to_torch` calls the other function and has no registry.
        if ObjectArray not in getattr(convert, "registry", (ObjectArray,)):
            convert.register(ObjectArray, _keeping(convert))


def _keeping(convert: Callable[..., Any]) -> Callable[..., ObjectArray]:
    """Return a function that keeps an array of objects, and converts the arrays that are its entries."""

    def keep(value: ObjectArray, *arguments: Any, **options: Any) -> ObjectArray:
        kept = value.copy()
        for place, entry in enumerate(value):
            if isinstance(entry, np.ndarray):
                kept[place] = convert(entry, *arguments, **options)
        return kept

    return keep
