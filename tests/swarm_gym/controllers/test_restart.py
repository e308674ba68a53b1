"""The rule that restarts a swarm when it stagnates."""

import numpy as np
import pytest

from swarm_gym.controllers import SizeLimits, make_controller
from swarm_gym.errors import SettingError
from swarm_gym.observation import make_observation

NAMES = [feature.name for feature in make_observation("extended").features]
BEST = NAMES.index("log(best fitness / lower bound)")
IMMIGRANTS = 6


def seen(share_done, *best):
    """Return observations of swarms with these best fitnesses."""
    observations = np.zeros((len(best), len(NAMES)))
    observations[:, 3], observations[:, BEST] = share_done, best
    return observations


def test_immigrants_come_after_patience_iterations_without_progress_and_only_once():
    rule = make_controller("restart:patience=3,immigrants=0.4")
    rule.reset(2)
    rule.act(seen(0.0, 1.0, 1.0))
    coming = [rule.act(seen(0.01 * k, 1.0, 1.0 - 0.01 * k))[:, IMMIGRANTS] for k in range(1, 8)]
    np.testing.assert_array_equal(np.array(coming)[:, 0], [0, 0, 0.4, 0, 0, 0.4, 0])
    np.testing.assert_array_equal(np.array(coming)[:, 1], np.zeros(7))  # this swarm improves


def test_an_episode_that_begins_forgets_the_stagnation_of_the_last_one():
    rule = make_controller("restart:patience=2,immigrants=0.4")
    rule.reset(1)
    for share in (0.0, 0.01, 0.0, 0.01):
        assert rule.act(seen(share, 1.0))[0, IMMIGRANTS] == 0.0
    assert rule.act(seen(0.02, 1.0))[0, IMMIGRANTS] == 0.4


def test_other_decisions_are_constant_and_the_first_population_is_smooth():
    rule = make_controller("restart:start=90,size=20,noise=3,amplitude=0.3", SizeLimits(2, 120))
    rule.reset(1)
    np.testing.assert_array_equal(rule.act(seen(0.0, 1.0)), [[20, 0, 3, 0.1, 1, 0.3, 0]])
    options = rule.env_options()
    assert (options["initial_population_size"], options["source"], options["amplitude"]) == (
        90,
        "smooth",
        0.3,
    )


@pytest.mark.parametrize("argument", ["patience=0", "immigrants=1.5", "amplitude=0", "courage=1", "size=300"])
def test_parameters_outside_their_range_are_refused(argument):
    with pytest.raises(SettingError, match=f"{argument.partition('=')[0]}.*valid: start integer in"):
        make_controller(f"restart:{argument}")
