"""Kernels that only kernels call, as tests call them."""

import inspect
from functools import cache

import numba


@cache
def compiled(kernel):
    """Return a function that runs the compiled code of a kernel, which Python would call uncompiled."""
    parameters = inspect.signature(getattr(kernel, "py_func", kernel)).parameters.values()
    if any(parameter.kind is parameter.VAR_POSITIONAL for parameter in parameters):
        names = "*arguments"
    else:  # by name, since Numba inlines no kernel into a call with `*arguments`
        names = ", ".join(parameter.name for parameter in parameters)
    return numba.njit(error_model="numpy")(eval(f"lambda {names}: kernel({names})", {"kernel": kernel}))
