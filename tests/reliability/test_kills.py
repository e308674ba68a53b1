"""The tests of kills name functions that exist; they are slow, so a name that has moved shows here first."""

import pytest

from helpers.kills import PHASES, find

pytest.importorskip("stable_baselines3")


@pytest.mark.parametrize("name", PHASES)
def test_every_phase_of_a_command_is_a_function(name):
    owner, attribute = find(name)
    assert callable(getattr(owner, attribute))
