"""Kernels that only kernels call, as tests call them."""

import inspect
from functools import cache

import numba


@cache
def compiled(kernel):
    """Return a function that runs the compiled code of a kernel, which Python would call uncompiled."""
    # Its arguments are written out, since Numba inlines no kernel into a call with *arguments.
    arguments = ", ".join(inspect.signature(getattr(kernel, "py_func", kernel)).parameters)
    names = {"kernel": kernel}
    exec(f"def call({arguments}):\n    return kernel({arguments})", names)
    return numba.njit(error_model="numpy")(names["call"])
