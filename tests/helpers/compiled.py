"""Kernels that only kernels call, as tests call them."""

from functools import cache

import numba


@cache
def compiled(kernel):
    """Return a function that runs the compiled code of a kernel, which Python would call uncompiled."""

    @numba.njit(error_model="numpy")
    def call(*arguments):
        return kernel(*arguments)

    return call
