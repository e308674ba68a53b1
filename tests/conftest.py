"""Shared fixtures."""

import numba
import pytest


@pytest.fixture(scope="session")
def numba_threads():
    """How many threads kernels can be spread over here."""
    return numba.config.NUMBA_NUM_THREADS
