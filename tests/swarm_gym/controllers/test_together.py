"""Policies that decide together: the mean of their actions, and what cannot decide together."""

import numpy as np
import pytest

from swarm_gym.controllers import make_controller
from swarm_gym.controllers.learned.policy_file import PolicyFileError, packaged_policies, policies_of
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import make_observation
from swarm_gym.rollout import run_episodes

RECIPE = "cma-search-restarts"


def test_the_action_is_the_mean_of_the_actions_of_all_training_seeds():
    together = make_controller(f"together:{RECIPE}")
    parts = [load_learned(name) for name in policies_of(RECIPE)]
    assert together.env_options() == parts[0].env_options()
    observations = np.random.default_rng(0).random((5, len(make_observation(together.observation).features)))
    for controller in (together, *parts):
        controller.reset(5)
    actions = [part.act(observations) for part in parts]
    assert len(np.unique(actions, axis=0)) == len(parts) == 5
    np.testing.assert_allclose(together.act(observations), sum(actions) / len(parts), rtol=1e-6)


def test_named_policies_are_those_of_the_recipe():
    names = [name for name in packaged_policies() if name.startswith("three-cases/")]
    listed = make_controller(f"together:{','.join(f'{name}@0.3' for name in names)}")
    assert listed.identity() == make_controller("together:three-cases@0.3").identity()
    assert listed.identity() != make_controller("together:three-cases@0.5").identity()
    assert listed.price == 0.3


def test_a_policy_twice_decides_as_alone():
    ended = [
        run_episodes(make_controller(name), "case1", range(3), "firefly", iterations=10).final_fitness
        for name in ("learned:three-cases/0@1", "together:three-cases/0@1,three-cases/0@1")
    ]
    np.testing.assert_array_equal(*ended)


@pytest.mark.parametrize(
    ("argument", "error", "message"),
    [
        ("three-cases/0", ValueError, "expected a recipe, whose policies decide together"),
        ("three-cases/0,cma-search/0", ValueError, "need the same environment; observation is 'paper"),
        ("three-cases/0@1,three-cases/1@2", ValueError, "price is 1.0 of one and 2.0 of another"),
        ("three-cases/0,", PolicyFileError, "policy ''"),
        ("three-casse", PolicyFileError, "recipe of policies 'three-casse'"),
        ("", PolicyFileError, "recipe of policies ''"),
    ],
)
def test_what_cannot_decide_together_is_refused(argument, error, message):
    with pytest.raises(error, match=message):
        make_controller(f"together:{argument}")
