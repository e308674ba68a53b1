"""Arrays of NumPy or torch, on which simulations, layouts and rewards run alike.

The state of a simulation is NumPy arrays, or torch tensors if its kernels leave it on a GPU. `Simulation.xp`
is the namespace of its arrays: the module `numpy`, or torch under the names of the Python array API standard.
This module has what that standard lacks. Annotations of a simulation's state name arrays of NumPy; where its
kernels leave it on a GPU, these are tensors with the same operators.

A program that asks for the value of a tensor waits for all work of the GPU. Nothing here does so, except
`as_numpy`. For the same reason, functions of this module take Python's numbers where torch's numbers would
first copy them to the GPU.
"""

import operator
from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError

if TYPE_CHECKING:
    import torch

AnyArray: TypeAlias = "NDArray | torch.Tensor"
Array = TypeVar("Array", NDArray, "torch.Tensor")  # arguments and result are of one library
Namespace = ModuleType  # `numpy`, or that of tensors

_OPERATORS = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "power": operator.pow,
}


def tensors() -> Namespace:
    """Return the namespace of torch's tensors, whose functions have the names of the array API standard.

    Raises:
        MissingExtraError: if torch or array-api-compat is not installed.
    """
    try:
        from array_api_compat import torch
    except ImportError as error:
        raise MissingExtraError("a simulation on tensors", "torch and array-api-compat", "gpu") from error
    return torch


def namespace_of(array: AnyArray) -> Namespace:
    """Return the namespace of the functions for an array: the module `numpy`, or the namespace of tensors."""
    return np if isinstance(array, np.ndarray) else tensors()


def as_numpy(array: AnyArray) -> NDArray:
    """Return an array as one of NumPy; a tensor on a GPU is copied, when the GPU has done all its work."""
    return array if isinstance(array, np.ndarray) else np.asarray(array.cpu())


def placed(xp: Namespace, array: NDArray, device: object) -> NDArray:
    """Return a NumPy array as an array of a namespace on a device, which may share its memory.

    Words of 64 bits become signed integers with the same bits, since torch computes with those only.
    """
    if xp is np:
        return array
    return xp.asarray(array.view(np.int64) if array.dtype == np.uint64 else array, device=device)


class Constant:
    """A NumPy array that never changes, and its copies on other devices, each made when first asked for."""

    def __init__(self, values: NDArray):
        self._values = values
        self._copies: dict[tuple[str, str], NDArray] = {}

    def on(self, xp: Namespace, device: object) -> NDArray:
        """Return the values as an array of a namespace on a device; callers must not change it."""
        if xp is np:
            return self._values
        key = xp.__name__, str(device)
        if key not in self._copies:
            self._copies[key] = placed(xp, self._values.copy(), device)
        return self._copies[key]


def floats(xp: Namespace, array: Array) -> Array:
    """Return a copy of an array of numbers in float64, in which torch does not divide integers by itself."""
    return xp.array(array, dtype=xp.float64) if xp is np else xp.astype(array, xp.float64)


def integers(xp: Namespace, array: Array) -> Array:
    """Return a copy of an array of whole numbers in int64."""
    return xp.array(array, dtype=xp.int64) if xp is np else xp.astype(array, xp.int64)


def copy_of(xp: Namespace, array: Array) -> Array:
    """Return a copy of an array."""
    return xp.array(array, order="C") if xp is np else xp.asarray(array, copy=True)


def at_least(xp: Namespace, array: Array, smallest: float) -> Array:
    """Return max(array, smallest) elementwise; NaN stays."""
    return xp.maximum(array, smallest) if xp is np else xp.clip(array, smallest, None)


def at_most(xp: Namespace, array: Array, largest: float) -> Array:
    """Return min(array, largest) elementwise; NaN stays."""
    return xp.minimum(array, largest) if xp is np else xp.clip(array, None, largest)


def divided(xp: Namespace, numerator: Array, denominator: Array, where: Array, otherwise: float) -> Array:
    """Return numerator / denominator where a condition holds, else a number, without warnings for the rest.

    Args:
        xp: namespace of the arrays.
        numerator: (B,) floats.
        denominator: (B,) floats, not 0 where the condition holds.
        where: (B,) the condition.
        otherwise: value where it does not hold.
    """
    return xp.where(where, numerator / xp.where(where, denominator, 1.0), otherwise)


def assign(xp: Namespace, target: Array, values: Array, where: Array) -> None:
    """Write values into an array where a condition holds; both must broadcast to the shape of the array."""
    if xp is np:
        xp.copyto(target, values, where=where)
    else:
        target[...] = xp.where(where, values, target)


def with_columns(xp: Namespace, array: Array, columns: dict[int, Array]) -> Array:
    """Return a copy of an array (B, k) in which some columns, by number, have other values (B,)."""
    new = copy_of(xp, array)
    for number, values in columns.items():
        new[:, number] = values
    return new


def applied(function: Callable[[NDArray], NDArray], xp: Namespace, array: NDArray) -> NDArray:
    """Return function(array), where the function may use operators and NumPy's elementwise functions.

    Optimizers are written with NumPy, so a tensor is wrapped for them: see `_Elementwise`.

    Raises:
        TypeError: if the function calls one of NumPy's that has no namesake in the array API standard.
    """
    if xp is np:
        return function(array)
    tensor: Any = _Elementwise(xp, array)
    found: Any = function(tensor)
    return found.array


class _Elementwise(NDArrayOperatorsMixin):
    """A tensor to which operators and NumPy's elementwise functions, such as np.sqrt, can be applied."""

    def __init__(self, xp: Namespace, array: AnyArray):
        self.xp, self.array = xp, array

    def __array_ufunc__(
        self, ufunc: np.ufunc, method: str, *inputs: object, **options: object
    ) -> "_Elementwise":
        # Operators do not copy Python's numbers to the GPU, as the functions of the same names do.
        function = _OPERATORS.get(ufunc.__name__) or getattr(self.xp, ufunc.__name__, None)
        if function is None or method != "__call__" or options:
            return NotImplemented
        numbers = [one.array if isinstance(one, _Elementwise) else one for one in inputs]
        return _Elementwise(self.xp, function(*numbers))
