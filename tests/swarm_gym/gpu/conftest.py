"""Tests of kernels for GPUs: they run where there is a GPU, or in the simulator of numba-cuda."""

import sys
from importlib.util import find_spec

import numba
import pytest

COMPILES = "test_machine_code"  # this one needs neither


def pytest_collection_modifyitems(items):
    missing = [name for name in ("numba_cuda", "array_api_compat", "torch") if find_spec(name) is None]
    if sys.platform == "darwin":
        _skip(items, "needs Linux or Windows: CUDA has no version for macOS")
    elif missing:
        _skip(items, f"{' and '.join(missing)} is not installed: pip install '.[gpu]' brings it")
    elif not numba.config.ENABLE_CUDASIM and not _has_gpu():
        here = [item for item in items if item.path.stem != COMPILES]
        _skip(here, "there is no GPU; make test-slow runs it in the simulator, with NUMBA_ENABLE_CUDASIM=1")


def _skip(items, reason):
    for item in items:
        if item.path.parent.name == "gpu":
            item.add_marker(pytest.mark.skip(reason=reason))


def _has_gpu():
    import torch

    return torch.cuda.is_available()
