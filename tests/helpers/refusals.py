"""The check of tests that something is refused with a message that says why."""

import pytest

from swarm_gym.errors import ScenarioError


def refused(call, *words, error=ScenarioError):
    """Assert that a call raises an error whose message contains all these words."""
    with pytest.raises(error) as caught:
        call()
    for word in words:
        assert word in str(caught.value)
