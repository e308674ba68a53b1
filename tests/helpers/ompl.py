"""OMPL, which has no wheel for some versions of Python and processors."""

import platform
import sys

import pytest


def require_ompl():
    """Skip the test where OMPL is missing."""
    if sys.version_info >= (3, 14) or platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("needs OMPL, which has no wheel for this Python or processor")
    pytest.importorskip("ompl", reason="needs the extra `planners`")
