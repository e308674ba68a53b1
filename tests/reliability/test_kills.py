"""The tests of kills name functions that exist; they are slow, so a name that has moved shows here first."""

import os

import pytest

from helpers.loops import looped

if os.name != "posix":
    pytest.skip("needs POSIX: it kills by signals", allow_module_level=True)
pytest.importorskip("stable_baselines3", reason="needs the extra `study`")

from helpers.kills import PHASES, find


@looped("name", PHASES)
def test_every_phase_of_a_command_is_a_function(name):
    owner, attribute = find(name)
    assert callable(getattr(owner, attribute))
