"""Errors have messages that help, also when a worker sends them."""

import pickle

import pytest

from experiments.catalogue import get_suite
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, MissingExtraError, SwarmGymError, UnknownNameError, listed
from swarm_gym.scenarios import make_scenario
from swarm_gym.training.presets import load_preset

FIELDS = "random-fields:train:"
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


def test_a_message_lists_all_of_few_names():
    error = UnknownNameError("optimizer", "firely", ["multivariate", "firefly"], "the page")
    assert str(error) == "unknown optimizer 'firely'; valid: firefly, multivariate"


def test_a_message_lists_the_names_that_are_alike_of_many():
    error = UnknownNameError("map", "rom:27", [f"room:{number}" for number in range(5_000)], "the page")
    assert "valid: room:27, " in str(error)
    assert str(error).endswith(", ... (5,000 in all, see the page)")
    assert len(str(error)) < 120
    assert len(error.valid) == 5_000
    assert len(listed(["x" * 150, "y" * 150], "x")) < 200


@pytest.mark.parametrize(
    "ask",
    [
        lambda: make_scenario("cases1"),
        lambda: make_controller("nothing"),
        lambda: make_controller("learned:three-case"),
        lambda: make_controller("open-loop:nothing"),
        lambda: make_controller("tuned:nothing"),
        lambda: SwarmEnv(scenarios="case1"),
        lambda: SwarmEnv(scenario=f"{FIELDS}0-99").reset(options={"scenario": f"{FIELDS}100"}),
        lambda: load_preset("nothing"),
        lambda: get_suite("nothing"),
    ],
)
def test_messages_are_two_lines_at_most(ask):
    with pytest.raises(ValueError, match=r"in all|valid: <module>") as error:
        ask()
    assert len(str(error.value)) < 320
    assert "\n" not in str(error.value)
