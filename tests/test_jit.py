"""Kernels that only kernels call: from Python, and from kernels."""

import numpy as np
import pytest

from swarm_gym.jit import inner_kernel, kernel, merged_kernel


def half(values):
    return values.sum() / 2.0


@pytest.mark.parametrize("decorate", [inner_kernel, merged_kernel])
def test_kernels_that_only_kernels_call_can_be_called_from_python(decorate):
    assert decorate(half)(np.arange(4.0)) == 3.0


def test_they_are_compiled_into_the_kernels_that_call_them():
    inner, merged = inner_kernel(half), merged_kernel(half)

    @kernel
    def both(values):
        return inner(values) + merged(values)

    assert both(np.arange(4.0)) == 6.0
