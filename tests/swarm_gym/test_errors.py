"""Errors have messages that help, also when a worker sends them."""

import pickle

import pytest

from swarm_gym.errors import ActionError, MissingExtraError, SwarmGymError, UnknownNameError

RAISED = (
    SwarmGymError(),
    ActionError("phi is 2"),
    UnknownNameError("optimizer", "firely", ["firefly", "multivariate"]),
    MissingExtraError("this map", "Pillow", "maps"),
)


@pytest.mark.parametrize("error", RAISED, ids=lambda error: type(error).__name__)
def test_an_error_is_the_same_after_its_way_from_a_worker(error):
    error.add_note("a note")
    received = pickle.loads(pickle.dumps(error))
    assert type(received) is type(error)
    assert str(received) == str(error)
    assert received.__notes__ == ["a note"]
